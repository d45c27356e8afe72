//! How a surface reflects.

use glam::Vec3;

/// A diffuse surface: outgoing radiance is `albedo / π` times irradiance.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Material {
    /// Reflected fraction per channel, in [0, 1]. Multiplied by the mesh's vertex colours where it has some.
    pub albedo: Vec3,
}

impl Default for Material {
    fn default() -> Self {
        Self { albedo: Vec3::ONE }
    }
}
