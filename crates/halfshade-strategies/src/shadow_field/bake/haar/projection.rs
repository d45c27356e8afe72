//! Occlusion at a point as a Haar vector: a cube map of rays, transformed, its largest coefficients kept.

use super::sparse::Sparse;
use crate::shadow_field::{
    bake::basis::Basis,
    kernel::texels::{forward, inverse},
    settings::Coding,
};
use glam::Vec3;
use halfshade_sh::haar::cube::Cube;
use std::f64::consts::PI;

/// Haar wavelets on a cube.
pub(crate) struct HaarBasis {
    pub(crate) cube: Cube,
    /// Most coefficients of a vector.
    kept: usize,
    /// How vectors are stored.
    pub(crate) coding: Coding,
    /// Unit, in the middle of the texels.
    pub(crate) directions: Vec<Vec3>,
    /// Solid angles of the texels, in steradian.
    pub(crate) solid_angles: Vec<f32>,
}

impl HaarBasis {
    /// Wavelets over `face` texels along an edge, a power of two; vectors keep that share of their coefficients, at least one.
    pub(crate) fn new(face: usize, share: f64, coding: Coding) -> Self {
        let cube = Cube::new(face.max(1).ilog2());
        let kept = ((share * cube.len() as f64).round() as usize).max(1);
        let direction = |texel| Vec3::from(cube.direction(texel, [0.5, 0.5]).map(|x| x as f32));
        Self {
            cube,
            kept,
            coding,
            directions: (0..cube.len()).map(direction).collect(),
            solid_angles: (0..cube.len()).map(|texel| cube.solid_angle(texel) as f32).collect(),
        }
    }
}

impl Basis for HaarBasis {
    type Vector = Sparse;

    fn project(&self, value: &dyn Fn(Vec3) -> f32) -> Sparse {
        let mut dense: Vec<f32> = self.directions.iter().map(|&direction| value(direction)).collect();
        forward(self.cube.face_len(), &mut dense);
        Sparse::largest(&dense, self.kept)
    }

    fn cell_radius(&self) -> f32 {
        // A texel in the middle of a face: half its diagonal.
        std::f32::consts::SQRT_2 / self.cube.side() as f32
    }

    /// As sparse as all vectors are.
    fn mix(&self, parts: &[(&Sparse, f32)]) -> Sparse {
        let mut dense = vec![0.0; self.cube.len()];
        parts.iter().for_each(|(vector, weight)| vector.add_to(&mut dense, *weight));
        Sparse::largest(&dense, self.kept)
    }

    fn difference(&self, a: &Sparse, b: &Sparse) -> f64 {
        let mut dense = vec![0.0; self.cube.len()];
        a.add_to(&mut dense, 1.0);
        b.add_to(&mut dense, -1.0);
        inverse(self.cube.face_len(), &mut dense);
        let sum: f32 = dense.iter().zip(&self.solid_angles).map(|(value, solid_angle)| value.abs() * solid_angle).sum();
        f64::from(sum) / (4.0 * PI)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::{shadow_field::bake::bounds::BoundingSphere, shared::triangle_rays::TriangleRays};
    use halfshade_scene::builtin::shapes;

    /// The share of all directions that a ball hides, and where.
    #[test]
    fn a_ball_hides_a_cap() {
        let rays = TriangleRays::new(&shapes::sphere(60));
        let basis = HaarBasis::new(32, 0.05, Coding::Listed);
        let bounds = BoundingSphere { center: Vec3::ZERO, radius: 1.0 };
        for point in [Vec3::new(0.0, 3.0, 0.0), Vec3::new(1.5, -0.5, 1.0), Vec3::new(-2.0, 0.1, 0.2)] {
            let blocked = basis.blocked_from(&rays, point, bounds);
            let least = (1.0 - 1.0 / point.length_squared()).sqrt();
            let cap = basis.project(&|direction| f32::from(u8::from(direction.dot(-point.normalize()) > least)));
            let share = f64::from(0.5 * (1.0 - least));
            let off = basis.difference(&blocked, &cap);
            assert!(off < 0.01, "{point}: {off}");
            let found = basis.difference(&blocked, &Sparse::default());
            assert!((found - share).abs() < 0.01, "{found} {share}");
        }
        let inside = basis.blocked_from(&rays, Vec3::new(0.2, 0.1, 0.0), bounds);
        assert_eq!(inside.indices, [0, 1024, 2048, 3072, 4096, 5120]);
        assert!(inside.values.iter().all(|value| *value == 1.0));
    }

    #[test]
    fn more_coefficients_come_nearer() {
        let off = [0.005, 0.02, 0.05, 1.0].map(|share| {
            let basis = HaarBasis::new(32, share, Coding::Listed);
            let cap = |direction: Vec3| f32::from(u8::from(direction.dot(Vec3::new(0.6, 0.0, 0.8)) > 0.8));
            let mut dense = vec![0.0; basis.cube.len()];
            basis.project(&cap).add_to(&mut dense, 1.0);
            inverse(basis.cube.face_len(), &mut dense);
            let errors = basis.directions.iter().zip(&dense).map(|(&direction, found)| (cap(direction) - found).abs());
            errors.sum::<f32>() / dense.len() as f32
        });
        assert!(off[0] > off[1] && off[1] > off[2] && off[2] < 2e-3 && off[3] < 1e-6, "{off:?}");
    }
}
