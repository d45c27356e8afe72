//! A local light in spherical harmonics, as receivers see it: a cap of directions.

use halfshade_sh::{
    blocker_table::BlockerTable,
    kernel::{self, FULL, ShBatch},
};
use wide::f32x8;

/// SH vectors of a spherical light of radiance 1 for eight receivers: its cap, or all directions where it `is_around` the
/// receiver. Its centre is at `offset`; `table` is that of minus the cap.
pub(crate) fn light_cap<const N: usize>(
    offset: &[f32x8; 3],
    distance_squared: f32x8,
    is_around: f32x8,
    radius: f32,
    table: &BlockerTable,
) -> ShBatch<N> {
    let squared = distance_squared.fast_max(f32x8::splat(f32::MIN_POSITIVE));
    let inverse = f32x8::ONE / squared.sqrt();
    let direction = offset.map(|axis| axis * inverse);
    let sine_squared = (f32x8::splat(radius * radius) / squared).fast_min(f32x8::ONE);
    let scale = table.lookup::<N>(sine_squared);
    let mut minus_cap = [f32x8::ZERO; N];
    kernel::accumulate_lobe(direction, &scale, &mut minus_cap);
    std::array::from_fn(|i| {
        let all = if i == 0 { f32x8::splat(FULL) } else { f32x8::ZERO };
        is_around.select(all, -minus_cap[i])
    })
}
