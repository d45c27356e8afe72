//! Lights on the texels of a cube.

use super::projection::HaarBasis;
use glam::Vec3;
use halfshade_scene::{Environment, light::DistantLight};
use rayon::prelude::*;
use std::f32::consts::TAU;

/// Samples along a texel's edges for its mean radiance.
const FINENESS: usize = 16;

/// Radiance times solid angle per texel: red, green, blue.
pub(super) fn distant(basis: &HaarBasis, environment: &Environment) -> [Vec<f32>; 3] {
    let mean = |texel: usize| match &environment.base {
        DistantLight::Constant(radiance) => *radiance,
        DistantLight::Map(map) => {
            let share = |i: usize| (i as f64 + 0.5) / FINENESS as f64;
            let places = (0..FINENESS * FINENESS).map(|i| [share(i % FINENESS), share(i / FINENESS)]);
            let radiance =
                places.map(|place| map.radiance(Vec3::from(basis.cube.direction(texel, place).map(|x| x as f32))));
            radiance.sum::<Vec3>() / (FINENESS * FINENESS) as f32
        }
    };
    let mut light: Vec<Vec3> =
        (0..basis.cube.len()).into_par_iter().map(|texel| basis.solid_angles[texel] * mean(texel)).collect();
    if let Some(sun) = environment.sun {
        let cap = Cap::new(basis, sun.direction.normalize_or(Vec3::Y), sun.angular_radius);
        let scale = cap.scale(basis);
        for (texel, sum) in light.iter_mut().enumerate() {
            *sum += scale * cap.coverage(basis, texel) * basis.solid_angles[texel] * sun.radiance;
        }
    }
    std::array::from_fn(|channel| light.iter().map(|radiance| radiance[channel]).collect())
}

/// A cap of directions on the cube, its edge as wide as two texels.
pub(super) struct Cap {
    axis: Vec3,
    /// Cosines where coverage begins and where it is whole.
    from: f32,
    whole: f32,
    solid_angle: f32,
}

impl Cap {
    /// All directions.
    pub(super) const ALL: Self = Self { axis: Vec3::Y, from: -3.0, whole: -2.0, solid_angle: 2.0 * TAU };

    /// Of an angular radius in radians.
    pub(super) fn new(basis: &HaarBasis, axis: Vec3, angular_radius: f32) -> Self {
        // As wide as a texel in the middle of a face: at least one of them is met, and the axis is kept.
        let texel = 2.0 / basis.cube.side() as f32;
        Self {
            axis,
            from: (angular_radius + texel).min(std::f32::consts::PI).cos(),
            whole: (angular_radius - texel).max(0.0).cos(),
            solid_angle: 2.0 * TAU * (0.5 * angular_radius).sin().powi(2),
        }
    }

    /// How much of a texel it covers, about.
    #[inline(always)]
    pub(super) fn coverage(&self, basis: &HaarBasis, texel: usize) -> f32 {
        ((basis.directions[texel].dot(self.axis) - self.from) / (self.whole - self.from)).clamp(0.0, 1.0)
    }

    /// Steradian.
    pub(super) fn solid_angle(&self) -> f32 {
        self.solid_angle
    }

    /// By what coverages must be multiplied so that their sum is the cap's solid angle exactly.
    fn scale(&self, basis: &HaarBasis) -> f32 {
        let sum: f32 = (0..basis.cube.len()).map(|texel| self.coverage(basis, texel) * basis.solid_angles[texel]).sum();
        if sum > 0.0 { self.solid_angle / sum } else { 0.0 }
    }
}

#[cfg(test)]
mod tests {
    use super::{super::super::settings::Coding, *};

    #[test]
    fn caps_have_their_solid_angle_and_their_axis() {
        let basis = HaarBasis::new(32, 0.05, Coding::Tree);
        for radius in [1e-3, 0.05, 0.5, 1.5] {
            let axis = Vec3::new(0.3, -0.5, 0.8).normalize();
            let cap = Cap::new(&basis, axis, radius);
            let scale = cap.scale(&basis);
            assert!(scale > 0.0 && (radius < 0.1 || (scale - 1.0).abs() < 0.05), "{radius}: {scale}");
            let moment: Vec3 = (0..basis.cube.len())
                .map(|texel| scale * cap.coverage(&basis, texel) * basis.solid_angles[texel] * basis.directions[texel])
                .sum();
            // The vector integral over a cap is π sin² along its axis.
            let expected = 0.5 * TAU * radius.sin().powi(2) * axis;
            assert!(moment.distance(expected) < 0.02 * expected.length(), "{radius}: {moment} {expected}");
        }
    }

    #[test]
    fn a_constant_sky_is_its_radiance_times_all() {
        let basis = HaarBasis::new(8, 0.05, Coding::Tree);
        let light = distant(&basis, &Environment::constant(Vec3::new(1.0, 2.0, 0.0)));
        let sums = light.map(|channel| channel.iter().sum::<f32>() / (2.0 * TAU));
        assert!((sums[0] - 1.0).abs() < 1e-5 && (sums[1] - 2.0).abs() < 1e-5 && sums[2] == 0.0);
    }
}
