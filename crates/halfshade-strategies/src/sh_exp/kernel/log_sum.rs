//! Visibility by the exponential: first the sum of logarithms.

use super::{Blockers, Receivers8};
use halfshade_sh::kernel::{self, ShBatch};
use wide::f32x8;

/// Σ log B over the spheres [Guerrero2007, eq. 4.7]; the table of `blockers` holds logarithms.
#[inline(never)]
pub(crate) fn log_sum<const N: usize>(blockers: &Blockers<'_>, receivers: &Receivers8) -> ShBatch<N> {
    let mut sum = [f32x8::ZERO; N];
    for blocker in blockers.list {
        // A sphere that no lane sees adds 0 to all of them: leaving it out changes no bit.
        if let Some(seen) = blockers.hiding(blocker, receivers) {
            let scale = blocker.times_factors(blockers.table.lookup::<N>(seen.sin_squared));
            kernel::accumulate_lobe(seen.direction, &scale, &mut sum);
        }
    }
    sum
}
