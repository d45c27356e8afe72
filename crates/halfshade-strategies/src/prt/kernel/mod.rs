//! Functions of arrays and numbers, which have twins elsewhere than on the processor.

pub(crate) mod decode;
pub(crate) mod dot;
pub(crate) mod grid;
pub(crate) mod lamps;
pub(crate) mod lobe;
pub(crate) mod volume;
