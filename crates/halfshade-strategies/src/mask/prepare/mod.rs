//! Once per frame: spheres, boxes and lamps where they are. It ends in plain data.

pub(crate) mod frame;
