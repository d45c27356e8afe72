//! Low-discrepancy points, shifted anew for each receiver.

use crate::shared::split_mix::{STEP, split_mix};

/// The additive recurrence x_i = x_0 + i·α modulo 1 with α_j = φ^-j, φ the root above 1 of φ^(d+1) = φ + 1: the
/// generalized golden ratio, whose multiples fill d dimensions evenly for any number of points. The shift x_0 is uniform
/// and hashed from the receiver, so that every point is uniform by itself and the estimate unbiased.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Points<const D: usize> {
    /// Fixed point: 2^64 is 1.
    step: [u64; D],
    shift: [u64; D],
}

impl<const D: usize> Points<D> {
    pub(crate) fn new(receiver: u32) -> Self {
        // Newton's iteration from above; three steps past convergence for every small D.
        let mut ratio = 2.0f64;
        for _ in 0..20 {
            let power = ratio.powi(D as i32);
            ratio -= (power * ratio - ratio - 1.0) / ((D + 1) as f64 * power - 1.0);
        }
        let mut hash = u64::from(receiver);
        Self {
            step: std::array::from_fn(|j| (ratio.powi(-(j as i32 + 1)) * 2.0f64.powi(64)) as u64),
            shift: std::array::from_fn(|_| next_hash(&mut hash)),
        }
    }

    /// Step from point to point.
    pub(crate) fn step(&self) -> [u64; D] {
        self.step
    }

    /// Point `i`, in [0, 1)^D.
    pub(crate) fn at(&self, i: u32) -> [f64; D] {
        std::array::from_fn(|j| {
            let fixed = self.shift[j].wrapping_add(self.step[j].wrapping_mul(u64::from(i)));
            (fixed >> 11) as f64 * 2.0f64.powi(-53)
        })
    }
}

/// The next number of a state.
fn next_hash(state: &mut u64) -> u64 {
    let hash = split_mix(*state);
    *state = state.wrapping_add(STEP);
    hash
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn fills_boxes_more_evenly_than_chance() {
        let count = 1024;
        for receiver in [0, 1, 77] {
            let points = Points::<3>::new(receiver);
            for (sx, sy, sz) in [(0.5, 0.5, 0.5), (0.3, 0.9, 0.7), (0.1, 0.8, 1.0)] {
                let inside = (0..count)
                    .filter(|&i| {
                        let [x, y, z] = points.at(i);
                        x < sx && y < sy && z < sz
                    })
                    .count();
                let volume: f64 = sx * sy * sz;
                // Chance would err by 0.016 at one standard deviation of the largest of these.
                assert!((inside as f64 / f64::from(count) - volume).abs() < 0.012);
            }
        }
    }

    #[test]
    fn receivers_differ() {
        assert_ne!(Points::<2>::new(3).at(0), Points::<2>::new(4).at(0));
    }
}
