//! All directions in cells: the grids over two hemispheres, and the light that each cell has.

use crate::cosine_lobe::kernel::{environment::Cells8, square::Square};
use glam::Vec3;
use halfshade_sh::lobe::LobeSum;
use rayon::prelude::*;
use std::f32::consts::TAU;
use wide::f32x8;

/// Points along a side of a cell, at which light is looked up.
const STEPS: usize = 8;

/// Flux that counts as none, of light whose brightest is about 1: far from subnormal when it is weighted.
const DARK: f32 = 1e-30;

/// The axes of both squares, at right angles: about the zenith, and about the nadir.
pub(crate) const FRAMES: [[[f32; 3]; 3]; 2] =
    [[[1.0, 0.0, 0.0], [0.0, 0.0, 1.0], [0.0, 1.0, 0.0]], [[1.0, 0.0, 0.0], [0.0, 0.0, 1.0], [0.0, -1.0, 0.0]]];

/// The cells of both hemispheres, one after the other, in the order of their covers, of light as bright as 1.
pub(crate) fn cells(side: usize, light: &LobeSum) -> [Vec<Cells8>; 2] {
    FRAMES.map(|frame| {
        let square = Square::hemisphere(frame);
        (0..side * side / 8)
            .into_par_iter()
            .map(|group| gathered(std::array::from_fn(|lane| cell(side, 8 * group + lane, &square, light))))
            .collect()
    })
}

/// One cell: direction, solid angle, flux.
#[derive(Debug, Clone, Copy)]
struct CellLight {
    direction: Vec3,
    solid_angle: f32,
    flux: Vec3,
}

/// One cell, by the midpoint rule over the part of it that lies in the disc.
fn cell(side: usize, cell: usize, square: &Square, light: &LobeSum) -> CellLight {
    let steps = STEPS * side;
    let at = |cell: usize, step: usize| 2.0 * ((cell * STEPS + step) as f32 + 0.5) / steps as f32 - 1.0;
    let area = (2.0 / steps as f32).powi(2);
    let (mut middle, mut bright_middle, mut solid_angle, mut flux) = (Vec3::ZERO, Vec3::ZERO, 0.0, Vec3::ZERO);
    for i in 0..STEPS * STEPS {
        let (x, y) = (at(cell % side, i % STEPS), at(cell / side, i / STEPS));
        if x.hypot(y) >= 1.0 {
            continue;
        }
        let (x, y) = (f32x8::splat(x), f32x8::splat(y));
        let direction = Vec3::from(square.directions(x, y).map(|axis| axis.to_array()[0]));
        let part = square.stretch(x, y).to_array()[0].powi(2) * area;
        let radiance = Vec3::from(light.radiance(direction.to_array().map(f64::from)).map(|channel| channel as f32));
        solid_angle += part;
        flux += part * radiance;
        middle += part * direction;
        bright_middle += part * radiance.element_sum() * direction;
    }
    // A sharp lobe far from its axis may be subnormal, which is slow to multiply.
    let flux = Vec3::select(flux.cmplt(Vec3::splat(DARK)), Vec3::ZERO, flux);
    let direction = bright_middle.try_normalize().unwrap_or_else(|| middle.normalize_or(Vec3::Y));
    CellLight { direction, solid_angle, flux }
}

fn gathered(cells: [CellLight; 8]) -> Cells8 {
    let lanes = |get: &dyn Fn(&CellLight) -> f32| f32x8::from(cells.each_ref().map(get));
    let solid_angle = lanes(&|cell| cell.solid_angle);
    let inverse = f32x8::ONE / solid_angle.fast_max(f32x8::splat(1e-9));
    Cells8 {
        direction: std::array::from_fn(|axis| lanes(&|cell| cell.direction[axis])),
        exponent: (f32x8::splat(TAU) * inverse - f32x8::ONE).fast_max(f32x8::ZERO),
        per_solid_angle: solid_angle.simd_gt(f32x8::ZERO).select(inverse, f32x8::ZERO),
        flux: std::array::from_fn(|channel| lanes(&|cell| cell.flux[channel])),
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use halfshade_sh::lobe::ColoredLobe;
    use std::f64::consts::TAU;

    fn sum_of(cells: &[Vec<Cells8>; 2], get: impl Fn(&Cells8) -> f32x8) -> f32 {
        cells.iter().flatten().map(|group| get(group).reduce_add()).sum()
    }

    #[test]
    fn cells_have_all_the_light_there_is() {
        let lobe = ColoredLobe { axis: [0.6, -0.64, 0.48], exponent: 40.0, scale: [1.0, 2.0, 0.0] };
        let light = LobeSum { uniform: [0.0, 0.0, 0.25], lobes: vec![lobe] };
        for side in [8, 16, 32] {
            let cells = cells(side, &light);
            let area = sum_of(&cells, |group| {
                group.per_solid_angle.simd_gt(f32x8::ZERO).select(f32x8::ONE / group.per_solid_angle, f32x8::ZERO)
            });
            let power = 41.0 / TAU as f32;
            let flux = [0, 1, 2].map(|channel| sum_of(&cells, |group| group.flux[channel]));
            assert!((area / (2.0 * TAU as f32) - 1.0).abs() < 0.01, "{side}: {area}");
            assert!((flux[0] * power - 1.0).abs() < 0.01 && (flux[1] * power - 2.0).abs() < 0.02, "{side}: {flux:?}");
            assert!((flux[2] / TAU as f32 - 0.5).abs() < 5e-3, "{side}: {flux:?}");
            // Where it comes from.
            let middle: [f32; 3] =
                std::array::from_fn(|axis| sum_of(&cells, |group| group.direction[axis] * group.flux[0]));
            let middle = Vec3::from(middle).normalize();
            assert!(middle.distance(Vec3::new(0.6, -0.64, 0.48)) < 0.01, "{middle}");
        }
    }

    /// Subnormal numbers take a hundred times as long to multiply.
    #[test]
    fn no_cell_is_subnormal() {
        let lobe = |axis, exponent| ColoredLobe { axis, exponent, scale: [1.0, 1e-9, 3.0] };
        let lobes = vec![lobe([0.6, -0.64, 0.48], 900.0), lobe([0.0, 1.0, 0.0], 60.0)];
        let cells = cells(32, &LobeSum { uniform: [0.0; 3], lobes });
        let fluxes = || cells.iter().flatten().flat_map(|group| group.flux).flat_map(f32x8::to_array);
        assert!(fluxes().all(|flux| flux == 0.0 || flux >= DARK));
        assert!(fluxes().any(|flux| flux > 0.01) && fluxes().any(|flux| flux == 0.0));
    }
}
