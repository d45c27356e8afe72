//! Visibility as one minus the caps' exposed shares: an alternative to products and exponentials.
//!
//! Where k caps overlap, each is given 1/k of the direction. Averaged over a cap that is its share w_i, and
//! `V ≈ 1 - Σ w_i cap_i` removes the solid angle of the union, whatever the overlaps. Products and exponentials
//! can't: at a few bands small caps are faint smooth bumps, and whether two of them overlap is lost. Not a published
//! form. In `examples/cap_experiment.rs` 16 points per cap come close to the projection of the exact visibility where
//! the exponentials err several times more.
//!
//! Shares are averages over a few points that move with their cap. So that they change continuously, each point stands
//! for its part of the cap: within another cap of v = 1 - cos θ it is counted in full up to `v (1 - 1/(2 points))` from
//! that cap's centre, not at all from `v (1 + 1/(2 points))`, linearly between. A cap smaller than what a point stands
//! for is widened to that, and counted for less in proportion.

use crate::quadrature::GOLDEN_ANGLE;
use wide::f32x8;

/// A cap on the sphere of directions, one per lane.
#[derive(Debug, Clone, Copy)]
pub struct SphericalCap8 {
    /// Unit directions of the centres.
    pub direction: [f32x8; 3],
    /// `1 - cos` of the angular radius, [0, 1]; 0 in a lane without this cap.
    pub versine: f32x8,
}

impl SphericalCap8 {
    /// The same cap in every lane.
    pub fn splat(direction: [f64; 3], radius: f64) -> Self {
        let half_sine = (0.5 * radius).sin();
        Self {
            direction: direction.map(|x| f32x8::splat(x as f32)),
            versine: f32x8::splat((2.0 * half_sine * half_sine) as f32),
        }
    }

    /// Points at equal solid angle on the caps, one for each of a [`ExposedShares::fan`].
    #[inline(always)]
    pub fn points(self, fan: &[[f32; 3]]) -> impl Iterator<Item = [f32x8; 3]> {
        let Self { direction, versine: whole } = self;
        let (first, second) = tangents(direction);
        fan.iter().map(move |&[fraction, cosine, sine]| {
            // 1 - z rather than z, so that small caps keep their points apart.
            let versine = whole * f32x8::splat(fraction);
            let radius = (versine * (f32x8::splat(2.0) - versine)).sqrt();
            let (u, v) = (radius * f32x8::splat(cosine), radius * f32x8::splat(sine));
            std::array::from_fn(|axis| {
                let foot = versine.mul_neg_add(direction[axis], direction[axis]);
                first[axis].mul_add(u, second[axis].mul_add(v, foot))
            })
        })
    }
}

/// Finds exposed shares; keeps its memory from one group of caps to the next.
#[derive(Debug, Clone)]
pub struct ExposedShares {
    /// Share of the versine by point, and the cosine and sine of its turn.
    fan: Vec<[f32; 3]>,
    caps: Vec<PreparedCap>,
    /// Points of one cap, with the number of caps that each is in.
    points: Vec<([f32x8; 3], f32x8)>,
    /// Bit j of row i: caps i and j may overlap in some lane.
    near: Vec<u64>,
    shares: Vec<f32x8>,
}

#[derive(Debug, Clone, Copy)]
struct PreparedCap {
    /// Far away in a lane without this cap.
    direction: [f32x8; 3],
    versine: f32x8,
    inverse_versine: f32x8,
    /// Straight distances from the centre, a little too large, 0 in a lane without this cap: where membership of others'
    /// points ends, and where that of its own points in a cap no larger than what one of them stands for does.
    reach: f32x8,
    part_reach: f32x8,
}

impl ExposedShares {
    /// With `points` (at least 1) per cap and memory for `capacity` caps.
    pub fn new(points: usize, capacity: usize) -> Self {
        Self {
            fan: Self::fan(points).collect(),
            points: Vec::with_capacity(points),
            caps: Vec::with_capacity(capacity),
            near: Vec::with_capacity(capacity * capacity.div_ceil(64)),
            shares: Vec::with_capacity(capacity),
        }
    }

    /// The points of a cap, at least 1: each one's share of the versine, and the cosine and sine of its turn.
    pub fn fan(points: usize) -> impl Iterator<Item = [f32; 3]> {
        let points = points.max(1);
        (0..points).map(move |point| {
            let (sine, cosine) = (GOLDEN_ANGLE * point as f64).sin_cos();
            [((point as f64 + 0.5) / points as f64) as f32, cosine as f32, sine as f32]
        })
    }

