//! Radiance over all directions as a constant and a few coloured lobes, fitted to a latitude-longitude image.
//!
//! [Meunier2009] has lobes for spherical lights only; this is beyond it. The image is averaged over a grid of
//! [`COLUMNS`](grid::COLUMNS) by [`ROWS`](grid::ROWS) cells, and `L(v) = u + Σ s_j max(a_j·v, 0)^e_j` found with `u,
//! s_j ≥ 0` that minimizes
//!
//! ```text
//! mean over directions of |L - image|²  +  λ · mean over normals of |E(L) - E(image)|²/π²
//! ```
//!
//! with irradiance E, since that is what a diffuse surface shows. Lobes are chosen one by one from a ladder of axes and
//! exponents, each the one that explains most of what is left, and all scales are fitted anew after each
//! (`matching_pursuit.rs`, `nonnegative.rs`); then axes and exponents are moved to where they explain more. No step is
//! random.

mod grid;
mod matching_pursuit;

use super::{Lobe, LobeTable};
use grid::{averaged, solid_angle};
use matching_pursuit::MatchingPursuit;
use std::f64::consts::PI;

/// How much more irradiance counts in the end, when axes and exponents stand: light that no lobe is narrow enough for has
/// its power then.
const EMPHASIS: f64 = 10.0;

/// Number of times that all lobes are moved.
const SWEEPS: usize = 12;

/// A lobe of RGB radiance.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct ColoredLobe {
    /// Unit axis.
    pub axis: [f64; 3],
    /// Exponent.
    pub exponent: f64,
    /// Radiance on the axis per channel, at least 0.
    pub scale: [f64; 3],
}

/// `L(v) = u + Σ_j s_j max(a_j·v, 0)^e_j` in the unit of radiance per channel.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct LobeSum {
    /// u, the same from everywhere.
    pub uniform: [f64; 3],
    /// All others.
    pub lobes: Vec<ColoredLobe>,
}

impl LobeSum {
    /// The sum of at most `count` lobes and a constant that is near to an RGB image: by radiance, mean square over
    /// directions, and a thousand times as much by irradiance over π, mean square over normals.
    ///
    /// Row 0 is the zenith (+Y); the centre column looks along -Z and columns run toward +X, rows and columns at equal
    /// steps of polar angle and azimuth, radiance constant over a texel. Texels that are negative or not finite count
    /// as 0. `None` if `texels` does not have `width·height` entries or either is 0. The same bits on any number of
    /// threads. Light narrower than a cell of the grid is smeared over it.
    pub fn fit(count: usize, width: usize, height: usize, texels: &[[f32; 3]], table: &LobeTable) -> Option<Self> {
        if width == 0 || height == 0 || width.checked_mul(height) != Some(texels.len()) {
            return None;
        }
        let radiance = averaged(width, height, texels);
        // Scaled to a mean of 1.
        let total: f64 = radiance.iter().enumerate().map(|(i, value)| solid_angle(i) * value.iter().sum::<f64>()).sum();
        let strength = total / (12.0 * PI);
        if strength <= 0.0 {
            return Some(Self::default());
        }
        let mut fit = MatchingPursuit::new(table, radiance.iter().map(|value| value.map(|x| x / strength)).collect());
        for _ in 0..count {
            if !fit.add() {
                break;
            }
            fit.solve(1.0);
        }
        for sweep in 0..SWEEPS {
            fit.sweep(0.5f64.powi(sweep as i32 / 2));
            fit.solve(1.0);
        }
        fit.solve(EMPHASIS);
        let scaled = |scale: [f64; 3]| scale.map(|x| x * strength);
        let lobes = fit.shapes[1..].iter().zip(&fit.scales[1..]);
        Some(Self {
            uniform: scaled(fit.scales[0]),
            lobes: lobes
                .filter(|(_, scale)| scale.iter().any(|x| *x > 0.0))
                .map(|(shape, scale)| ColoredLobe { axis: shape.axis, exponent: shape.exponent, scale: scaled(*scale) })
                .collect(),
        })
    }

