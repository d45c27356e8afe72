//! Products of lobes tabulated in coordinates in which they are smooth.
//!
//! [Meunier2009, 4.1] tabulates axis, scale and exponent over both exponents and the angle, and needs many samples
//! (under 10 MB, hours): all of them vary by orders of magnitude, and over angles as narrow as the lobes. Here the axis
//! is closed form and what is stored are ratios to closed forms (see [`product`](super::product)), numbers near 1:
//! - the product's integral to `2πP c/n`;
//! - published: `(e_r+1)/n`, and `p_r (1+sqrt(g))/(2 P g^(1/4))`, the fit of a Gaussian;
//! - moments: `(e_r+1)(1+g)/(2 n sqrt(g))`, the mean of a Gaussian's variances, and the τ for which the mean vector is at the
//!   peak for the exponents e1 + τ and e2 + τ: 0 where lobes are smooth over the product, 0.64 where the edge of a hemisphere
//!   cuts a narrow lobe, below 1 everywhere.
//!
//! Coordinates are `t/(1+t)`, [0, 1], of t = sqrt(e1), sqrt(e2) and sqrt(1/g - 1), the last for the balanced point: no
//! exponent and no angle is outside. Square roots, because the integral is linear in α near α = 0 for small exponents,
//! and because a peak's place near the edge of a lobe goes with the root of that lobe's exponent. All is symmetric in
//! the two lobes, so half of the pairs of exponents is kept.
//!
//! The published rule stays rough where an exponent is near 0, since its axis then moves onto the edge of that
//! lobe, and depends on the order of the limits where both are.

use super::ProductRule;
use super::pair::angle_of_g;
use super::product::Pair;
use crate::kernel::LANES;
use rayon::prelude::*;
use wide::{f32x8, i32x8};

/// Intervals of either exponent's coordinate. Even, so that the exponent 1 of a diffuse surface is a node.
const EXPONENTS: usize = 24;

/// Intervals of the coordinate of g.
const WIDTHS: usize = 48;

/// Ratios per node.
const RATIOS: usize = LANES / 2;

/// Exponent that stands for the limit at infinity.
const NEARLY_INFINITE: f64 = 1e6;

/// g that stands for the limit at opposite axes.
const NEARLY_ZERO: f64 = 1e-6;

/// g that stands for the limit at equal axes, where a limit is needed.
const NEARLY_ONE: f64 = 1.0 - 1e-6;

/// Products of two lobes by one rule: axis, exponent, scale and integral for eight pairs at a time, 488 KiB.
///
/// Built in parallel; the same bits on any number of threads.
#[derive(Debug, Clone)]
pub struct LobeTable {
    rule: ProductRule,
    /// By pair of exponents, the smaller first, then by interval of g: the ratios at its start and their differences to
    /// its end.
    rows: Vec<f32x8>,
}

/// Eight times what the table says of a pair of lobes, as ratios to the closed forms above.
pub(super) struct Ratios {
    pub(super) integral: f32x8,
    pub(super) exponent: f32x8,
    /// The scale of the published rule, τ of moments.
    pub(super) third: f32x8,
}

impl LobeTable {
    /// Tabulates a rule.
    pub fn build(rule: ProductRule) -> Self {
        let squared = |node: usize, count: usize| (node as f64 / (count - node) as f64).powi(2);
        let exponent = |node: usize| squared(node, EXPONENTS).min(NEARLY_INFINITE);
        let g = |node: usize| 1.0 / (1.0 + squared(node, WIDTHS));
        let pairs: Vec<(usize, usize)> =
            (0..=EXPONENTS).flat_map(|high| (0..=high).map(move |low| (low, high))).collect();
        let columns: Vec<Vec<f32x8>> = pairs
            .par_iter()
            .map(|&(low, high)| {
                let at = |node: usize| ratios_at(rule, exponent(low), exponent(high), g(node));
                let nodes: Vec<[f64; RATIOS]> = (0..=WIDTHS).map(at).collect();
                nodes.windows(2).map(|pair| row(pair[0], pair[1])).collect()
            })
            .collect();
        Self { rule, rows: columns.concat() }
    }

