//! Projection of latitude-longitude images of constant texels.

use crate::basis;
use crate::quadrature::gauss_legendre;
use crate::recurrence::{legendre_step, sectoral_constant};
use crate::rotation::ShRotation;
use rayon::prelude::*;
use std::f64::consts::{PI, TAU};

/// SH vectors, one per channel, of an RGB image that is constant over each texel.
///
/// Row 0 is the zenith (+Y); the centre column looks along -Z and columns run toward +X, rows and columns at equal
/// steps of polar angle and azimuth. The integral of each basis function over each texel [Guerrero2007, eq. 3.5] is
/// exact along azimuth (`∫ cos mφ` in closed form) and Gauss-Legendre along the polar angle, which is to a few ulp:
/// what is projected is the same function that a renderer samples, sharp suns included.
///
/// Sums are taken row by row in a fixed order, so the result does not depend on the number of threads. `None` if
/// `texels` does not have `width·height` entries or either is 0.
pub fn project(bands: usize, width: usize, height: usize, texels: &[[f32; 3]]) -> Option<[Vec<f64>; 3]> {
    if width == 0 || height == 0 || width.checked_mul(height) != Some(texels.len()) {
        return None;
    }
    let azimuths = azimuth_integrals(bands, width);
    let row_vectors: Vec<[Vec<f64>; 3]> = texels
        .par_chunks_exact(width)
        .enumerate()
        .map(|(row, texels)| project_row(bands, row, height, texels, &azimuths))
        .collect();
    let mut sums: [Vec<f64>; 3] = std::array::from_fn(|_| vec![0.0; basis::coefficient_count(bands)]);
    for row in &row_vectors {
        for (sum, channel) in sums.iter_mut().zip(row) {
            sum.iter_mut().zip(channel).for_each(|(s, c)| *s += c);
        }
    }
    // The image's own frame has its pole along +Y, azimuth 0 along -Z and, to be right-handed, azimuth a quarter turn
    // along -X: columns of the rotation to the world.
    let world_from_image = [[0.0, -1.0, 0.0], [0.0, 0.0, 1.0], [-1.0, 0.0, 0.0]];
    let rotation = ShRotation::new(bands, &world_from_image);
    Some(sums.map(|sum| rotation.apply(&sum)))
}

/// Per column, the integrals over it of `cos mφ` for m = 0.. and `sin mφ` for m = 1.., where φ runs against the columns
/// and is 0 at the centre: `2·bands - 1` values a column.
fn azimuth_integrals(bands: usize, width: usize) -> Vec<Vec<f64>> {
    let edge = |column: usize| TAU * (column as f64 / width as f64 - 0.5);
    (0..width)
        .map(|column| {
            let (from, to) = (edge(column), edge(column + 1));
            // Sums to products: the difference of two near-equal sines would lose digits on wide images.
            let (half, middle) = (0.5 * (to - from), 0.5 * (to + from));
            let integral = |m: usize, wave: f64| 2.0 * (m as f64 * half).sin() / m as f64 * wave;
            let cosines = (0..bands).map(|m| match m {
                0 => to - from,
                _ => integral(m, (m as f64 * middle).cos()),
            });
            let sines = (1..bands).map(|m| integral(m, -(m as f64 * middle).sin()));
            cosines.chain(sines).collect()
        })
        .collect()
}

/// One row's part of the coefficients, in the image's frame.
fn project_row(bands: usize, row: usize, height: usize, texels: &[[f32; 3]], azimuths: &[Vec<f64>]) -> [Vec<f64>; 3] {
    let mut waves: [Vec<f64>; 3] = std::array::from_fn(|_| vec![0.0; (2 * bands).saturating_sub(1)]);
    for (texel, azimuth) in texels.iter().zip(azimuths) {
        for (wave, &radiance) in waves.iter_mut().zip(texel) {
            let radiance = f64::from(radiance);
            wave.iter_mut().zip(azimuth).for_each(|(w, a)| *w += radiance * a);
        }
    }
    let polar = polar_integrals(bands, row, height);
    waves.map(|wave| {
        (0..basis::coefficient_count(bands))
            .map(|i| {
                let (l, m) = basis::degree_and_order(i);
                let order = m.unsigned_abs();
                let wave = if m < 0 { wave[bands - 1 + order] } else { wave[order] };
                wave * polar[basis::index(l, order as isize)]
            })
            .collect()
    })
}

