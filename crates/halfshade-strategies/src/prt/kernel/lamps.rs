//! Light that arrives from local lights at eight places: as it is there, or between points at which it is known.
//!
//! ```text
//! l_i(p) = Σ over lights L ∫ over its cap at p y_i(ω) dω
//! ```

use super::grid::Around;
use crate::shared::{light_cap::light_cap, vector::dot};
use halfshade_scene::SphereLight;
use halfshade_sh::{
    blocker_table::BlockerTable,
    kernel::{LANES, ShBatch},
};
use wide::f32x8;

/// SH vectors by channel, for eight places.
pub(crate) type Arriving<const N: usize> = [ShBatch<N>; 3];

/// Light that arrives at eight places, of as many bands as `table` has: that of minus caps.
pub(crate) fn arriving<const N: usize>(
    lights: &[SphereLight],
    position: &[f32x8; 3],
    table: &BlockerTable,
) -> Arriving<N> {
    let mut sum = [[f32x8::ZERO; N]; 3];
    for light in lights {
        let offset: [f32x8; 3] = std::array::from_fn(|axis| f32x8::splat(light.center[axis]) - position[axis]);
        let distance_squared = dot(&offset, &offset);
        let is_around = distance_squared.simd_le(f32x8::splat(light.radius * light.radius));
        let cap = light_cap::<N>(&offset, distance_squared, is_around, light.radius, table);
        for (sum, radiance) in sum.iter_mut().zip(light.radiance.to_array()) {
            sum.iter_mut().zip(&cap).for_each(|(sum, cap)| *sum = cap.mul_add(f32x8::splat(radiance), *sum));
        }
    }
    sum
}

/// Vectors of three channels point after point, interpolated at eight places.
pub(crate) fn between_points<const N: usize>(points: &[[f32; N]], around: &[Around; LANES]) -> Arriving<N> {
    let mut found = [[[0.0_f32; LANES]; N]; 3];
    for (lane, around) in around.iter().enumerate() {
        let mut sum = [[0.0_f32; N]; 3];
        for &(point, weight) in around {
            for (sum, vector) in sum.iter_mut().zip(&points[3 * point..]) {
                sum.iter_mut().zip(vector).for_each(|(sum, value)| *sum = weight.mul_add(*value, *sum));
            }
        }
        for (found, sum) in found.iter_mut().zip(sum) {
            found.iter_mut().zip(sum).for_each(|(found, value)| found[lane] = value);
        }
    }
    found.map(|channel| channel.map(f32x8::from))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::{prt::kernel::grid::Grid, shared::test_scenes::random};
    use glam::Vec3;
    use halfshade_sh::{blocker_table::Quantity, zonal};

    /// Caps in double precision.
    #[test]
    fn lights_are_their_caps() {
        const N: usize = 25;
        let table = BlockerTable::build(5, Quantity::BlockerMinusOne).unwrap();
        let mut random = random(3);
        let mut place = |scale: f32| scale * Vec3::new(random(), random(), random());
        let lights: [SphereLight; 3] = std::array::from_fn(|number| SphereLight {
            center: place(2.0),
            radius: [0.01, 0.3, 0.9][number],
            radiance: place(1.0).abs(),
        });
        // The first lies within a light.
        let places: [Vec3; LANES] =
            std::array::from_fn(|lane| if lane == 0 { lights[2].center + 0.1 * Vec3::X } else { place(3.0) });
        let position = std::array::from_fn(|axis| f32x8::from(places.map(|place| place[axis])));
        let found = arriving::<N>(&lights, &position, &table);
        for (lane, place) in places.into_iter().enumerate() {
            let mut exact = vec![[0.0; 3]; N];
            for light in &lights {
                let offset = (light.center - place).as_dvec3();
                let sine = f64::from(light.radius) / offset.length();
                let cosine = if sine >= 1.0 { -1.0 } else { (1.0 - sine * sine).sqrt() };
                let cap = zonal::rotate_to_axis(&zonal::cap(5, cosine), offset.normalize().to_array());
                for (exact, cap) in exact.iter_mut().zip(cap) {
                    (0..3).for_each(|channel| exact[channel] += cap * f64::from(light.radiance[channel]));
                }
            }
            for (i, exact) in exact.iter().enumerate() {
                for channel in 0..3 {
                    let found = f64::from(found[channel][i].to_array()[lane]);
                    assert!((found - exact[channel]).abs() < 2e-5, "{lane} {i}: {found} {}", exact[channel]);
                }
            }
        }
    }

    #[test]
    fn light_between_points_is_linear() {
        const N: usize = 4;
        let grid = Grid::around([Vec3::ZERO, Vec3::new(2.0, 1.0, 1.0)], 2);
        let linear = |place: Vec3, number: usize| place.dot(Vec3::new(0.3, -0.7, 0.2)) + number as f32;
        let points: Vec<[f32; N]> = (0..3 * grid.len())
            .map(|row| std::array::from_fn(|i| linear(grid.point(row / 3), row % 3 * N + i)))
            .collect();
        let places: [Vec3; LANES] =
            std::array::from_fn(|lane| 0.1 * lane as f32 * Vec3::new(2.0, 0.5, 1.0) + Vec3::splat(0.1));
        let found = between_points(&points, &places.map(|place| grid.weights(place)));
        for (lane, place) in places.into_iter().enumerate() {
            for (channel, i) in (0..3).flat_map(|channel| (0..N).map(move |i| (channel, i))) {
                let found = found[channel][i].to_array()[lane];
                assert!((found - linear(place, channel * N + i)).abs() < 1e-5);
            }
        }
    }
}
