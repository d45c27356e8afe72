//! Functions that matter on the hemisphere about +z alone: SH vectors that fit them there.
//!
//! Below the horizon such a vector may be anything, which leaves it n²/2 numbers, about, to be better with above. With h the weight
//! of a direction and p the function, the vector b that errs least, and its products with functions f of n bands, are
//!
//! ```text
//! b = (G + λ)^-1 ∫ h p y dω      G = ∫ h y y^T dω      b·∫ h f y dω = ∫ h p f dω + O(λ)
//! ```
//!
//! over z > 0. Without the fit p itself would be cut off at n bands, and its product with f with it. Weights are symmetric
//! about +z, so that matrices have a block for each order |m| and nothing else.

use crate::{basis, quadrature::gauss_legendre};
use nalgebra::DMatrix;
use std::f64::consts::TAU;

/// Weight λ of the fit's length beside its squared error. Functions of n bands exist that are next to nothing above the horizon; the
/// fit, without it, would have thousands of them.
const RIDGE: f64 = 1e-4;

/// The weight h of directions above the horizon.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Weight {
    /// `z`, the cosine of the angle to the normal.
    Cosine,
    /// 1.
    Equal,
}

impl Weight {
    /// The weight of a direction with `z` > 0.
    pub fn of(self, z: f64) -> f64 {
        match self {
            Self::Cosine => z,
            Self::Equal => 1.0,
        }
    }

    /// `∫ h y_i y_j dω` over z > 0 for order |m|: i of `bands` bands by j of `others`, degrees |m| and up. Exact to rounding.
    pub fn products(self, order: usize, bands: usize, others: usize) -> DMatrix<f64> {
        let most = bands.max(others);
        let degrees = |count: usize| count.saturating_sub(order);
        let mut sums = DMatrix::zeros(degrees(bands), degrees(others));
        // At the azimuth where the cosine of m times it is 1; its square's mean over azimuths is a half but for m = 0.
        let turn = if order == 0 { TAU } else { 0.5 * TAU };
        for (z, share) in gauss_legendre(most + 1, 0.0, 1.0) {
            let y = basis::evaluate(most, [(1.0 - z * z).sqrt(), 0.0, z]);
            let at = |i: usize| y[basis::index(order + i, order as isize)];
            let share = turn * share * self.of(z);
            for i in 0..sums.nrows() {
                for j in 0..sums.ncols() {
                    sums[(i, j)] += share * at(i) * at(j);
                }
            }
        }
        sums
    }

    /// `∫ h y_i dω` over z > 0.
    pub fn integrals(self, bands: usize) -> Vec<f64> {
        let zonal = self.products(0, 1, bands);
        let constant = basis::evaluate(1, [0.0, 0.0, 1.0])[0];
        let zonal: Vec<f64> = zonal.row(0).iter().map(|value| value / constant).collect();
        crate::zonal::to_spherical(&zonal)
    }

    /// `∫ h y_i y_j dω` over z > 0, row by row.
    pub fn gram(self, bands: usize) -> Vec<f64> {
        let count = basis::coefficient_count(bands);
        let mut gram = vec![0.0; count * count];
        for order in 0..bands {
            let block = self.products(order, bands, bands);
            for (i, j) in (order..bands).flat_map(|i| (order..bands).map(move |j| (i, j))) {
                for m in [order as isize, -(order as isize)] {
                    gram[basis::index(i, m) * count + basis::index(j, m)] = block[(i - order, j - order)];
                }
            }
        }
        gram
    }

    /// The fit of functions of `others` bands as a matrix over their SH vectors: degree by degree l, order by order from 0 to l, the
    /// factors of degrees from that order up to `others`. The same for either sign of an order.
    pub fn fit(self, bands: usize, others: usize) -> Vec<f64> {
        let blocks: Vec<DMatrix<f64>> = (0..bands)
            .map(|order| {
                let mut gram = self.products(order, bands, bands);
                (0..gram.nrows()).for_each(|i| gram[(i, i)] += RIDGE);
                let right = self.products(order, bands, others);
                // With the ridge it is positive definite.
                gram.cholesky().map_or_else(|| DMatrix::zeros(right.nrows(), right.ncols()), |gram| gram.solve(&right))
            })
            .collect();
        let row = |l: usize, order: usize| blocks[order].row(l - order).iter().copied().collect::<Vec<_>>();
        (0..bands).flat_map(|l| (0..=l).map(move |order| (l, order))).flat_map(|(l, order)| row(l, order)).collect()
    }
}

