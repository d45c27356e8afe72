//! Tables of blocker and log-blocker zonal vectors by angular radius, for the f32 kernels.
//!
//! The variable is `u = 1 - cos θ` in (0, 1], proportional to the solid angle. Stored is the vector divided by
//! `sin²θ = u(2 - u)`, which is smooth and has a finite limit at u = 0: so a tiny blocker's lookup is right to first
//! order however coarse the table, and goes to exactly 0 with the blocker. The receiver's side gives `sin²θ = r²/d²`,
//! from which `u = 1 - sqrt(1 - sin²θ)`, without any inverse trigonometric function; what cancels there only moves the
//! place in the table, where next to nothing changes.

use crate::kernel::{LANES, MAX_BANDS};
use crate::{zonal, zonal_algebra};
use wide::f32x8;

/// Intervals of a table: 4 bands then take 64 KiB.
///
/// The worst relative error of a lookup is where the logarithm's eigenvalues reach the clip: 4e-5 at 4 bands, 5e-4 at
/// 8. For blockers below 0.3 rad it is 2e-6.
pub const INTERVALS: usize = 2048;

/// u that stands for the limit at 0: small enough for the limit, large enough for `1 - u` to be exact.
const NEARLY_ZERO: f64 = 1.0 / (1u64 << 26) as f64;

/// Quantity that a table holds.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Quantity {
    /// The logarithm of the blocker, eigenvalues clipped here [Guerrero2007, eq. 3.34 and 4.2 Precomputation].
    Logarithm {
        /// See [`crate::logarithm::logarithm`].
        clip: f64,
    },
    /// The blocker minus the constant 1: minus the cap.
    BlockerMinusOne,
}

impl Quantity {
    /// The zonal vector at angular radius θ, `u = 1 - cos θ`.
    pub fn zonal(self, bands: usize, u: f64) -> Vec<f64> {
        match self {
            Self::Logarithm { clip } => zonal_algebra::logarithm_of_blocker(&zonal::cap_from_versine(bands, u), clip),
            Self::BlockerMinusOne => zonal::cap_from_versine(bands, u).iter().map(|g| -g).collect(),
        }
    }
}

/// A table of zonal vectors for angular radii up to π/2, ready for eight lookups at a time.
///
/// Entries carry the factor `sqrt(4π/(2l+1))` of the rotation to an axis, so that a lookup's result is the `scale` that
/// [`crate::kernel::accumulate_lobe`] takes.
#[derive(Debug, Clone)]
pub struct BlockerTable {
    bands: usize,
    /// Per four bands a table; per interval four values and their four differences to the next interval: one aligned
    /// load per lane, and a transpose turns eight of them into lanes. Arrays, so that a masked index needs no check.
    parts: Vec<Box<[f32x8; INTERVALS]>>,
}

/// Bands in one row.
const ROW_BANDS: usize = LANES / 2;

impl BlockerTable {
    /// Tabulates `quantity` for 1 to 8 bands; `None` for any other number.
    pub fn build(bands: usize, quantity: Quantity) -> Option<Self> {
        if !(1..=MAX_BANDS).contains(&bands) {
            return None;
        }
        let ratio = |interval: usize| -> [f64; MAX_BANDS] {
            let u = (interval as f64 / INTERVALS as f64).max(NEARLY_ZERO);
            let vector = quantity.zonal(bands, u);
            std::array::from_fn(|l| vector.get(l).map_or(0.0, |g| g * zonal::rotation_scale(l) / (u * (2.0 - u))))
        };
        let ratios: Vec<[f64; MAX_BANDS]> = (0..=INTERVALS).map(ratio).collect();
        let parts = (0..bands.div_ceil(ROW_BANDS))
            .map(|part| {
                let mut rows = Box::new([f32x8::ZERO; INTERVALS]);
                for (row, pair) in rows.iter_mut().zip(ratios.windows(2)) {
                    *row = f32x8::from(std::array::from_fn::<f32, LANES, _>(|column| {
                        let l = part * ROW_BANDS + column % ROW_BANDS;
                        if column < ROW_BANDS { pair[0][l] as f32 } else { (pair[1][l] - pair[0][l]) as f32 }
                    }));
                }
                rows
            })
            .collect();
        Some(Self { bands, parts })
    }

    /// Bands per entry.
    pub fn bands(&self) -> usize {
        self.bands
    }

    /// All rows, for kernels elsewhere: per four bands a table, per interval four values and their four differences to the
    /// next interval.
    pub fn rows(&self) -> impl Iterator<Item = [f32; LANES]> {
        self.parts.iter().flat_map(|part| part.iter().map(|row| row.to_array()))
    }

