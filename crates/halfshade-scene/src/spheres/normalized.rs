//! A mesh in the unit cube, in which spheres are fitted, and the way back.

use super::cover::{grow_to_cover, sort_and_dedup, violation};
use super::{DSphere, Sphere, SphereSet};
use crate::clusters::at_least;
use crate::{Mesh, SceneError};
use glam::DVec3;

/// Longest edge, as a fraction of the mesh's largest extent, below which an uncovered piece of a triangle is covered by
/// growing a sphere instead of being cut further.
pub(super) const COVER_TOLERANCE: f64 = 2e-4;
/// Vertices that tightening respects at most; the bound holds for all of them in the end.
const MOST_VERTICES: usize = 40_000;

/// A mesh moved into the unit cube about the origin.
pub(super) struct NormalizedMesh {
    pub(super) corners: Vec<[DVec3; 3]>,
    pub(super) bounds: [DVec3; 2],
    middle: DVec3,
    extent: f64,
}

impl NormalizedMesh {
    pub(super) fn new(mesh: &Mesh) -> Result<Self, SceneError> {
        let corner = |index: u32| {
            let position = mesh.positions.get(index as usize).ok_or_else(|| {
                SceneError::new(format!("a triangle uses vertex {index} of {}", mesh.positions.len()))
            })?;
            if position.is_finite() {
                Ok(position.as_dvec3())
            } else {
                Err(SceneError::new(format!("vertex {index} is not finite")))
            }
        };
        let mut corners = Vec::with_capacity(mesh.triangles.len());
        for [a, b, c] in &mesh.triangles {
            corners.push([corner(*a)?, corner(*b)?, corner(*c)?]);
        }
        if corners.is_empty() {
            return Err(SceneError::new("a mesh without triangles has no sphere set"));
        }
        let all = || corners.iter().flatten();
        let (min, max) = (all().copied().reduce(DVec3::min), all().copied().reduce(DVec3::max));
        let (min, max) = (min.unwrap_or_default(), max.unwrap_or_default());
        let (middle, extent) = (min.midpoint(max), (max - min).max_element());
        if extent <= 0.0 {
            return Err(SceneError::new("all vertices of the mesh lie in one place"));
        }
        let normalize = |point: DVec3| (point - middle) / extent;
        let bounds = [normalize(min), normalize(max)];
        for corner in corners.iter_mut().flatten() {
            *corner = normalize(*corner);
        }
        Ok(Self { corners, bounds, middle, extent })
    }

    /// Each vertex once, in a fixed order; every n-th of them if there are very many.
    pub(super) fn vertices(&self) -> Vec<DVec3> {
        let mut vertices: Vec<DVec3> = self.corners.iter().flatten().copied().collect();
        sort_and_dedup(&mut vertices);
        let stride = vertices.len().div_ceil(MOST_VERTICES);
        vertices.into_iter().step_by(stride.max(1)).collect()
    }

    /// Diagonal of the bounding box, normalized.
    pub(super) fn extent(&self) -> f64 {
        self.bounds[0].distance(self.bounds[1])
    }

    pub(super) fn normalized(&self, spheres: &[Sphere]) -> Vec<DSphere> {
        spheres
            .iter()
            .map(|s| DSphere {
                center: (s.center.as_dvec3() - self.middle) / self.extent,
                radius: f64::from(s.radius) / self.extent,
            })
            .collect()
    }

    /// The spheres in single precision and the mesh's coordinates, grown until they bound the triangles as given.
    pub(super) fn bound(&self, fitted: Vec<DSphere>) -> SphereSet {
        let triangles = self.triangles_as_given();
        // A mesh without area is fitted by points, one of which must grow to hold it.
        let are_points = fitted.iter().all(|sphere| sphere.radius <= 0.0);
        let mut spheres: Vec<DSphere> = fitted
            .iter()
            .filter(|sphere| sphere.radius > 0.0 || are_points)
            .map(|sphere| DSphere {
                center: (sphere.center * self.extent + self.middle).as_vec3().as_dvec3(),
                radius: f64::from(at_least(sphere.radius * self.extent)),
            })
            .collect();
        let tolerance = COVER_TOLERANCE * self.extent;
        let growth = grow_to_cover(&triangles, &mut spheres, tolerance, |radius| f64::from(at_least(radius)));
        SphereSet {
            bounding_violation: violation(&triangles, &spheres, tolerance),
            growth: growth / (self.extent() * self.extent),
            spheres: in_single_precision(&spheres),
            ..SphereSet::default()
        }
    }

    /// The spheres in single precision and the mesh's coordinates, as they are.
    pub(super) fn placed(&self, fitted: &[DSphere]) -> SphereSet {
        let place = |sphere: &DSphere| DSphere {
            center: (sphere.center * self.extent + self.middle).as_vec3().as_dvec3(),
            radius: (sphere.radius * self.extent).max(f64::from(f32::MIN_POSITIVE)),
        };
        let spheres: Vec<DSphere> = fitted.iter().map(place).collect();
        SphereSet {
            bounding_violation: violation(&self.triangles_as_given(), &spheres, COVER_TOLERANCE * self.extent),
            spheres: in_single_precision(&spheres),
            ..SphereSet::default()
        }
    }

    fn triangles_as_given(&self) -> Vec<[DVec3; 3]> {
        self.corners.iter().map(|t| t.map(|corner| corner * self.extent + self.middle)).collect()
    }
}

/// Spheres whose numbers are single-precision ones already, or nearly.
fn in_single_precision(spheres: &[DSphere]) -> Vec<Sphere> {
    spheres.iter().map(|s| Sphere { center: s.center.as_vec3(), radius: s.radius as f32 }).collect()
}
