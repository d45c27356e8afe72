//! A mask of directions against closed forms, quadrature and the truth.

mod gloss;
mod meshes;
mod plane;
