//! Receivers in batches [Tamura2006, figure 3]: eight side by side in spherical harmonics, one by one on a cube's texels.

pub(crate) mod haar;
pub(crate) mod runs;
pub(crate) mod sh;
pub(crate) mod traced;
