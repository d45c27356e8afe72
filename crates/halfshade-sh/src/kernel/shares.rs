//! Visibility as one minus the caps' exposed shares: an alternative to products and exponentials.
//!
//! Where k caps overlap, each is given 1/k of the direction. Averaged over a cap that is its share w_i, and
//! `V ≈ 1 - Σ w_i cap_i` removes exactly the solid angle of the union, whatever the overlaps. Products and exponentials
//! can't: at a few bands small caps are faint smooth bumps, and whether two of them overlap is lost. Not a published
//! form. In `examples/cap_experiment.rs` 16 points per cap come close to the projection of the exact visibility where
//! the exponentials err several times more; cost grows with the square of the number of caps, so that shares are best
//! computed for a group of receivers at once.

use super::LANES;
use wide::f32x8;

/// A cap on the sphere of directions, one per lane.
#[derive(Debug, Clone, Copy)]
pub struct CapBatch {
    /// Unit directions of the centres.
    pub direction: [f32x8; 3],
    /// Cosine of the angular radius, [0, 1]; a lane without this cap has a value above 1.
    pub cos_radius: f32x8,
}

/// Golden angle: turns from one point of the fan to the next.
const GOLDEN_ANGLE: f64 = 2.399_963_229_728_653;

/// Writes to `shares` the exposed share, in (0, 1], of every cap among all of `caps`: the mean over the cap of 1 over the
/// number of caps there, by `points` points that spiral outward at equal solid angle.
///
/// Exactly 1 for a cap that no other touches. The error falls about as 1/points. Lanes are independent. `shares` beyond
/// the number of caps are left alone.
pub fn exposed_shares(caps: &[CapBatch], points: usize, shares: &mut [f32x8]) {
    let points = points.max(1);
    for (at, (cap, share)) in caps.iter().zip(shares).enumerate() {
        let (first, second) = tangents(cap.direction);
        let mut sum = f32x8::ZERO;
        for point in 0..points {
            let fraction = f32x8::splat((point as f32 + 0.5) / points as f32);
            // 1 - z rather than z, so that small caps keep their points apart.
            let versine = fraction * (f32x8::ONE - cap.cos_radius).max(f32x8::ZERO);
            let z = f32x8::ONE - versine;
            let radius = (versine * (f32x8::splat(2.0) - versine)).sqrt();
            let (sine, cosine) = (GOLDEN_ANGLE * point as f64).sin_cos();
            let (u, v) = (radius * f32x8::splat(cosine as f32), radius * f32x8::splat(sine as f32));
            let sample: [f32x8; 3] =
                std::array::from_fn(|axis| cap.direction[axis] * z + first[axis] * u + second[axis] * v);
            let mut count = f32x8::ONE;
            for (other, blocker) in caps.iter().enumerate() {
                if other != at {
                    let [x, y, z] = blocker.direction;
                    let cosine = x.mul_add(sample[0], y.mul_add(sample[1], z * sample[2]));
                    count += cosine.simd_ge(blocker.cos_radius).select(f32x8::ONE, f32x8::ZERO);
                }
            }
            sum += f32x8::ONE / count;
        }
        *share = sum * f32x8::splat(1.0 / points as f32);
    }
}

/// Two unit vectors at right angles to unit `direction` and each other, without a branch.
fn tangents([x, y, z]: [f32x8; 3]) -> ([f32x8; 3], [f32x8; 3]) {
    let sign = z.simd_lt(f32x8::ZERO).select(-f32x8::ONE, f32x8::ONE);
    let a = -f32x8::ONE / (sign + z);
    let b = x * y * a;
    ([f32x8::ONE + sign * x * x * a, sign * b, -sign * x], [b, sign + y * y * a, -y])
}

impl CapBatch {
    /// The same cap in every lane.
    pub fn splat(direction: [f64; 3], radius: f64) -> Self {
        Self {
            direction: direction.map(|x| f32x8::from([x as f32; LANES])),
            cos_radius: f32x8::splat(radius.cos() as f32),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::basis::dot;
    use crate::quadrature::SphereQuadrature;

    fn shares(caps: &[([f64; 3], f64)], points: usize) -> Vec<f64> {
        let batch: Vec<CapBatch> = caps.iter().map(|&(direction, radius)| CapBatch::splat(direction, radius)).collect();
        let mut shares = vec![f32x8::ZERO; caps.len()];
        exposed_shares(&batch, points, &mut shares);
        shares.iter().map(|share| f64::from(share.to_array()[2])).collect()
    }

    #[test]
    fn caps_apart_keep_all_and_equal_caps_divide_evenly() {
        assert_eq!(shares(&[([0.0, 0.0, 1.0], 0.3), ([0.0, 0.6, -0.8], 0.5), ([1.0, 0.0, 0.0], 0.2)], 8), [1.0; 3]);
        for share in shares(&[([0.0, 0.6, 0.8], 0.3); 5], 8) {
            assert!((share - 0.2).abs() < 1e-6);
        }
        assert!(shares(&[], 4).is_empty());
    }

    #[test]
    fn shares_agree_with_quadrature_and_add_up_to_the_union() {
        let caps = [([0.0, 0.6, 0.8], 0.5), ([0.36, 0.48, 0.8], 0.3), ([-0.6, 0.0, 0.8], 0.7), ([0.0, 0.0, -1.0], 0.4)];
        let (mut exposed, mut total, mut union) = ([0.0; 4], [0.0; 4], 0.0);
        for (s, weight) in SphereQuadrature::exact_to(500).points() {
            let inside = |i: &usize| dot(&caps[*i].0, &s) > f64::cos(caps[*i].1);
            let hits: Vec<usize> = (0..caps.len()).filter(inside).collect();
            union += if hits.is_empty() { 0.0 } else { weight };
            for &i in &hits {
                exposed[i] += weight / hits.len() as f64;
                total[i] += weight;
            }
        }
        let found = shares(&caps, 256);
        let mut sum = 0.0;
        for i in 0..caps.len() {
            assert!((found[i] - exposed[i] / total[i]).abs() < 0.01, "{i}: {} {}", found[i], exposed[i] / total[i]);
            sum += found[i] * std::f64::consts::TAU * (1.0 - caps[i].1.cos());
        }
        assert!((sum / union - 1.0).abs() < 0.01, "{sum} {union}");
    }
}
