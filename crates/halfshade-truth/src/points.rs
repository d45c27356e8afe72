//! Low-discrepancy points: Sobol's sequence in two dimensions, Owen-scrambled anew for every receiver and replicate.
//!
//! The scrambling is the hashed one of \[Burley2020\], from the crate sobol_burley. Points are visited in Morton order of
//! their unscrambled places: scrambling permutes the cells of each binary subdivision among their like, so that
//! neighbours stay neighbours and successive rays run close together.

use sobol_burley::parts::{hash, owen_scramble_rev, sobol_rev};

/// Most points of one sequence: the table of direction numbers ends here.
pub(crate) const MAX_POINTS: usize = 1 << 16;

/// The first points of the sequence, unscrambled, their bits reversed as the scrambling wants them.
#[derive(Debug)]
pub(crate) struct Points {
    reversed: Vec<[u32; 2]>,
}

/// One random scrambling.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Scramble([u32; 2]);

impl Points {
    /// The first `count` points, at most [`MAX_POINTS`].
    pub(crate) fn first(count: usize) -> Self {
        let mut reversed: Vec<[u32; 2]> = (0..count.min(MAX_POINTS) as u32)
            .map(|index| [sobol_rev(index.reverse_bits(), 0), sobol_rev(index.reverse_bits(), 1)])
            .collect();
        reversed.sort_unstable_by_key(|point| morton_code(point.map(u32::reverse_bits)));
        Self { reversed }
    }

    pub(crate) fn as_slice(&self) -> &[[u32; 2]] {
        &self.reversed
    }
}

impl Scramble {
    /// The scrambling of one replicate of one technique at one receiver.
    pub(crate) fn new(seed: u64, receiver: u32, technique: u32, replicate: u32) -> Self {
        let mut state = hash(seed as u32) ^ hash((seed >> 32) as u32 ^ 0x9e37_79b9);
        for word in [receiver, technique, replicate] {
            state = hash(state.wrapping_mul(0x85eb_ca6b).wrapping_add(word));
        }
        Self([hash(state ^ 0x517c_c1b7), hash(state ^ 0x2722_0a95)])
    }

    /// The random bits that it is made of.
    pub(crate) fn words(self) -> [u32; 2] {
        self.0
    }

    /// A point of the sequence, scrambled, as whole numbers of 32 bits.
    #[inline(always)]
    pub(crate) fn apply(self, reversed: [u32; 2]) -> [u32; 2] {
        [
            owen_scramble_rev(reversed[0], self.0[0]).reverse_bits(),
            owen_scramble_rev(reversed[1], self.0[1]).reverse_bits(),
        ]
    }
}

/// The centre of one of 2²³ cells of the unit interval: single precision resolves no more near 1.
#[inline(always)]
pub(crate) fn unit_f32(bits: u32) -> f32 {
    (bits >> 9) as f32 * (1.0 / 8_388_608.0) + 0.5 / 8_388_608.0
}

/// The centre of one of 2³² cells of the unit interval.
#[inline(always)]
pub(crate) fn unit_f64(bits: u32) -> f64 {
    (f64::from(bits) + 0.5) / 4_294_967_296.0
}

fn morton_code([x, y]: [u32; 2]) -> u64 {
    let spread = |bits: u32| {
        let mut x = u64::from(bits);
        x = (x | x << 16) & 0x0000_ffff_0000_ffff;
        x = (x | x << 8) & 0x00ff_00ff_00ff_00ff;
        x = (x | x << 4) & 0x0f0f_0f0f_0f0f_0f0f;
        x = (x | x << 2) & 0x3333_3333_3333_3333;
        (x | x << 1) & 0x5555_5555_5555_5555
    };
    spread(x) << 1 | spread(y)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_scrambling_is_stratified_in_all_elementary_intervals() {
        let points = Points::first(256);
        for replicate in 0..50 {
            let scramble = Scramble::new(3, 7, 0, replicate);
            for columns_log2 in 0..=8_u32 {
                let mut seen = [false; 256];
                for &point in points.as_slice() {
                    let [x, y] = scramble.apply(point);
                    let (column, row) = (u64::from(x) << columns_log2 >> 32, u64::from(y) << (8 - columns_log2) >> 32);
                    let cell = (column << (8 - columns_log2) | row) as usize;
                    assert!(!std::mem::replace(&mut seen[cell], true), "two points in one interval");
                }
            }
        }
    }

    #[test]
    fn each_point_is_uniform_over_scramblings() {
        // The first point alone, over 40,000 scramblings: mean 1/2 and variance 1/12 within five standard errors.
        let point = Points::first(1).as_slice()[0];
        let count = 40_000;
        for axis in 0..2 {
            let values: Vec<f64> =
                (0..count).map(|r| unit_f64(Scramble::new(11, 0, r / 16, r % 16).apply(point)[axis])).collect();
            let mean = values.iter().sum::<f64>() / f64::from(count);
            let variance = values.iter().map(|v| (v - mean).powi(2)).sum::<f64>() / f64::from(count);
            assert!((mean - 0.5).abs() < 5.0 * (1.0 / 12.0 / f64::from(count)).sqrt(), "{mean}");
            assert!((variance - 1.0 / 12.0).abs() < 5.0 * (1.0 / 180.0 / f64::from(count)).sqrt(), "{variance}");
        }
    }

    #[test]
    fn the_unit_interval_is_open() {
        assert!(unit_f32(0) > 0.0 && unit_f32(u32::MAX) < 1.0);
        assert!(unit_f64(0) > 0.0 && unit_f64(u32::MAX) < 1.0);
    }
}
