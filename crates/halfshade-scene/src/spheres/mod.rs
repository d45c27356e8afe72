//! Sphere sets: the geometry that blocks, in place of a mesh ([Guerrero2007, 4.1], \[Wang2006\]).
//!
//! [`SphereSet::build`] fits the leaf spheres to a mesh, either so that they bound it, as published, or so that they hide
//! from receivers what it hides ([`SphereFit`]). [`SphereHierarchy::new`] builds parent spheres over them, and a
//! [`SphereBinding`] lets them follow a mesh that deforms.

mod adjust;
mod build;
mod cover;
mod enclosing;
mod follow;
mod hierarchy;
mod normalized;
mod overlap;
mod points;
mod polish;
mod scene;
mod shadow;
mod solid;
mod variational;

pub use adjust::{AdjustRule, AdjustedSphere, COVER_HEIGHT, FADE_HEIGHT, adjust, adjusted};
pub use build::{BuildOptions, MAX_SPHERES};
pub use follow::{Followed, SphereBinding};
pub use hierarchy::{HierarchyLevel, SphereHierarchy};
pub use overlap::overlap_shares;

use glam::{DVec3, Vec3};
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

/// A sphere.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
pub struct Sphere {
    /// Centre.
    pub center: Vec3,
    /// Radius, positive.
    pub radius: f32,
}

/// Aim of a sphere set.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash, Default, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "kebab-case")]
pub enum SphereFit {
    /// Every point of the surface lies in at least one sphere, with little volume outside the mesh [Guerrero2007, 4.1].
    Bounding,
    /// Receivers around and on the object see as much light as the mesh leaves them, by least squares. Spheres may stick
    /// out and leave parts bare. At equal count shadows by them err less in nearly every scene (`results/sphere-fit`).
    #[default]
    Shadow,
}

/// Spheres that stand for a mesh.
#[derive(Debug, Clone, PartialEq, Default, Serialize, Deserialize)]
pub struct SphereSet {
    /// The leaf spheres, in the mesh's own coordinates.
    pub spheres: Vec<Sphere>,
    /// Aim of their fit.
    pub fit: SphereFit,
    /// Volume of the union of the spheres outside the mesh, as a fraction of the mesh's volume. Where the mesh
    /// encloses no volume: the volume of the union, as a fraction of that of a sphere around the mesh (a note says so).
    pub outside_volume_fraction: f64,
    /// Half the range of three independent estimates of `outside_volume_fraction`, which is their mean.
    pub outside_volume_error: f64,
    /// Volume of the mesh outside every sphere, as a fraction of its own: one minus what others call coverage. 0 where
    /// the mesh encloses no volume.
    pub missing_volume_fraction: f64,
    /// Largest distance by which a surface point lies outside every sphere, the surface gap; 0 for a set that bounds.
    pub bounding_violation: f64,
    /// Growth of radii, after optimization over samples, so that the triangles are bounded: the largest
    /// growth as a fraction of the mesh's bounding-box diagonal.
    pub growth: f64,
    /// Notes on the mesh for the user: not closed, no volume.
    pub notes: Vec<String>,
}

/// A sphere in the making, in double precision.
#[derive(Debug, Clone, Copy, PartialEq)]
struct DSphere {
    center: DVec3,
    radius: f64,
}

impl DSphere {
    fn contains(&self, point: DVec3) -> bool {
        self.center.distance_squared(point) <= self.radius * self.radius
    }
}
