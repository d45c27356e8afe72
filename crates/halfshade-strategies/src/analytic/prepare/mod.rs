//! Once per frame: spheres and lamps where they are. It ends in plain data.

pub(crate) mod frame;
