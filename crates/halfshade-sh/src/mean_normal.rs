//! The mean normal of what a receiver sees of a sphere, weighted by the receiver's cosine.
//!
//! A receiver with normal n sees a sphere of angular radius θ, `s = sin θ`, along the unit direction d. Of what lies above
//! its horizon, the surface's normal p(ω) has the mean
//!
//! ```text
//! p̄ = ∫ p(ω) max(n·ω, 0) dω / ∫ max(n·ω, 0) dω = A d + B e        e unit, in the plane of d and n, at a right angle to d
//! ```
//!
//! The light that a sphere lit from one side sends to the receiver is that of a function of the normal; for a linear one
//! the mean over the cap is its value at p̄, exactly. An average that knows no receiver ([`crate::form_factor`]) takes p̄ for a multiple
//! of -d: on the ground under a sky it looks too far down at balls, and finds 7 to 18 % too little; and of a sphere that
//! the ground cuts, it takes a part that isn't there.

use crate::kernel::LANES;
use std::f64::consts::{FRAC_PI_2, PI};
use wide::f32x8;

/// Cells along each axis of the table: by s, and by `(n·d + s)/(1 + s)`.
pub const CELLS: usize = 32;

const SIDE: usize = CELLS + 1;

/// A and B. `cosine` is n·d; where nothing lies above the horizon, those of the point nearest to it.
///
/// Midpoint rules over the cap; error below 1e-3.
pub fn mean_normal(sine: f64, cosine: f64) -> [f64; 2] {
    let s = sine.clamp(0.0, 1.0);
    let c = cosine.clamp(-1.0, 1.0);
    let across = (1.0 - c * c).sqrt();
    let (rings, spokes) = (64, 96);
    let (mut sums, mut total) = ([0.0; 2], 0.0);
    for ring in 0..rings {
        // A direction at angle β from d, sin β = s sin t, meets the surface where its normal is at t + β from -d.
        let t = FRAC_PI_2 * (f64::from(ring) + 0.5) / f64::from(rings);
        let (sin_t, cos_t) = t.sin_cos();
        let (sin_b, cos_b) = (s * sin_t, (1.0 - s * s * sin_t * sin_t).sqrt());
        let along = -(s * sin_t * sin_t + cos_t * cos_b);
        let aside = sin_t * (cos_b - s * cos_t);
        let measure = sin_t * cos_t / cos_b;
        for spoke in 0..spokes {
            let turn = (PI * (f64::from(spoke) + 0.5) / f64::from(spokes)).cos();
            let weight = measure * (c * cos_b + across * sin_b * turn).max(0.0);
            sums[0] += weight * along;
            sums[1] += weight * aside * turn;
            total += weight;
        }
    }
    if total > 1e-12 { sums.map(|sum| sum / total) } else { [-s, (1.0 - s * s).sqrt()] }
}

/// [`mean_normal`], eight lookups at a time.
#[derive(Debug, Clone)]
pub struct MeanNormalTable {
    /// By s, then by height.
    values: Box<[[f32; 2]]>,
}

impl MeanNormalTable {
    /// 8.5 KiB.
    pub fn build() -> Self {
        let at = |i: usize| {
            let (s, u) = ((i / SIDE) as f64 / CELLS as f64, (i % SIDE) as f64 / CELLS as f64);
            mean_normal(s, u * (1.0 + s) - s).map(|value| value as f32)
        };
        Self { values: (0..SIDE * SIDE).map(at).collect() }
    }

    /// A and B in rows by s, for kernels elsewhere.
    pub fn values(&self) -> &[[f32; 2]] {
        &self.values
    }

    /// Memory in bytes.
    pub fn bytes(&self) -> usize {
        size_of_val(&*self.values)
    }

    /// A and B of eight spheres; s and n·d are clamped to their ranges.
    #[inline(always)]
    pub fn lookup(&self, sine: f32x8, cosine: f32x8) -> [f32x8; 2] {
        let cells = f32x8::splat(CELLS as f32);
        let sine = sine.fast_max(f32x8::ZERO).fast_min(f32x8::ONE);
        let height = ((cosine + sine) / (f32x8::ONE + sine)).fast_max(f32x8::ZERO).fast_min(f32x8::ONE);
        let (x, y) = (sine * cells, height * cells);
        let last = f32x8::splat((CELLS - 1) as f32);
        let (column, row) = (x.floor().fast_min(last), y.floor().fast_min(last));
        let (p, q) = (x - column, y - row);
        let first = column.mul_add(f32x8::splat(SIDE as f32), row).fast_trunc_int().to_array();
        let corner = |offset: usize| -> [f32x8; 2] {
            let values: [[f32; 2]; LANES] = std::array::from_fn(|lane| self.values[first[lane] as usize + offset]);
            [0, 1].map(|part| f32x8::from(values.map(|value| value[part])))
        };
        let mixed = |[a, b]: [[f32x8; 2]; 2], t: f32x8| [0, 1].map(|part| (b[part] - a[part]).mul_add(t, a[part]));
        mixed([mixed([corner(0), corner(1)], q), mixed([corner(SIDE), corner(SIDE + 1)], q)], p)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::form_factor::{Weighting, form_factor};

    /// Points all over a sphere, those that are seen, by their solid angle and cosine.
    fn by_surface(s: f64, c: f64) -> [f64; 2] {
        let across = (1.0 - c * c).sqrt();
        let (rings, spokes) = (1200, 400);
        let (mut sums, mut total) = ([0.0; 2], 0.0);
        for ring in 0..rings {
            // The receiver is at the origin, the centre at 1 along d, the radius s.
            let z: f64 = -1.0 + 2.0 * (f64::from(ring) + 0.5) / f64::from(rings);
            for spoke in 0..spokes {
                let turn = (PI * (f64::from(spoke) + 0.5) / f64::from(spokes)).cos();
                let aside = (1.0 - z * z).sqrt() * turn;
                let place = [1.0 + s * z, s * aside];
                let squared = 1.0 + s * s + 2.0 * s * z;
                let facing = -(s + z) / squared.sqrt();
                let cosine = (c * place[0] + across * place[1]) / squared.sqrt();
                let weight = facing.max(0.0) / squared * cosine.max(0.0);
                sums[0] += weight * z;
                sums[1] += weight * aside;
                total += weight;
            }
        }
        sums.map(|sum| sum / total)
    }

    #[test]
    fn directions_and_points_of_the_surface_agree() {
        let table = MeanNormalTable::build();
        for s in [0.1, 0.4, 0.7, 0.95] {
            for c in [1.0, 0.8, 0.5, 0.2, 0.0, -0.05 * s, -0.5 * s] {
                let expected = by_surface(s, c);
                let found = mean_normal(s, c);
                let looked_up = table.lookup(f32x8::splat(s as f32), f32x8::splat(c as f32));
                for k in 0..2 {
                    assert!((found[k] - expected[k]).abs() < 6e-3, "{s} {c}: {found:?} {expected:?}");
                    let looked_up = f64::from(looked_up[k].to_array()[5]);
                    assert!((looked_up - expected[k]).abs() < 0.02, "{s} {c}: {looked_up:?} {expected:?}");
                }
            }
        }
    }

    /// A sphere straight above, small: the form factor of one band, nearly.
    #[test]
    fn straight_above_it_is_the_form_factor() {
        let [along, aside] = mean_normal(0.01, 1.0);
        assert!((along + form_factor(2, 0.01, Weighting::SolidAngle)[1]).abs() < 1e-3 && aside.abs() < 1e-3);
    }
}