    /// The exposed share, in (0, 1], of every cap among all of `caps`: the mean over the cap of 1 over the number of
    /// caps there, by points that spiral outward at equal solid angle.
    ///
    /// Exactly 1 for a cap that no other touches; k equal caps get 1/k each. The error falls about as 1/points. Lanes
    /// are independent. Time grows with the square of the number of caps, but only those that may overlap in some lane
    /// are tested point by point.
    pub fn evaluate(&mut self, caps: impl IntoIterator<Item = SphericalCap8>) -> &[f32x8] {
        let points = self.fan.len() as f32;
        self.caps.clear();
        self.caps.extend(caps.into_iter().map(|cap| PreparedCap::new(cap, points)));
        self.find_near();
        self.shares.clear();
        let words = self.caps.len().div_ceil(64).max(1);
        for (cap, near) in self.caps.iter().zip(self.near.chunks_exact(words)) {
            if near.iter().all(|&word| word == 0) {
                self.shares.push(f32x8::ONE);
                continue;
            }
            self.points.clear();
            self.points.extend(cap.points(&self.fan));
            for (word, &bits) in near.iter().enumerate() {
                let mut bits = bits;
                while bits != 0 {
                    let other = &self.caps[64 * word + bits.trailing_zeros() as usize];
                    bits &= bits - 1;
                    // The cap that a point stands for, or the other cap if that is larger.
                    let inverse = other.inverse_versine.min(f32x8::splat(points) * cap.inverse_versine);
                    let peak = other.versine * inverse;
                    // Twice the versine is the squared distance.
                    let slope = inverse * f32x8::splat(0.5 * points);
                    for (point, count) in &mut self.points {
                        let squared = squared_distance(&other.direction, point);
                        let inside = squared.mul_neg_add(slope, f32x8::splat(points + 0.5));
                        *count = inside.max(f32x8::ZERO).min(f32x8::ONE).mul_add(peak, *count);
                    }
                }
            }
            let sum = self.points.iter().fold(f32x8::ZERO, |sum, (_, count)| sum + f32x8::ONE / *count);
            self.shares.push(sum * f32x8::splat(1.0 / points));
        }
        &self.shares
    }

    fn find_near(&mut self) {
        let words = self.caps.len().div_ceil(64);
        self.near.clear();
        self.near.resize(self.caps.len() * words, 0);
        for (i, cap) in self.caps.iter().enumerate() {
            for (word, others) in self.caps.chunks(64).enumerate().skip(i / 64) {
                let first = (i + 1).saturating_sub(64 * word).min(others.len());
                let mut bits = 0u64;
                // Without a branch, which would often be guessed wrong.
                for (at, other) in others[first..].iter().enumerate() {
                    let squared = squared_distance(&cap.direction, &other.direction);
                    let reach = (cap.reach + other.reach).max(cap.part_reach).max(other.part_reach);
                    bits |= u64::from(squared.simd_lt(reach * reach).any()) << at;
                }
                if bits != 0 {
                    self.near[i * words + word] |= bits << first;
                }
                while bits != 0 {
                    let other = 64 * word + first + bits.trailing_zeros() as usize;
                    self.near[other * words + i / 64] |= 1 << (i % 64);
                    bits &= bits - 1;
                }
            }
        }
    }
}

impl PreparedCap {
    #[inline(always)]
    fn new(SphericalCap8 { direction, versine }: SphericalCap8, points: f32) -> Self {
        let seen = versine.simd_gt(f32x8::ZERO);
        // Rounding must not hide a pair with a membership above 0: then lanes would depend on their neighbours.
        let reach =
            |squared: f32x8| seen.select(squared.sqrt().mul_add(f32x8::splat(1.001), f32x8::splat(1e-6)), f32x8::ZERO);
        let end = versine * f32x8::splat(2.0 + 1.0 / points);
        Self {
            direction: direction.map(|value| seen.select(value, f32x8::splat(8.0))),
            versine,
            inverse_versine: f32x8::ONE / versine.max(f32x8::splat(1e-30)),
            reach: reach(end),
            part_reach: reach(end) + reach(end * f32x8::splat(1.0 / points)),
        }
    }

    /// Points at equal solid angle, with the count of caps that each is in: 1 so far.
    fn points(&self, fan: &[[f32; 3]]) -> impl Iterator<Item = ([f32x8; 3], f32x8)> {
        let cap = SphericalCap8 { direction: self.direction, versine: self.versine };
        cap.points(fan).map(|point| (point, f32x8::ONE))
    }
}

