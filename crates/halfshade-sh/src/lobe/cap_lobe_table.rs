//! Lobes for caps by a table, eight at a time.

use super::cap_lobe::CapFit;
use super::{Lobe8, MAX_EXPONENT};
use crate::kernel::SphericalCap8;
use wide::f32x8;

/// Intervals: the 1000 values of [Meunier2009, 5.2].
const INTERVALS: usize = 1000;

/// n v and s of a [`CapFit`] by versine, 16 KiB.
///
/// The paper tabulates the exponent, which grows without end for small caps; n v stays between 0.96 and 1.26.
#[derive(Debug, Clone)]
pub struct CapLobeTable {
    fit: CapFit,
    /// n v, s and their differences to the next value.
    rows: Vec<[f32; 4]>,
}

impl CapLobeTable {
    /// Tabulates a fit.
    pub fn build(fit: CapFit) -> Self {
        let at = |index: usize| {
            let (nv, s) = fit.ratios(index as f64 / INTERVALS as f64);
            [nv as f32, s as f32]
        };
        let row = |index: usize| {
            let ([nv, s], [next_nv, next_s]) = (at(index), at(index + 1));
            // Differences of what is stored: then the last value is met exactly.
            [nv, s, next_nv - nv, next_s - s]
        };
        Self { fit, rows: (0..INTERVALS).map(row).collect() }
    }

    /// The fit that is tabulated.
    pub fn fit(&self) -> CapFit {
        self.fit
    }

    /// Memory in bytes.
    pub fn bytes(&self) -> usize {
        std::mem::size_of_val(self.rows.as_slice())
    }

    /// The twin of [`cap_lobe`](super::cap_lobe): relative error 2e-5 of exponent + 1 and of scale, 4e-4 for caps
    /// within 1 degree of a hemisphere.
    #[inline(always)]
    pub fn lookup(&self, cap: &SphericalCap8) -> Lobe8 {
        let versine = cap.versine.max(f32x8::ZERO).fast_min(f32x8::splat(2.0));
        let inside = versine.fast_min(f32x8::ONE);
        let coordinate = inside * f32x8::splat(INTERVALS as f32);
        let start = coordinate.floor().fast_min(f32x8::splat((INTERVALS - 1) as f32));
        let part = coordinate - start;
        let rows = start.fast_trunc_int().to_array().map(|index| self.rows[index as usize]);
        let column = |index: usize| f32x8::from(std::array::from_fn::<f32, 8, _>(|lane| rows[lane][index]));
        let nv = column(2).mul_add(part, column(0));
        let s = column(3).mul_add(part, column(1));
        let wide = if self.fit.keeps_solid_angle() { versine.fast_max(f32x8::ONE) } else { f32x8::ONE };
        let largest = f32x8::splat(MAX_EXPONENT as f32 + 1.0);
        let shrink = (inside * largest / nv).fast_min(f32x8::ONE);
        let n = (nv / inside.fast_max(f32x8::splat(1e-9))).fast_min(largest);
        Lobe8 { axis: cap.direction, exponent: (n - f32x8::ONE).fast_max(f32x8::ZERO), scale: s * wide * shrink }
    }
}

#[cfg(test)]
mod tests {
    use super::super::cap_lobe::cap_lobe;
    use super::*;

    #[test]
    fn lookups_are_close_at_every_radius() {
        for fit in CapFit::ALL {
            let table = CapLobeTable::build(fit);
            assert_eq!((table.fit(), table.bytes()), (fit, 16_000));
            let mut worst = [0.0f64; 2];
            for step in 1..=4000 {
                let versine = (2.0 * f64::from(step) / 4000.0).powi(4).min(2.0) as f32;
                let direction = [f32x8::ZERO, f32x8::ZERO, f32x8::ONE];
                let found = table.lookup(&SphericalCap8 { direction, versine: f32x8::splat(versine) }).lane(4);
                let expected = cap_lobe([0.0, 0.0, 1.0], f64::from(versine), fit);
                let error = |found: f64, expected: f64| (found / expected - 1.0).abs();
                let error =
                    error(found.exponent + 1.0, expected.exponent + 1.0).max(error(found.scale, expected.scale));
                let near = usize::from((0.98..1.0).contains(&versine));
                worst[near] = worst[near].max(error);
            }
            assert!(worst[0] < 2e-5 && worst[1] < 4e-4, "{fit:?}: {worst:?}");
        }
    }

    #[test]
    fn limits_are_defined() {
        for fit in CapFit::ALL {
            let table = CapLobeTable::build(fit);
            let versine = f32x8::from([0.0, -1.0, f32::NAN, 1e-12, 1e-30, 1.0, 2.0, f32::INFINITY]);
            let found = table.lookup(&SphericalCap8 { direction: [f32x8::ONE; 3], versine });
            let (exponents, scales) = (found.exponent.to_array(), found.scale.to_array());
            assert_eq!(scales[..3], [0.0; 3]);
            assert!(exponents.iter().all(|e| (0.0..=MAX_EXPONENT as f32).contains(e)), "{exponents:?}");
            assert!(scales.iter().all(|s| s.is_finite()) && exponents[5..] == [0.0; 3]);
            assert_eq!(scales[5..], if fit.keeps_solid_angle() { [1.0, 2.0, 2.0] } else { [1.0; 3] });
        }
    }
}