    /// Memory in bytes.
    pub fn bytes(&self) -> usize {
        self.parts.len() * std::mem::size_of::<[f32x8; INTERVALS]>()
    }

    /// Zonal vectors, times `sqrt(4π/(2l+1))`, for eight blockers of the given squared sines of angular radius, for
    /// `N = bands²` coefficients; what is past these bands is 0.
    ///
    /// Sines are clamped to [0, 1] (NaN counts as 0). 0 gives exactly 0.
    ///
    /// # Panics
    /// If the table has fewer bands.
    #[inline(always)]
    pub fn lookup<const N: usize>(&self, sin_squared: f32x8) -> [f32x8; MAX_BANDS] {
        // First the maximum that knows NaN; after it there is none.
        let sin_squared = sin_squared.max(f32x8::ZERO).fast_min(f32x8::ONE);
        let count = f32x8::splat(INTERVALS as f32);
        let at = (f32x8::ONE - sin_squared).sqrt().mul_neg_add(count, count);
        let interval = at.floor().fast_min(f32x8::splat((INTERVALS - 1) as f32));
        let t = at - interval;
        let intervals = interval.fast_trunc_int().to_array();
        let mut values = [f32x8::ZERO; MAX_BANDS];
        // Constant bounds, so that everything stays in registers.
        let bands = const { N.isqrt() };
        for part in 0..bands.div_ceil(ROW_BANDS) {
            let table = &self.parts[part];
            let columns = f32x8::transpose(intervals.map(|interval| table[interval as usize % INTERVALS]));
            for l in 0..ROW_BANDS.min(bands - part * ROW_BANDS) {
                values[part * ROW_BANDS + l] = columns[ROW_BANDS + l].mul_add(t, columns[l]) * sin_squared;
            }
        }
        values
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::basis;
    use crate::dispatch_bands;
    use crate::logarithm::DEFAULT_CLIP;

    /// Error of the lookup relative to the vector's magnitude, at `sines`.
    fn errors(bands: usize, quantity: Quantity, sines: &[f64]) -> Vec<f64> {
        let table = BlockerTable::build(bands, quantity).unwrap();
        sines
            .iter()
            .map(|&sine| {
                let squared = (sine * sine) as f32;
                let found = dispatch_bands!(bands, N => table.lookup::<N>(f32x8::splat(squared))).unwrap();
                let squared = f64::from(squared);
                let u = squared / (1.0 + (1.0 - squared).sqrt());
                let expected = quantity.zonal(bands, u);
                let difference: Vec<f64> = (0..bands)
                    .map(|l| f64::from(found[l].to_array()[3]) / zonal::rotation_scale(l) - expected[l])
                    .collect();
                basis::magnitude(&difference) / basis::magnitude(&expected)
            })
            .collect()
    }

    #[test]
    fn lookups_are_close_at_every_radius() {
        let sines: Vec<f64> = (0..400).map(|i| 10f64.powf(-6.0 * f64::from(i) / 399.0)).collect();
        for bands in [1, 3, 4, 6, 8] {
            let worst = |quantity| errors(bands, quantity, &sines).into_iter().fold(0.0, f64::max);
            let blocker = worst(Quantity::BlockerMinusOne);
            assert!(blocker < 4e-6, "{bands}: {blocker}");
            let log = worst(Quantity::Logarithm { clip: DEFAULT_CLIP });
            assert!(log < if bands <= 6 { 1e-4 } else { 1e-3 }, "{bands}: {log}");
        }
        // Away from the clipping, small blockers are as accurate as f32.
        let small: Vec<f64> = sines.iter().copied().filter(|&s| s < 0.3).collect();
        let worst = errors(4, Quantity::Logarithm { clip: DEFAULT_CLIP }, &small).into_iter().fold(0.0, f64::max);
        assert!(worst < 2e-6, "{worst}");
    }

    #[test]
    fn limits_are_defined() {
        let table = BlockerTable::build(4, Quantity::Logarithm { clip: DEFAULT_CLIP }).unwrap();
        let found = table.lookup::<16>(f32x8::from([0.0, -1.0, f32::NAN, 2.0, 1.0, f32::INFINITY, 1e-30, 1e-12]));
        for value in &found[..4] {
            let lanes = value.to_array();
            assert_eq!(lanes[..3], [0.0; 3]);
            assert_eq!(lanes[3], lanes[4]);
            assert_eq!(lanes[5], lanes[4]);
            assert!(lanes.iter().all(|x| x.is_finite()));
            assert!(lanes[6] != 0.0);
        }
        assert!(BlockerTable::build(0, Quantity::BlockerMinusOne).is_none());
        assert!(BlockerTable::build(9, Quantity::BlockerMinusOne).is_none());
    }
}