    /// The value in a unit direction.
    pub fn radiance(&self, direction: [f64; 3]) -> [f64; 3] {
        self.lobes.iter().fold(self.uniform, |mut sum, ColoredLobe { axis, exponent, scale }| {
            let value = Lobe { axis: *axis, exponent: *exponent, scale: 1.0 }.value(direction);
            sum.iter_mut().zip(scale).for_each(|(sum, scale)| *sum += scale * value);
            sum
        })
    }
}

#[cfg(test)]
mod tests {
    use super::matching_pursuit::Shape;
    use super::*;
    use crate::lobe::ProductRule;
    use crate::{basis::dot, quadrature::golden_spiral};
    use std::f64::consts::TAU;
    use std::sync::LazyLock;

    static TABLE: LazyLock<LobeTable> = LazyLock::new(|| LobeTable::build(ProductRule::Moments));

    /// A function over a fine grid.
    fn painted(width: usize, height: usize, radiance: impl Fn([f64; 3]) -> [f64; 3]) -> Vec<[f32; 3]> {
        (0..width * height)
            .map(|i| {
                let polar = PI * ((i / width) as f64 + 0.5) / height as f64;
                let azimuth = TAU * (((i % width) as f64 + 0.5) / width as f64 - 0.5);
                radiance([polar.sin() * azimuth.sin(), polar.cos(), -polar.sin() * azimuth.cos()]).map(|x| x as f32)
            })
            .collect()
    }

    /// Irradiance over π by the midpoint rule, equal steps of sin² of the polar angle.
    fn irradiance(normal: [f64; 3], radiance: &dyn Fn([f64; 3]) -> [f64; 3]) -> [f64; 3] {
        let shape = Shape { axis: normal, exponent: 1.0 };
        let (rings, spokes) = (100, 200);
        let mut sum = [0.0; 3];
        for i in 0..rings * spokes {
            let sine_squared = (f64::from(i / spokes) + 0.5) / f64::from(rings);
            let tangent = (sine_squared / (1.0 - sine_squared)).sqrt();
            let (s, c) = (TAU * f64::from(i % spokes) / f64::from(spokes) + 0.6 * f64::from(i / spokes)).sin_cos();
            let value = radiance(shape.moved([tangent * c, tangent * s, 0.0]).axis);
            sum.iter_mut().zip(value).for_each(|(sum, value)| *sum += value / f64::from(rings * spokes));
        }
        sum
    }

    /// A sky, a warm window, and a small bright lamp, soft at their edges.
    fn room(direction: [f64; 3]) -> [f64; 3] {
        let panel = |axis: [f64; 3], radius: f64, softness: f64| {
            let angle = dot(&super::super::pair::unit(axis), &direction).clamp(-1.0, 1.0).acos();
            ((radius - angle) / softness + 0.5).clamp(0.0, 1.0)
        };
        let sky = 0.6 + 0.4 * direction[1];
        let (window, lamp) = (panel([1.0, 0.6, 0.3], 0.4, 0.2), panel([-0.3, 1.0, 0.8], 0.12, 0.1));
        [
            0.5 * sky + 5.0 * window + 20.0 * lamp,
            0.6 * sky + 4.0 * window + 20.0 * lamp,
            sky + 2.0 * window + 22.0 * lamp,
        ]
    }

