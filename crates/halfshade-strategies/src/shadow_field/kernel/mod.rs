//! Arrays and numbers in, numbers out: the parts of shading that a GPU would run as they are.

pub(crate) mod bounded_product;
pub(crate) mod cube_cap;
pub(crate) mod light_order;
pub(crate) mod light_product;
pub(crate) mod reconstruct;
pub(crate) mod shell_coordinates;
pub(crate) mod shell_grid;
pub(crate) mod texels;
pub(crate) mod wavelet_rows;