/// A fit applied to the SH vector of a function of `others` bands, as [`Weight::fit`] gives it.
pub fn fitted(fit: &[f64], bands: usize, others: usize, function: &[f64]) -> Vec<f64> {
    let mut vector = vec![0.0; basis::coefficient_count(bands)];
    let mut place = 0;
    for l in 0..bands {
        for order in 0..=l {
            let row = &fit[place..place + others.saturating_sub(order)];
            place += row.len();
            for m in [order as isize, -(order as isize)] {
                let values = (order..others).map(|degree| function[basis::index(degree, m)]);
                vector[basis::index(l, m)] = row.iter().zip(values).map(|(factor, value)| factor * value).sum();
            }
        }
    }
    vector
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::quadrature::SphereQuadrature;

    const WEIGHTS: [Weight; 2] = [Weight::Cosine, Weight::Equal];

    /// Both sides of the horizon by a rule of their own: `exact` for polynomials of degree 30 on each.
    fn above(f: impl Fn([f64; 3]) -> f64) -> f64 {
        let azimuths = 64;
        gauss_legendre(32, 0.0, 1.0).into_iter().fold(0.0, |sum, (z, weight)| {
            (0..azimuths).fold(sum, |sum, k| {
                let (sin, cos) = (TAU * (f64::from(k) + 0.3) / f64::from(azimuths)).sin_cos();
                let across = (1.0 - z * z).sqrt();
                sum + weight * TAU / f64::from(azimuths) * f([across * cos, across * sin, z])
            })
        })
    }

    #[test]
    fn gram_and_integrals_are_those_of_quadrature() {
        for weight in WEIGHTS {
            let (gram, integrals) = (weight.gram(5), weight.integrals(5));
            for (i, integral) in integrals.iter().enumerate() {
                let y = |direction: [f64; 3], i: usize| basis::evaluate(5, direction)[i];
                let exact = above(|direction| weight.of(direction[2]) * y(direction, i));
                assert!((integral - exact).abs() < 1e-12, "{weight:?} {i}");
                for j in 0..=i {
                    let exact = above(|direction| weight.of(direction[2]) * y(direction, i) * y(direction, j));
                    assert!([(i, j), (j, i)].iter().all(|&(i, j)| (gram[i * 25 + j] - exact).abs() < 1e-12));
                }
            }
        }
        // Over both hemispheres the basis is orthonormal: odd products cancel out, even ones are halves.
        assert!((Weight::Equal.gram(3)[0] - 0.5).abs() < 1e-13 && Weight::Equal.gram(3)[1].abs() < 1e-13);
    }

    /// Products with functions of as many bands are those of the function that was fitted, however sharp it is.
    #[test]
    fn products_with_functions_of_few_bands_are_kept() {
        let axis = [0.48, -0.36, 0.8];
        for weight in WEIGHTS {
            for (bands, exponent) in [(2, 3), (4, 3), (4, 20), (7, 40)] {
                let power = |d: [f64; 3]| d.iter().zip(axis).map(|(d, a)| d * a).sum::<f64>().max(0.0).powi(exponent);
                let others = 48;
                let function = SphereQuadrature::exact_to(2 * others).project(others, power);
                let vector = fitted(&weight.fit(bands, others), bands, others, &function);
                let gram = weight.gram(bands);
                let light: Vec<f64> = (0..bands * bands).map(|i| ((3 * i * i + 1) as f64).cos()).collect();
                let count = light.len();
                let rows = gram.chunks(count).map(|row| basis::dot(row, &light));
                let found: f64 = rows.zip(&vector).map(|(row, b)| row * b).sum();
                let exact = above(|d| weight.of(d[2]) * power(d) * basis::reconstruct(&light, d));
                let room = above(|d| weight.of(d[2]) * power(d)) * basis::magnitude(&light);
                assert!((found - exact).abs() < 4e-3 * room, "{weight:?} {bands} {exponent}: {found} {exact}");
            }
        }
    }
}
