//! Once per frame: light in the space that transfer was baked in.

pub(crate) mod lamps;
pub(crate) mod light;
pub(crate) mod products;
pub(crate) mod shaped;
pub(crate) mod turns;