    /// The rule that is tabulated.
    pub fn rule(&self) -> ProductRule {
        self.rule
    }

    /// Memory in bytes.
    pub fn bytes(&self) -> usize {
        std::mem::size_of_val(self.rows.as_slice())
    }

    /// The ratios, linear between nodes, for exponents of at least 0 and `width = sqrt(1/g - 1)` of at least 0; large
    /// values count as infinite, none may be NaN.
    ///
    /// Worst error for exponents of at least 1: 2e-4 of the integral; 5e-4 of the exponent and 1e-3 of τ by moments,
    /// 3e-3 of the published exponent and scale. Below: 6e-4 of the integral; 2e-3 and 3e-3 by moments, 0.02 published,
    /// and where both exponents are below 0.1 up to 0.1.
    #[inline(always)]
    pub(super) fn ratios(&self, e1: f32x8, e2: f32x8, width: f32x8) -> Ratios {
        let (low, low_part) = interval(e1.fast_min(e2).sqrt(), EXPONENTS);
        let (high, high_part) = interval(e1.fast_max(e2).sqrt(), EXPONENTS);
        let (at, part) = interval(width, WIDTHS);
        let column = ((high * (high + i32x8::ONE)) >> 1) + low;
        let next = column + high + i32x8::ONE;
        // With both exponents in one interval the smaller at its end and the larger at its start is the mirror image.
        let diagonal = low.simd_eq(high);
        let beside = diagonal.select(next, column + i32x8::ONE);
        let widths = i32x8::splat(WIDTHS as i32);
        let corners = [column, beside, next, next + i32x8::ONE].map(|column: i32x8| (column * widths + at).to_array());
        let (low_rest, high_rest) = (f32x8::ONE - low_part, f32x8::ONE - high_part);
        let weights = [low_rest * high_rest, low_part * high_rest, low_rest * high_part, low_part * high_part]
            .map(f32x8::to_array);
        let rows = std::array::from_fn(|lane| {
            let row = |corner: usize| self.rows[corners[corner][lane] as usize];
            let weight = |corner: usize| f32x8::splat(weights[corner][lane]);
            let ends = row(0).mul_add(weight(0), row(3) * weight(3));
            row(1).mul_add(weight(1), row(2).mul_add(weight(2), ends))
        });
        let columns = f32x8::transpose(rows);
        let ratio = |index: usize| columns[RATIOS + index].mul_add(part, columns[index]);
        Ratios { integral: ratio(0), exponent: ratio(1), third: ratio(2) }
    }
}

/// The interval in which the coordinate `t/(1+t)` lies, and where in it.
#[inline(always)]
fn interval(t: f32x8, count: usize) -> (i32x8, f32x8) {
    let coordinate = t / (f32x8::ONE + t) * f32x8::splat(count as f32);
    let start = coordinate.floor().fast_min(f32x8::splat((count - 1) as f32));
    (start.fast_trunc_int(), coordinate - start)
}

fn row(start: [f64; RATIOS], end: [f64; RATIOS]) -> f32x8 {
    f32x8::from(std::array::from_fn::<f32, LANES, _>(|at| {
        let ratio = at % RATIOS;
        let (start, end) = (start[ratio] as f32, end[ratio] as f32);
        if at < RATIOS { start } else { end - start }
    }))
}