/// `∫ N_l^m P_l^m(cos θ) sin θ dθ` over a row, at the index of (l, m), m >= 0; with the `sqrt(2)` of the real basis.
fn polar_integrals(bands: usize, row: usize, height: usize) -> Vec<f64> {
    let edge = |row: usize| PI * row as f64 / height as f64;
    let mut integrals = vec![0.0; basis::coefficient_count(bands)];
    // The integrand is a trigonometric polynomial of degree `bands`; few points do on a thin row.
    let points = 6 + (2 * bands).div_ceil(height);
    for (angle, weight) in gauss_legendre(points, edge(row), edge(row + 1)) {
        let (sine, cosine) = angle.sin_cos();
        let mut power = weight * sine;
        for m in 0..bands {
            let (mut below, mut current) = (0.0, sectoral_constant(m));
            for l in m..bands {
                if l > m {
                    let (alpha, beta) = legendre_step(l, m);
                    (below, current) = (current, alpha * cosine * current - beta * below);
                }
                integrals[basis::index(l, m as isize)] += power * current;
            }
            power *= sine;
        }
    }
    integrals
}

#[cfg(test)]
mod tests {
    use super::*;

    fn image(width: usize, height: usize) -> Vec<[f32; 3]> {
        (0..width * height).map(|i| std::array::from_fn(|c| ((i * 37 + c * 11) as f32 * 0.7).sin() + 1.0)).collect()
    }

    /// Gauss points inside every texel and the basis along world directions: shares nothing with the fast path.
    fn brute_force(bands: usize, width: usize, height: usize, texels: &[[f32; 3]], channel: usize) -> Vec<f64> {
        let mut sum = vec![0.0; bands * bands];
        for row in 0..height {
            for column in 0..width {
                let (v, u) = (row as f64 / height as f64, column as f64 / width as f64);
                let radiance = f64::from(texels[row * width + column][channel]);
                for (polar, a) in gauss_legendre(24, PI * v, PI * (v + 1.0 / height as f64)) {
                    for (azimuth, b) in gauss_legendre(24, TAU * (u - 0.5), TAU * (u + 1.0 / width as f64 - 0.5)) {
                        let direction = [polar.sin() * azimuth.sin(), polar.cos(), -polar.sin() * azimuth.cos()];
                        let weight = radiance * a * b * polar.sin();
                        let values = basis::evaluate(bands, direction);
                        sum.iter_mut().zip(values).for_each(|(s, y)| *s += weight * y);
                    }
                }
            }
        }
        sum
    }

    #[test]
    fn agrees_with_quadrature_inside_every_texel() {
        for (bands, width, height) in [(6, 7, 5), (4, 4, 1), (3, 1, 3), (16, 6, 4)] {
            let texels = image(width, height);
            let projected = project(bands, width, height, &texels).unwrap();
            for (channel, vector) in projected.iter().enumerate() {
                for (value, expected) in vector.iter().zip(brute_force(bands, width, height, &texels, channel)) {
                    assert!((value - expected).abs() < 1e-11, "{bands} {width} {height}: {value} {expected}");
                }
            }
        }
    }

    #[test]
    fn a_constant_image_is_the_constant_function_up_to_16_bands() {
        let projected = project(16, 64, 32, &[[1.0, 2.0, 0.0]; 64 * 32]).unwrap();
        for (vector, radiance) in projected.iter().zip([1.0, 2.0, 0.0]) {
            for (value, one) in vector.iter().zip(basis::one(16)) {
                assert!((value - radiance * one).abs() < 1e-12);
            }
        }
    }

    #[test]
    fn texels_lie_where_the_convention_says() {
        let (width, height) = (64, 32);
        for (column, row, direction) in [(32, 16, [0.0, 0.0, -1.0]), (48, 16, [1.0, 0.0, 0.0]), (5, 0, [0.0, 1.0, 0.0])]
        {
            let mut texels = vec![[0.0; 3]; width * height];
            texels[row * width + column] = [1.0; 3];
            let [red, ..] = project(2, width, height, &texels).unwrap();
            let expected = basis::evaluate(2, direction);
            for (value, expected) in red.iter().zip(expected) {
                assert!((value / red[0] - expected * (4.0 * PI).sqrt()).abs() < 0.15, "{red:?}");
            }
        }
        assert!(project(2, 4, 4, &[[0.0; 3]; 15]).is_none());
        assert!(project(2, 0, 0, &[]).is_none());
    }
}
