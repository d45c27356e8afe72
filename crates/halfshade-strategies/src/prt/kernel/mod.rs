//! Functions of arrays and numbers, which have twins elsewhere than on the processor.

pub(crate) mod dot;
pub(crate) mod lobe;