#[inline(always)]
fn squared_distance(a: &[f32x8; 3], b: &[f32x8; 3]) -> f32x8 {
    let [x, y, z] = std::array::from_fn(|axis| a[axis] - b[axis]);
    x.mul_add(x, y.mul_add(y, z * z))
}

/// Two unit vectors at right angles to unit `direction` and each other, continuous but for the direction -Y; within a
/// degree of that they are shorter and askew.
fn tangents([x, y, z]: [f32x8; 3]) -> ([f32x8; 3], [f32x8; 3]) {
    let a = -f32x8::ONE / (f32x8::ONE + y).max(f32x8::splat(1e-4));
    let b = x * z * a;
    ([x.mul_add(x * a, f32x8::ONE), -x, b], [b, -z, z.mul_add(z * a, f32x8::ONE)])
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::basis::dot;
    use crate::quadrature::SphereQuadrature;

    fn shares(caps: &[([f64; 3], f64)], points: usize) -> Vec<f64> {
        let batch: Vec<SphericalCap8> =
            caps.iter().map(|&(direction, radius)| SphericalCap8::splat(direction, radius)).collect();
        ExposedShares::new(points, 0).evaluate(batch).iter().map(|share| f64::from(share.to_array()[2])).collect()
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

    /// Eight lanes of caps, some of them absent, against each lane alone.
    #[test]
    fn neighbours_change_no_bit() {
        let lanes = |lane: usize, i: usize| {
            let (sin, cos) = (0.37 * (i * (lane + 2)) as f64).sin_cos();
            let z = ((i * 7 + lane * 3) % 10) as f64 / 10.0;
            let r = (1.0 - z * z).sqrt();
            let versine = if (i + lane).is_multiple_of(3) { 0.0 } else { 0.01 * (1 + (i * 5 + lane) % 40) as f32 };
            ([r * cos, z, r * sin].map(|x| x as f32), versine)
        };
        let caps = |lane_of: &dyn Fn(usize) -> usize| -> Vec<SphericalCap8> {
            let batch = |i: usize| SphericalCap8 {
                direction: std::array::from_fn(|axis| {
                    f32x8::from(std::array::from_fn::<f32, 8, _>(|at| lanes(lane_of(at), i).0[axis]))
                }),
                versine: f32x8::from(std::array::from_fn::<f32, 8, _>(|at| lanes(lane_of(at), i).1)),
            };
            (0..70).map(batch).collect()
        };
        let together = ExposedShares::new(4, 70).evaluate(caps(&|at| at)).to_vec();
        for lane in 0..8 {
            let alone = ExposedShares::new(4, 70).evaluate(caps(&|_| lane)).to_vec();
            for (i, (together, alone)) in together.iter().zip(alone).enumerate() {
                let (together, alone) = (together.to_array()[lane], alone.to_array()[0]);
                assert!(together > 0.0 && together <= 1.0);
                assert!(lanes(lane, i).1 == 0.0 || together == alone, "{lane} {i}: {together} {alone}");
            }
        }
    }

    /// A cap that moves through others, and one that grows from nothing, change shares in proportion to the step.
    #[test]
    fn shares_are_continuous() {
        let steps = |fine: usize, points: usize, cap: &dyn Fn(f64) -> ([f64; 3], f64)| {
            let at = |i: usize| {
                let fixed = [([0.0, 1.0, 0.0], 0.5), ([0.28, 0.96, 0.0], 0.3)];
                shares(&[fixed[0], fixed[1], cap(i as f64 / fine as f64)], points)
            };
            let path: Vec<_> = (0..=fine).map(at).collect();
            let step = |pair: &[Vec<f64>]| {
                pair[0].iter().zip(&pair[1]).take(2).map(|(a, b)| (a - b).abs()).fold(0.0, f64::max)
            };
            path.windows(2).map(step).fold(0.0, f64::max)
        };
        for points in [1, 4, 16] {
            let moving = |t: f64| ([(2.0 * t - 1.0f64).sin(), (2.0 * t - 1.0f64).cos(), 0.0], 0.02);
            let growing = |t: f64| ([0.1f64.sin(), 0.1f64.cos(), 0.0], 0.6 * t);
            for cap in [&moving as &dyn Fn(f64) -> _, &growing] {
                let (coarse, fine) = (steps(500, points, cap), steps(2000, points, cap));
                // A quarter if continuous and resolved, the same if it jumps.
                assert!(fine < 0.5 * coarse, "{points}: {coarse} {fine}");
            }
        }
    }
}
