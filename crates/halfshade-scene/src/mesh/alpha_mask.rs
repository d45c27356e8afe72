//! Masks that cut holes into triangles.

use crate::Texture;
use std::sync::Arc;

/// A mask that cuts holes into triangles: alpha below a cutoff.
#[derive(Debug, Clone, PartialEq)]
pub struct AlphaMask {
    /// Alpha, in all channels, by the mesh's texture coordinates; 1 without one.
    pub texture: Option<Arc<Texture>>,
    /// Alpha from here on is surface.
    pub cutoff: f32,
}
