//! Arrays and numbers in, numbers out: the parts of shading that a GPU would run as they are.

pub(crate) mod cell_lobes;
pub(crate) mod cover;
pub(crate) mod environment;
pub(crate) mod fractions;
pub(crate) mod mask;
pub(crate) mod receiver;
pub(crate) mod sampled;
pub(crate) mod spheres;
pub(crate) mod square;
