//! Sums of products of lobes by quadrature over directions, `integration=sampled`: what is left of the difference to the
//! default is the error of products and their table [Meunier2009, 6, figure 15].
//!
//! Directions are spread as the sharpest of the lobes a, b, c, so that the others hardly vary over them:
//!
//! ```text
//! ∫ a b c dω = ∫ a dω · mean of b(ω) c(ω)        ∫ a dω = 2π s/(e+1)        cos θ = u^(1/(e+1)),  φ golden angles
//! ```
//!
//! In f64 by the lobes themselves: no table, no product. A spiral of n directions errs by about 1/n of what a
//! product varies over the sharpest lobe. The same for every lobe, so a receiver gets the same bits whoever its neighbours are.

use super::cell_lobes::CellLobes;
use halfshade_sh::lobe::{Lobe, Lobe8};
use std::f64::consts::TAU;

/// Fraction of a turn from one direction of the spiral to the next. Directions of halfshade-sh's `golden_spiral` are
/// spread evenly over the sphere; here they are spread as each lobe is, of which only azimuths are alike.
const GOLDEN: f64 = 0.618_033_988_749_894_8;

/// Where on a lobe it is looked up.
#[derive(Debug, Clone, Copy)]
struct Point {
    /// ln u.
    ln_share: f64,
    /// Sine and cosine of φ.
    turn: [f64; 2],
}

/// Quadrature with a number of directions per integral.
#[derive(Debug)]
pub(crate) struct Sampler(Vec<Point>);

impl Sampler {
    pub(crate) fn new(count: usize) -> Self {
        let point = |i: usize| {
            let (sin, cos) = (TAU * (GOLDEN * i as f64).fract()).sin_cos();
            Point { ln_share: ((i as f64 + 0.5) / count as f64).ln(), turn: [sin, cos] }
        };
        Self((0..count).map(point).collect())
    }

    pub(crate) fn bytes(&self) -> usize {
        size_of_val(self.0.as_slice())
    }

    /// `∫ Π c dω` of one lobe or more.
    pub(crate) fn integral(&self, lobes: &[Lobe]) -> f64 {
        let sharpness = |i: &usize| lobes[*i].exponent;
        let Some(sharpest) = (0..lobes.len()).max_by(|a, b| sharpness(a).total_cmp(&sharpness(b))) else { return 0.0 };
        let lobe = &lobes[sharpest];
        let all = lobe.integral();
        if all == 0.0 {
            return 0.0;
        }
        let others = || lobes.iter().enumerate().filter(|(i, _)| *i != sharpest).map(|(_, other)| other);
        let [t, b, a] = frame_about(lobe.axis);
        // 1/(e+1), e within its bounds.
        let power = all / (TAU * lobe.scale);
        let value = |point: &Point| {
            let cosine = (power * point.ln_share).exp();
            // 1 - cos² without the digits that it would lose near 1.
            let sine = (-(2.0 * power * point.ln_share).exp_m1()).sqrt();
            let [y, x] = point.turn.map(|part| sine * part);
            let direction = std::array::from_fn(|i| x * t[i] + y * b[i] + cosine * a[i]);
            others().map(|other| other.value(direction)).product::<f64>()
        };
        all * self.0.iter().map(value).sum::<f64>() / self.0.len() as f64
    }

    /// `∫ a b dω` of the lobes of the first lane.
    pub(crate) fn integral_of_lanes(&self, first: &Lobe8, second: &Lobe8) -> f32 {
        self.integral(&[first.lane(0), second.lane(0)]) as f32
    }

    /// `Σ ∫ factor·light·lobe` over all cells; a factor is the same in every lane, and there may be no light.
    pub(crate) fn sum(&self, factor: &Lobe8, light: Option<&Lobe8>, cells: &CellLobes) -> f32 {
        let factor = factor.lane(0);
        let of_cell = |cell| match light {
            Some(light) => self.integral(&[factor, light.lane(0), cell]),
            None => self.integral(&[factor, cell]),
        };
        cells.each().map(of_cell).sum::<f64>() as f32
    }
}

/// Two directions across an axis of about unit length, and it.
fn frame_about(axis: [f64; 3]) -> [[f64; 3]; 3] {
    let axis = glam::DVec3::from(axis).normalize_or(glam::DVec3::Y);
    let (t, b) = axis.any_orthonormal_pair();
    [t, b, axis].map(|direction| direction.to_array())
}

#[cfg(test)]
mod tests {
    use super::*;
    use halfshade_sh::lobe::product_integral;

    fn lobe(angle: f64, exponent: f64, scale: f64) -> Lobe {
        Lobe { axis: [angle.sin(), 0.8 * angle.cos(), 0.6 * angle.cos()], exponent, scale }
    }

    /// Against the quadrature of `halfshade_sh`, another rule in another frame.
    #[test]
    fn products_of_two_are_those_of_the_reference() {
        let sampler = Sampler::new(256);
        for angle in [0.0, 0.3, 1.0, 1.5, 2.5] {
            for [e1, e2] in [[0.0, 40.0], [1.0, 1.0], [1.0, 300.0], [30.0, 1e5], [500.0, 700.0]] {
                let (a, b) = (lobe(0.0, e1, 1.5), lobe(angle, e2, 2.0));
                let exact = product_integral(&a, &b);
                let found = sampler.integral(&[b, a]);
                // A fraction of what the sharper has in all.
                let allowed = 5e-3 * (exact + 0.4 * b.integral().min(a.integral()));
                assert!((found - exact).abs() < allowed, "{angle} {e1} {e2}: {found} {exact}");
            }
        }
    }

    #[test]
    fn products_of_three_about_one_axis_have_a_closed_form_and_more_directions_come_nearer() {
        let lobes = [lobe(0.7, 3.0, 2.0), lobe(0.7, 20.0, 0.5), lobe(0.7, 6.5, 3.0)];
        let exact = Lobe { exponent: 29.5, scale: 3.0, ..lobes[0] }.integral();
        let errors = [16, 256, 4096].map(|count| (Sampler::new(count).integral(&lobes) / exact - 1.0).abs());
        assert!(errors[0] < 1e-2 && errors[1] < 1e-3 && errors[2] < 1e-4, "{errors:?}");
    }

    #[test]
    fn nothing_and_extremes_are_finite() {
        let sampler = Sampler::new(8);
        assert_eq!(sampler.integral(&[]), 0.0);
        assert_eq!(sampler.integral(&[lobe(0.0, 5.0, 0.0), lobe(0.1, 2.0, 1.0)]), 0.0);
        for exponent in [0.0, 1e-3, 1e5, 1e7] {
            for axis in [[0.0; 3], [0.0, 0.0, 1e-30], [0.0, -1.0, 0.0]] {
                let value = sampler.integral(&[Lobe { axis, exponent, scale: 1.0 }, lobe(0.2, 1.0, 1.0)]);
                assert!(value.is_finite() && value >= 0.0, "{exponent} {axis:?}");
            }
        }
    }
}