/// The ratios of one pair, and a 0 that fills the row.
fn ratios_at(rule: ProductRule, e1: f64, e2: f64, g: f64) -> [f64; RATIOS] {
    let g = g.max(NEARLY_ZERO);
    let at = |e1: f64, e2: f64, g: f64| Pair::new(e1, e2, angle_of_g(e1 + 1.0, e2 + 1.0, g));
    let pair = at(e1, e2, g);
    let integral = pair.relative_integral() / pair.estimate();
    let root = g.sqrt();
    match rule {
        ProductRule::Published | ProductRule::IntegralPreserving => {
            let fit = pair.least_squares();
            [integral, (fit.exponent + 1.0) / pair.n(), fit.scale * (1.0 + root) / (2.0 * root.sqrt()), 0.0]
        }
        ProductRule::Moments => {
            let n = pair.moments().1;
            // Equal exponents, and equal axes, have the middle for every τ: the limit from beside them.
            let apart = e2.max(e1) + 1e-3 * (e1 + e2 + 2.0);
            let (e1, e2) = if (e1 - e2).abs() < 1e-3 * (e1 + e2 + 2.0) { (e1, apart) } else { (e1, e2) };
            let tau = at(e1, e2, g.min(NEARLY_ONE)).shift();
            [integral, n * (1.0 + g) / (2.0 * root * pair.n()), tau, 0.0]
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use rand::{RngExt, SeedableRng};
    use rand_pcg::Pcg64Mcg;

    fn found(table: &LobeTable, e1: f64, e2: f64, width: f64) -> [f64; 3] {
        let [e1, e2, width] = [e1, e2, width].map(|x| f32x8::splat(x as f32));
        let found = table.ratios(e1, e2, width);
        [found.integral, found.exponent, found.third].map(|x| f64::from(x.to_array()[5]))
    }

    /// Largest errors of the ratios over random g, with exponents uniform in the given ranges.
    fn worst(table: &LobeTable, first: (f64, f64), second: (f64, f64)) -> [f64; 3] {
        let mut random = Pcg64Mcg::seed_from_u64(1);
        let mut worst = [0.0f64; 3];
        for _ in 0..200 {
            let (e1, e2) = (random.random_range(first.0..first.1), random.random_range(second.0..second.1));
            let g: f64 = random.random_range(1e-4..1.0);
            let found = found(table, e1, e2, (1.0 / g - 1.0).sqrt());
            for ((worst, found), expected) in worst.iter_mut().zip(found).zip(ratios_at(table.rule, e1, e2, g)) {
                *worst = worst.max((found - expected).abs());
            }
            // τ of the module's documentation.
            assert!(table.rule != ProductRule::Moments || (0.0..1.0).contains(&found[2]), "{e1} {e2} {g}: {found:?}");
        }
        worst
    }

    #[test]
    fn ratios_are_close_to_direct_fits() {
        let ranges = [(0.0, 0.1), (0.1, 1.0), (1.0, 10.0), (10.0, 1e3), (1e3, 1e5)];
        for rule in ProductRule::ALL {
            let table = LobeTable::build(rule);
            assert!(table.bytes() < 500_000 && table.rule() == rule);
            for first in ranges {
                for second in ranges {
                    let found = worst(&table, first, second);
                    let smallest = f64::min(first.0, second.0);
                    let bounds = match (smallest, rule) {
                        (0.0 | 0.1, ProductRule::Moments) => [6e-4, 2e-3, 3e-3],
                        (_, ProductRule::Moments) => [2e-4, 5e-4, 1e-3],
                        (0.0, _) => [6e-4, 0.1, 0.1],
                        (0.1, _) => [6e-4, 2e-2, 2e-2],
                        (1.0, _) => [2e-4, 3e-3, 3e-3],
                        _ => [5e-5, 6e-4, 6e-4],
                    };
                    assert!(found.iter().zip(bounds).all(|(f, b)| *f < b), "{rule:?} {first:?} {second:?}: {found:?}");
                }
            }
        }
    }

    /// Nodes are met, in either order of the exponents, and the ends are finite.
    #[test]
    fn ends_and_nodes() {
        for rule in [ProductRule::Published, ProductRule::Moments] {
            let table = LobeTable::build(rule);
            for (e1, e2) in [(0.0, 0.0), (1.0, 1.0), (0.0, 1.0), (1.0, 1e7), (1e7, 1e7), (1e7, 0.0)] {
                for width in [0.0, 1.0, 1e10, 3e38] {
                    let ratios = found(&table, e1, e2, width);
                    assert_eq!(ratios, found(&table, e2, e1, width));
                    let expected = ratios_at(rule, e1.min(1e6), e2.min(1e6), 1.0 / (1.0 + width * width));
                    for (found, expected) in ratios.iter().zip(expected) {
                        assert!((found - expected).abs() < 2e-3, "{e1} {e2} {width}: {ratios:?} {expected:?}");
                    }
                }
            }
        }
    }
}
