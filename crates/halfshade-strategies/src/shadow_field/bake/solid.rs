//! Sample points that lie within a solid: nobody looks from there, but who is near its surface interpolates with them.

use super::{basis::Basis, bounds::BoundingSphere};
use crate::shared::triangle_rays::{Start, TriangleRays};
use glam::{DVec3, Vec3};
use halfshade_sh::quadrature::golden_spiral;
use std::f32::consts::FRAC_1_SQRT_2;

/// Rays that tell whether a point is inside: it is unless two of them get out. One may, through a crack of the mesh.
const PROBES: usize = 64;

/// How far a point goes to get out, in shares of its `reach`.
const STEPS: [f32; 4] = [0.125, 0.25, 0.5, 1.0];

/// Along the axes and in the plane of every two of them.
const WAYS: [Vec3; 18] = {
    const H: f32 = FRAC_1_SQRT_2;
    [
        Vec3::X,
        Vec3::NEG_X,
        Vec3::Y,
        Vec3::NEG_Y,
        Vec3::Z,
        Vec3::NEG_Z,
        Vec3::new(H, H, 0.0),
        Vec3::new(H, -H, 0.0),
        Vec3::new(-H, H, 0.0),
        Vec3::new(-H, -H, 0.0),
        Vec3::new(H, 0.0, H),
        Vec3::new(H, 0.0, -H),
        Vec3::new(-H, 0.0, H),
        Vec3::new(-H, 0.0, -H),
        Vec3::new(0.0, H, H),
        Vec3::new(0.0, H, -H),
        Vec3::new(0.0, -H, H),
        Vec3::new(0.0, -H, -H),
    ]
};

/// Tells which points lie within a mesh.
pub(crate) struct Solid<'a> {
    rays: &'a TriangleRays,
    bounds: BoundingSphere,
    probes: Vec<Vec3>,
}

impl<'a> Solid<'a> {
    /// The mesh of `rays`, which `bounds` holds.
    pub(crate) fn new(rays: &'a TriangleRays, bounds: BoundingSphere) -> Self {
        let probes = golden_spiral(PROBES).map(|direction| DVec3::from(direction).as_vec3()).collect();
        Self { rays, bounds, probes }
    }

    /// Whether a point lies within the mesh, or in a hole that a thirtieth of all directions leaves.
    pub(crate) fn holds(&self, point: Vec3) -> bool {
        point.distance_squared(self.bounds.center) <= self.bounds.radius * self.bounds.radius
            && (self.probes.iter())
                .filter(|&&probe| !self.rays.blocked(&Start::free(point), probe, f32::INFINITY))
                .nth(1)
                .is_none()
    }

    /// Occlusion at a sample point. Within the mesh, the mean of that at the nearest places outside,
    /// if there are any within `reach`: whoever interpolates with the sample is outside, and not farther than its neighbours.
    pub(crate) fn blocked_near<B: Basis>(&self, basis: &B, point: Vec3, reach: f32) -> B::Vector {
        let seen = |point| basis.blocked_from(self.rays, point, self.bounds);
        if !self.holds(point) {
            return seen(point);
        }
        for step in STEPS {
            let places = WAYS.map(|way| point + step * reach * way);
            let outside: Vec<B::Vector> = places.into_iter().filter(|&place| !self.holds(place)).map(seen).collect();
            if !outside.is_empty() {
                let share = 1.0 / outside.len() as f32;
                return basis.mix(&outside.iter().map(|vector| (vector, share)).collect::<Vec<_>>());
            }
        }
        basis.project(&|_| 1.0)
    }
}

#[cfg(test)]
mod tests {
    use super::super::sh::projection::ShBasis;
    use super::*;
    use halfshade_scene::builtin::shapes;

    #[test]
    fn inside_is_where_nothing_is_seen_and_samples_there_leave() {
        let rays = TriangleRays::new(&shapes::sphere(40));
        let bounds = BoundingSphere { center: Vec3::ZERO, radius: 1.0 };
        let solid = Solid::new(&rays, bounds);
        for (radius, inside) in [(0.0, true), (0.9, true), (1.01, false), (1.5, false), (1e9, false)] {
            assert_eq!(solid.holds(radius * Vec3::new(0.6, 0.0, 0.8)), inside, "{radius}");
        }
        let basis = ShBasis::new(4, 64);
        // The share of all directions that is blocked, of which the first coefficient is 1/sqrt(4π) times the integral.
        let blocked = |height: f32, reach| {
            solid.blocked_near(&basis, height * Vec3::Y, reach)[0] / std::f32::consts::PI.sqrt() / 2.0
        };
        let cap = |height: f32| 0.5 * (1.0 - (1.0 - height.powi(-2)).sqrt());
        // Out at half of the reach: straight up, and aslant in four ways. Each sees a cap.
        let aslant = Vec3::new(0.1 * FRAC_1_SQRT_2, 0.94 + 0.1 * FRAC_1_SQRT_2, 0.0).length();
        let mean = 0.2 * cap(1.04) + 0.8 * cap(aslant);
        assert!((blocked(0.94, 0.2) - mean).abs() < 0.01, "{} {mean}", blocked(0.94, 0.2));
        assert!((blocked(1.2, 0.2) - cap(1.2)).abs() < 0.01);
        assert!((blocked(0.2, 0.2) - 1.0).abs() < 1e-3);
    }
}
