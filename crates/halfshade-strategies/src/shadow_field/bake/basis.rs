//! Functions of direction as vectors of coefficients: what any basis of a field must do.

use super::bounds::{BoundingCone, BoundingSphere};
use crate::shared::triangle_rays::{Start, TriangleRays};
use glam::Vec3;
use halfshade_strategy::choice;
use serde::{Deserialize, Serialize};

/// A basis of functions of direction: spherical harmonics or Haar wavelets.
pub(crate) trait Basis: Sync {
    type Vector: Clone + Send + Sync;

    /// The vector of a function that is sampled once in the middle of every cell of a map of directions.
    fn project(&self, value: &dyn Fn(Vec3) -> f32) -> Self::Vector;

    /// The largest angle between the middle of a cell and its edge, in radians.
    fn cell_radius(&self) -> f32;

    /// The weighted sum.
    fn mix(&self, parts: &[(&Self::Vector, f32)]) -> Self::Vector;

    /// `1/4π ∫ |Σ_g (a_g - b_g) Ψ_g(ω)| dω` [Tamura2006, eq. 1].
    fn difference(&self, a: &Self::Vector, b: &Self::Vector) -> f64;

    /// Occlusion from `point` by the mesh of `rays`, which `bounds` holds: 1 where it blocks, 0 elsewhere.
    fn blocked_from(&self, rays: &TriangleRays, point: Vec3, bounds: BoundingSphere) -> Self::Vector {
        let cone = BoundingCone::new(bounds, point, self.cell_radius());
        self.project(&|direction| {
            let blocked = cone.holds(direction) && rays.blocked(&Start::free(point), direction, f32::INFINITY);
            f32::from(u8::from(blocked))
        })
    }
}

choice! {
    /// How coefficients are stored.
    #[derive(Serialize, Deserialize)]
    pub enum Storage {
        /// 8 bits, as steps above the smallest value
        U8 = "u8",
        /// 16 bits
        F16 = "f16",
        /// 32 bits
        F32 = "f32",
    }
}
