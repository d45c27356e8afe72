//! Winding numbers: whether a point is inside of a surface.

use glam::{DVec3, Vec3};
use std::f64::consts::PI;

/// Winding number of a closed surface around `point`: 0 outside, ±1 inside (\[Jacobson2013\]; solid angles after
/// \[VanOosterom1983\]). Of an open one, the part of all directions that it covers.
pub(crate) fn winding(corners: impl Iterator<Item = [Vec3; 3]>, point: DVec3) -> f64 {
    let solid_angle = |corners: [Vec3; 3]| {
        let [a, b, c] = corners.map(|p| p.as_dvec3() - point);
        let (la, lb, lc) = (a.length(), b.length(), c.length());
        2.0 * a.dot(b.cross(c)).atan2(la * lb * lc + a.dot(b) * lc + b.dot(c) * la + c.dot(a) * lb)
    };
    corners.map(solid_angle).sum::<f64>() / (4.0 * PI)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::builtin::shapes;

    #[test]
    fn points_inside_outside_and_above_a_plane() {
        let around = |mesh: &crate::Mesh, point: DVec3| {
            winding(mesh.triangles.iter().map(|triangle| triangle.map(|v| mesh.positions[v as usize])), point)
        };
        let solid = shapes::torus(0.7, 0.3, 24, 12);
        assert!((around(&solid, DVec3::new(0.7, 0.0, 0.0)) - 1.0).abs() < 1e-9);
        assert!(around(&solid, DVec3::ZERO).abs() < 1e-9 && around(&solid, 5.0 * DVec3::Y).abs() < 1e-9);
        // A cube's face covers a sixth of what its middle sees.
        assert!((around(&shapes::plane(3), DVec3::NEG_Y) - 1.0 / 6.0).abs() < 1e-9);
    }
}
