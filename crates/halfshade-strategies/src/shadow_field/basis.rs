//! What fields are made of: vectors of coefficients of a basis over directions.

use crate::shared::triangle_rays::{Start, TriangleRays, holes_of};
use glam::Vec3;
use halfshade_scene::Mesh;
use serde::{Deserialize, Serialize};
use std::sync::Arc;

/// Where an object lies in its own space: the ball that holds it.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Ball {
    pub(super) center: Vec3,
    pub(super) radius: f32,
}

/// Directions toward a ball.
struct NearBall {
    toward: Vec3,
    least_cosine: f32,
}

impl NearBall {
    /// As seen from `point`, and `reach` radians around it.
    fn new(ball: Ball, point: Vec3, reach: f32) -> Self {
        let offset = ball.center - point;
        let distance = offset.length();
        let least_cosine = if distance > ball.radius {
            ((ball.radius / distance).asin() + reach).min(std::f32::consts::PI).cos()
        } else {
            -2.0
        };
        Self { toward: offset.normalize_or(Vec3::Y), least_cosine }
    }

    /// Whether a unit direction may meet the ball.
    fn holds(&self, direction: Vec3) -> bool {
        direction.dot(self.toward) >= self.least_cosine
    }
}

/// Functions of direction as vectors; spherical harmonics or Haar wavelets.
pub(super) trait Basis: Sync {
    type Vector: Clone + Send + Sync;

    /// The vector of a function that is sampled once in the middle of every cell of a map of directions.
    fn project(&self, value: &dyn Fn(Vec3) -> f32) -> Self::Vector;

    /// How far a cell reaches from its middle at most, in radians.
    fn reach(&self) -> f32;

    /// The weighted sum.
    fn mix(&self, parts: &[(&Self::Vector, f32)]) -> Self::Vector;

    /// `1/4π ∫ |Σ_g (a_g - b_g) Ψ_g(ω)| dω` [Tamura2006, eq. 1].
    fn difference(&self, a: &Self::Vector, b: &Self::Vector) -> f64;

    /// What the mesh of `rays`, which `ball` holds, hides from `point`: 1 where it blocks, 0 elsewhere.
    fn blocked_from(&self, rays: &TriangleRays, point: Vec3, ball: Ball) -> Self::Vector {
        let near = NearBall::new(ball, point, self.reach());
        self.project(&|direction| {
            let blocked = near.holds(direction) && rays.blocked(&Start::free(point), direction, f32::INFINITY);
            f32::from(u8::from(blocked))
        })
    }
}

/// How coefficients are stored.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
pub(super) enum Storage {
    /// As a number of steps above the smallest value.
    U8,
    F16,
    F32,
}

/// The triangles of a mesh, in its own space.
pub(super) fn rays(mesh: &Mesh) -> TriangleRays {
    let corners = mesh.triangles.iter().map(|corners| corners.map(|vertex| mesh.positions[vertex as usize]));
    let holes = if mesh.has_cutouts() { holes_of(&Arc::new(mesh.clone())).collect() } else { Vec::new() };
    TriangleRays::new(corners.collect(), holes)
}
