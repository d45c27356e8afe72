//! Materials that shine.

use crate::{Material, Reflectance};
use glam::Vec3;

/// A quarter of the light is mirrored, in a highlight of some ten degrees; of the rest, `albedo`.
pub(super) fn polished(albedo: Vec3) -> Material {
    let specular = 0.25;
    Material {
        reflectance: Reflectance::ModifiedPhong { specular: Vec3::splat(specular), exponent: 40.0 },
        ..Material::new((1.0 - specular) * albedo)
    }
}
