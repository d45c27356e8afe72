//! The least window under which an SH function is nowhere negative, after \[Sloan2017\].
//!
//! Light is nowhere negative, but what few bands keep of it may be, and then darkens what it falls on below black. A window mends
//! that, and blurs; the least one that mends it blurs least. Windows are those of the least squared Laplacian
//! ([`Window::Laplacian`]), whose weight is found by cutting planes: at the lowest direction so far, the weight that lifts it to 0 has
//! a simple bisection, since bands are sums there; the next lowest direction of the function so windowed is another one,
//! until there is none below 0.

use crate::{basis, quadrature::golden_spiral, window::Window};

/// Samples for each coefficient: neighbours are then a third of the shortest wave apart.
const SAMPLES_PER_COEFFICIENT: usize = 24;

/// Lowest samples from which a minimum is looked for.
const STARTS: usize = 6;

/// Depth below 0, as a part of the function's mean, that counts as none.
const TOLERANCE: f64 = 1e-9;

/// Largest weight: of band 1 it leaves a millionth.
const LARGEST: f64 = 2.5e5;

/// Directions at which functions of a number of bands are looked at.
#[derive(Debug, Clone)]
pub struct MinimumSearch {
    bands: usize,
    directions: Vec<[f64; 3]>,
    /// Basis functions along each.
    basis: Vec<f64>,
}

/// A direction and the function's value there.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Minimum {
    /// Unit direction.
    pub direction: [f64; 3],
    /// Value.
    pub value: f64,
}

impl MinimumSearch {
    /// For functions of so many bands.
    pub fn new(bands: usize) -> Self {
        let directions: Vec<[f64; 3]> =
            golden_spiral(SAMPLES_PER_COEFFICIENT * basis::coefficient_count(bands)).collect();
        let basis = directions.iter().flat_map(|&direction| basis::evaluate(bands, direction)).collect();
        Self { bands, directions, basis }
    }

    /// The minimum of a function over the sphere: that of the lowest samples, each followed down to within 1e-6 radians.
    ///
    /// # Panics
    /// If the function has another number of coefficients.
    pub fn minimum(&self, function: &[f64]) -> Minimum {
        let count = basis::coefficient_count(self.bands);
        assert_eq!(function.len(), count, "one coefficient per basis function");
        let values = self.basis.chunks_exact(count.max(1)).map(|y| basis::dot(function, y));
        let mut samples: Vec<(f64, usize)> = values.zip(0..).collect();
        let starts = STARTS.min(samples.len());
        if starts < samples.len() {
            samples.select_nth_unstable_by(starts, |a, b| a.0.total_cmp(&b.0));
        }
        let found = samples[..starts].iter().map(|&(value, k)| {
            let spacing = (4.0 * std::f64::consts::PI / self.directions.len() as f64).sqrt();
            descend(function, Minimum { direction: self.directions[k], value }, spacing)
        });
        let none = Minimum { direction: [0.0, 0.0, 1.0], value: 0.0 };
        found.reduce(|a, b| if b.value < a.value { b } else { a }).unwrap_or(none)
    }

    /// The least window that leaves the function nowhere below 0, up to a billionth of its mean; none if it is so already, nor if its
    /// mean isn't above 0, which no window changes.
    pub fn least_window(&self, function: &[f64]) -> Window {
        let mean = function.first().copied().unwrap_or(0.0) * basis::evaluate(1, [0.0, 0.0, 1.0])[0];
        // Nor of what isn't a number.
        if !(mean > 0.0 && function.iter().all(|value| value.is_finite())) {
            return Window::None;
        }
        let mut lambda = 0.0;
        // Each round lifts one more direction, and comes nearer by the square.
        for _ in 0..32 {
            let mut windowed = function.to_vec();
            Window::Laplacian { lambda }.apply(&mut windowed);
            let lowest = self.minimum(&windowed);
            if lowest.value >= -TOLERANCE * mean || lambda >= LARGEST {
                break;
            }
            lambda = lifting(&sums_of_bands(function, lowest.direction), lambda);
        }
        if lambda == 0.0 { Window::None } else { Window::Laplacian { lambda } }
    }
}

/// The least weight above `least` at which the windowed sum of bands isn't negative.
fn lifting(bands: &[f64], least: f64) -> f64 {
    let value = |lambda: f64| -> f64 {
        let window = Window::Laplacian { lambda };
        bands.iter().enumerate().map(|(l, sum)| window.factor(l, bands.len()) * sum).sum()
    };
    // By its size: weights span many of them.
    let (mut low, mut high) = (least.max(1e-9), least.max(1e-9));
    while value(high) < 0.0 && high < LARGEST {
        (low, high) = (high, (2.0 * high).min(LARGEST));
    }
    for _ in 0..60 {
        let middle = 0.5 * (low + high);
        (low, high) = if value(middle) < 0.0 { (middle, high) } else { (low, middle) };
    }
    high
}

/// Parts of the bands in the value along a direction.
fn sums_of_bands(function: &[f64], direction: [f64; 3]) -> Vec<f64> {
    let bands = function.len().isqrt();
    let y = basis::evaluate(bands, direction);
    (0..bands).map(|l| (l * l..(l + 1) * (l + 1)).map(|i| function[i] * y[i]).sum()).collect()
}

