//! Distant light on the texels of a cube.

use crate::shadow_field::{bake::haar::projection::HaarBasis, kernel::cube_cap::CubeCap};
use glam::Vec3;
use halfshade_scene::{Environment, light::DistantLight};
use rayon::prelude::*;

/// Samples along a texel's edges for its mean radiance.
const FINENESS: usize = 16;

/// Distant light, texel by texel.
pub(crate) struct CubeLight {
    pub(crate) environment: Environment,
    /// Radiance times solid angle: red, green, blue.
    pub(crate) texels: [Vec<f32>; 3],
}

/// The light of an environment.
pub(crate) fn cube_light(basis: &HaarBasis, environment: &Environment) -> CubeLight {
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
        let cap = CubeCap::new(basis.cube.side(), sun.direction.normalize_or(Vec3::Y), sun.angular_radius);
        let scale = cap.scale(&basis.directions, &basis.solid_angles);
        for (texel, sum) in light.iter_mut().enumerate() {
            *sum += scale * cap.coverage(basis.directions[texel]) * basis.solid_angles[texel] * sun.radiance;
        }
    }
    let texels = std::array::from_fn(|channel| light.iter().map(|radiance| radiance[channel]).collect());
    CubeLight { environment: environment.clone(), texels }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::shadow_field::settings::Coding;
    use std::f32::consts::TAU;

    #[test]
    fn caps_have_their_solid_angle_and_their_axis() {
        let basis = HaarBasis::new(32, 0.05, Coding::Tree);
        for radius in [1e-3, 0.05, 0.5, 1.5] {
            let axis = Vec3::new(0.3, -0.5, 0.8).normalize();
            let cap = CubeCap::new(basis.cube.side(), axis, radius);
            let scale = cap.scale(&basis.directions, &basis.solid_angles);
            assert!(scale > 0.0 && (radius < 0.1 || (scale - 1.0).abs() < 0.05), "{radius}: {scale}");
            let moment: Vec3 = (0..basis.cube.len())
                .map(|texel| {
                    scale * cap.coverage(basis.directions[texel]) * basis.solid_angles[texel] * basis.directions[texel]
                })
                .sum();
            // The vector integral over a cap is π sin² along its axis.
            let expected = 0.5 * TAU * radius.sin().powi(2) * axis;
            assert!(moment.distance(expected) < 0.02 * expected.length(), "{radius}: {moment} {expected}");
        }
    }

    #[test]
    fn a_constant_sky_is_its_radiance_times_all() {
        let basis = HaarBasis::new(8, 0.05, Coding::Tree);
        let light = cube_light(&basis, &Environment::constant(Vec3::new(1.0, 2.0, 0.0)));
        let sums = light.texels.map(|channel| channel.iter().sum::<f32>() / (2.0 * TAU));
        assert!((sums[0] - 1.0).abs() < 1e-5 && (sums[1] - 2.0).abs() < 1e-5 && sums[2] == 0.0);
    }
}
