//! A mask of directions against closed forms, quadrature and the truth.

mod meshes;
mod plane;
