//! Visibility by products.

use super::{Blockers, Receivers8};
use halfshade_sh::kernel::{self, ShBatch};
use wide::f32x8;

/// B_1 * B_2 * .. one after another [Guerrero2007, eq. 4.6], held to the range of visibility after each; the table of
/// `blockers` holds blockers less one.
#[inline(never)]
pub(crate) fn product<const N: usize>(blockers: &Blockers<'_>, receivers: &Receivers8) -> ShBatch<N> {
    let mut visibility = [f32x8::ZERO; N];
    visibility[0] = f32x8::splat(kernel::FULL);
    for blocker in blockers.list {
        if let Some(seen) = blockers.hiding(blocker, receivers) {
            let scale = blockers.table.lookup::<N>(seen.sin_squared);
            let mut minus_cap = [f32x8::ZERO; N];
            kernel::accumulate_lobe(seen.direction, &scale, &mut minus_cap);
            // V*(1 - C) = V - V*C: a lane that sees nothing keeps its bits.
            let blocked = kernel::product(&visibility, &minus_cap);
            let mut next = visibility;
            next.iter_mut().zip(blocked).for_each(|(value, blocked)| *value += blocked);
            kernel::limit_to_visibility(&mut next);
            let sees = seen.sin_squared.simd_gt(f32x8::ZERO);
            visibility.iter_mut().zip(next).for_each(|(value, next)| *value = sees.select(next, *value));
        }
    }
    visibility
}