/// Follows a function down from a direction: to the bottom of the paraboloid through six directions around it, as far as they are
/// apart at most, which come nearer where none is lower.
fn descend(function: &[f64], start: Minimum, spacing: f64) -> Minimum {
    let (mut lowest, mut step) = (start, 0.5 * spacing);
    let mut y = vec![0.0; function.len()];
    // Far more often than it takes.
    for _ in 0..200 {
        if step < 1e-6 {
            break;
        }
        let middle = lowest;
        let axes = across(middle.direction);
        let mut look = |[a, b]: [f64; 2]| {
            let shifted: [f64; 3] =
                std::array::from_fn(|i| middle.direction[i] + step * (a * axes[0][i] + b * axes[1][i]));
            let length = basis::magnitude(&shifted);
            let direction = shifted.map(|value| value / length);
            basis::evaluate_into(function.len().isqrt(), direction, &mut y);
            let value = basis::dot(function, &y);
            if value < lowest.value {
                lowest = Minimum { direction, value };
            }
            value - middle.value
        };
        let [east, west, north, south, both] =
            [[1.0, 0.0], [-1.0, 0.0], [0.0, 1.0], [0.0, -1.0], [1.0, 1.0]].map(&mut look);
        let slope = [0.5 * (east - west), 0.5 * (north - south)];
        let bend = [east + west, north + south, both - east - north];
        let determinant = bend[0] * bend[1] - bend[2] * bend[2];
        if determinant > 0.0 && bend[0] > 0.0 {
            let jump = [
                (bend[2] * slope[1] - bend[1] * slope[0]) / determinant,
                (bend[2] * slope[0] - bend[0] * slope[1]) / determinant,
            ];
            look(jump.map(|value| value.clamp(-1.0, 1.0)));
        }
        let moved = (0..3).map(|i| (lowest.direction[i] - middle.direction[i]).powi(2)).sum::<f64>().sqrt();
        if moved < 0.5 * step {
            step *= 0.25;
        }
    }
    lowest
}

/// Two unit vectors at right angles to a unit vector and to each other.
fn across([x, y, z]: [f64; 3]) -> [[f64; 3]; 2] {
    // Along the axis that it is farthest from.
    let first = if x.abs() < 0.6 { [0.0, z, -y] } else { [-z, 0.0, x] };
    let length = basis::magnitude(&first);
    let [a, b, c] = first.map(|value| value / length);
    [[a, b, c], [y * c - z * b, z * a - x * c, x * b - y * a]]
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::zonal;

    fn lobes(bands: usize, seed: usize) -> Vec<f64> {
        let mut sum = vec![0.0; bands * bands];
        for k in 0..1 + seed % 3 {
            let [a, b] = [(7 * seed + 3 * k) as f64, (5 * seed + 11 * k) as f64];
            let axis = [a.sin() * b.cos(), a.sin() * b.sin(), a.cos()];
            let cap = zonal::rotate_to_axis(&zonal::cap(bands, 0.95 - 0.2 * k as f64), axis);
            sum.iter_mut().zip(cap).for_each(|(sum, value)| *sum += (1 + k) as f64 * value);
        }
        sum
    }

    /// No direction of a grid of 0.4 degrees is lower.
    fn brute_force(function: &[f64]) -> f64 {
        let (rows, columns) = (450, 900);
        let values = (0..=rows).flat_map(|row| {
            let (sin, cos) = (std::f64::consts::PI * f64::from(row) / f64::from(rows)).sin_cos();
            (0..columns).map(move |column| {
                let (y, x) = (std::f64::consts::TAU * f64::from(column) / f64::from(columns)).sin_cos();
                [sin * x, sin * y, cos]
            })
        });
        values.map(|direction| basis::reconstruct(function, direction)).fold(f64::INFINITY, f64::min)
    }

    #[test]
    fn minima_are_those_of_brute_force() {
        for (bands, seed) in [(2, 0), (3, 1), (5, 2), (8, 4)] {
            let function = lobes(bands, seed);
            let found = MinimumSearch::new(bands).minimum(&function);
            let grid = brute_force(&function);
            let size = basis::magnitude(&function);
            assert!(found.value <= grid + 1e-9 * size, "{bands} {seed}: {} {grid}", found.value);
            assert!(found.value > grid - 2e-3 * size, "{bands} {seed}: {} {grid}", found.value);
            assert!((basis::reconstruct(&function, found.direction) - found.value).abs() < 1e-12 * size);
        }
    }

    /// Under the window nothing is below 0, under one of a little less weight something is.
    #[test]
    fn the_window_is_the_least_one() {
        for (bands, seed) in [(2, 0), (3, 1), (4, 2), (6, 3)] {
            let function = lobes(bands, seed);
            let Window::Laplacian { lambda } = MinimumSearch::new(bands).least_window(&function) else {
                panic!("{bands} {seed} rings")
            };
            let lowest = |lambda: f64| {
                let mut windowed = function.clone();
                Window::Laplacian { lambda }.apply(&mut windowed);
                brute_force(&windowed) / windowed[0]
            };
            assert!(lowest(lambda) > -1e-9 && lowest(0.98 * lambda) < 0.0, "{bands} {seed}: {lambda}");
        }
    }

    #[test]
    fn ends_need_no_window_or_have_none() {
        let search = MinimumSearch::new(3);
        let constant = basis::one(3);
        for function in [constant, vec![0.0; 9], vec![-1.0; 9], vec![f64::NAN; 9]] {
            assert_eq!(search.least_window(&function), Window::None);
        }
        // A linear function that is all but negative, and one that no window but the largest mends.
        let linear = [1.0, 0.0, 5e4, 0.0];
        let Window::Laplacian { lambda } = MinimumSearch::new(2).least_window(&linear) else { panic!("rings") };
        // f = y_0 + 5e4 w y_1: w = 1/(5e4 √3), and w = 1/(1 + 4λ).
        assert!((lambda / (0.25 * (5e4 * 3_f64.sqrt() - 1.0)) - 1.0).abs() < 1e-6, "{lambda}");
        assert_eq!(MinimumSearch::new(1).least_window(&[1.0]), Window::None);
    }
}
