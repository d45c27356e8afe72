//! Flats in single precision, by eights: how far rows are from them is asked over and over.

use super::{principal::Flat, table::eights};
use halfshade_sh::kernel::{LANES, MAX_BANDS};
use wide::f32x8;

/// Eights of the longest row: three vectors.
const MOST_EIGHTS: usize = 3 * MAX_BANDS * MAX_BANDS / LANES;

/// A flat in single precision.
#[derive(Debug)]
pub(crate) struct RoundedFlat {
    pub(crate) mean: Vec<[f32; LANES]>,
    /// One axis after another.
    axes: Vec<[f32; LANES]>,
}

impl RoundedFlat {
    pub(crate) fn new(flat: &Flat) -> Self {
        let rounded =
            |vector: &[f64]| eights(&vector.iter().map(|&value| value as f32).collect::<Vec<_>>()).collect::<Vec<_>>();
        Self {
            mean: rounded(flat.mean.as_slice()),
            axes: flat.axes.iter().flat_map(|axis| rounded(axis.as_slice())).collect(),
        }
    }

    /// Squared distance of a row from the flat: that from its mean less the squares of what lies along the axes.
    pub(crate) fn squared_error(&self, row: &[[f32; LANES]]) -> f32 {
        let mut differences = [f32x8::ZERO; MOST_EIGHTS];
        let mut sum = f32x8::ZERO;
        for ((difference, &x), &mean) in differences.iter_mut().zip(row).zip(&self.mean) {
            *difference = f32x8::from(x) - f32x8::from(mean);
            sum = difference.mul_add(*difference, sum);
        }
        let along = |axis: &[[f32; LANES]]| {
            let products = differences.iter().zip(axis);
            products.fold(f32x8::ZERO, |sum, (x, &axis)| x.mul_add(f32x8::from(axis), sum)).reduce_add()
        };
        let explained: f32 = self.axes.chunks_exact(self.mean.len()).map(along).map(|x| x * x).sum();
        (sum.reduce_add() - explained).max(0.0)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::prt::bake::compress::table::{Rows, squared_distance};
    use crate::shared::test_scenes::random;

    #[test]
    fn errors_are_those_of_plain_loops() {
        let mut random = random(8);
        for width in [1, 4, 16, 27, 192] {
            let values: Vec<f32> = (0..6 * width).map(|_| random()).collect();
            let rows = Rows::new(&values, width);
            assert_eq!((rows.len(), rows.row(3)), (6, &values[3 * width..4 * width]));
            let flat = Flat::fit(&rows, &[0, 1, 2, 3], 2);
            let rounded = RoundedFlat::new(&flat);
            for number in 0..6 {
                let x = nalgebra::DVector::from_iterator(width, rows.row(number).iter().map(|&x| f64::from(x)));
                let mut rest = &x - &flat.mean;
                let whole = rest.norm_squared();
                flat.axes.iter().for_each(|axis| rest -= axis * axis.dot(&rest));
                let found = rounded.squared_error(rows.eights(number));
                assert!((f64::from(found) - rest.norm_squared()).abs() < 2e-6 * whole.max(1.0), "{width} {number}");
                let distance = squared_distance(rows.eights(number), &rounded.mean);
                assert!((f64::from(distance) - whole).abs() < 2e-6 * whole.max(1.0), "{width} {number}");
            }
        }
    }
}