    /// Largest error of irradiance over its mean, and RMS error of radiance over its RMS.
    fn errors(count: usize) -> (f64, f64) {
        let texels = painted(256, 128, room);
        let sum = LobeSum::fit(count, 256, 128, &texels, &TABLE).unwrap();
        assert!(sum.lobes.len() <= count);
        let (mut worst, mut mean) = (0.0f64, 0.0);
        for normal in golden_spiral(40) {
            let (found, exact) = (irradiance(normal, &|v| sum.radiance(v)), irradiance(normal, &room));
            (0..3).for_each(|i| worst = worst.max((found[i] - exact[i]).abs()));
            mean += exact.iter().sum::<f64>() / 120.0;
        }
        let (mut squares, mut whole) = (0.0, 0.0);
        for direction in golden_spiral(2000) {
            let (found, exact) = (sum.radiance(direction), room(direction));
            squares += (0..3).map(|i| (found[i] - exact[i]).powi(2)).sum::<f64>();
            whole += exact.iter().map(|x| x * x).sum::<f64>();
        }
        (worst / mean, (squares / whole).sqrt())
    }

    #[test]
    fn irradiance_and_radiance_are_near_and_nearer_with_more_lobes() {
        let found = [2, 4, 8, 16, 32].map(errors);
        let bounds = [(0.2, 0.9), (0.15, 0.45), (0.025, 0.25), (0.007, 0.17), (0.003, 0.14)];
        for ((irradiance, radiance), bound) in found.into_iter().zip(bounds) {
            assert!(irradiance < bound.0 && radiance < bound.1, "{found:?}");
        }
    }

    #[test]
    fn a_constant_is_a_constant_and_a_lobe_a_lobe() {
        let constant = LobeSum::fit(8, 5, 3, &[[0.5, 2.0, 0.0]; 15], &TABLE).unwrap();
        assert!(constant.lobes.is_empty(), "{constant:?}");
        for (found, expected) in constant.uniform.iter().zip([0.5, 2.0, 0.0]) {
            assert!((found - expected).abs() < 1e-6, "{found}");
        }
        let lobe = Lobe { axis: super::super::pair::unit([1.0, 0.4, -0.7]), exponent: 30.0, scale: 3.0 };
        let texels = painted(256, 128, |v| [lobe.value(v), 0.5 * lobe.value(v), 0.0]);
        let found = LobeSum::fit(1, 256, 128, &texels, &TABLE).unwrap();
        let only = found.lobes[0];
        assert!(dot(&only.axis, &lobe.axis) > 0.9999 && (only.exponent / lobe.exponent).ln().abs() < 0.05, "{found:?}");
        assert!((only.scale[0] - 3.0).abs() < 0.1 && (only.scale[1] - 1.5).abs() < 0.05 && only.scale[2] == 0.0);
    }

    #[test]
    fn extremes() {
        assert_eq!(LobeSum::fit(4, 2, 2, &[[1.0; 3]; 3], &TABLE), None);
        assert_eq!(LobeSum::fit(4, 0, 0, &[], &TABLE), None);
        assert_eq!(LobeSum::fit(4, 2, 2, &[[0.0; 3]; 4], &TABLE), Some(LobeSum::default()));
        assert!(LobeSum::fit(0, 2, 1, &[[1.0; 3], [3.0; 3]], &TABLE).unwrap().lobes.is_empty());
        for bad in [f32::NAN, f32::INFINITY, -1.0] {
            assert_eq!(LobeSum::fit(4, 2, 1, &[[bad; 3], [0.0; 3]], &TABLE), Some(LobeSum::default()));
        }
        // One texel of 1e6 and one of the smallest numbers there are.
        for strength in [1e6, 1e-38, 1e38] {
            let mut texels = vec![[0.0f32; 3]; 512 * 256];
            texels[40 * 512 + 100] = [strength; 3];
            let found = LobeSum::fit(16, 512, 256, &texels, &TABLE).unwrap();
            let power: f64 = found.lobes.iter().map(|lobe| lobe.scale[0] * TAU / (lobe.exponent + 1.0)).sum();
            let edge = |row: usize| (PI * row as f64 / 256.0).cos();
            let exact = f64::from(strength) * TAU / 512.0 * (edge(40) - edge(41));
            assert!((power / exact - 1.0).abs() < 0.1, "{power} {exact} {found:?}");
        }
    }
}
