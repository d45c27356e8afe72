//! `exp=shares`: visibility as one less the share that each sphere alone covers, in place of products and exponentials.

use super::{
    Blockers, Receivers8,
    blocker::{Seen, versine},
};
use glam::DMat3;
use halfshade_sh::kernel::{self, ExposedShares, ShBatch, SphericalCap8};
use wide::f32x8;

/// Memory for one batch of receivers, sized by the number of spheres once.
pub(crate) struct Exposure {
    seen: Vec<Seen>,
    shares: ExposedShares,
    /// Into the space in which shares have fixed sample points, row by row.
    turn: [f32x8; 9],
}

impl Exposure {
    pub(crate) fn new(points: usize, spheres: usize, turn: DMat3) -> Self {
        Self {
            seen: Vec::with_capacity(spheres),
            shares: ExposedShares::new(points, spheres),
            turn: turn.transpose().to_cols_array().map(|value| f32x8::splat(value as f32)),
        }
    }

    /// `V = 1 - Σ w_s cap_s` with the exposed shares w_s of [`ExposedShares`], held to the range of visibility.
    ///
    /// A lane that sees nothing of a sphere has a cap of 0 there, which takes nothing from any other's share.
    #[inline(never)]
    pub(crate) fn visibility<const N: usize>(&mut self, blockers: &Blockers<'_>, receivers: &Receivers8) -> ShBatch<N> {
        self.seen.clear();
        self.seen.extend(blockers.list.iter().filter_map(|blocker| blockers.hiding(blocker, receivers)));
        let turn = &self.turn;
        let caps = self.seen.iter().map(|seen| SphericalCap8 {
            direction: std::array::from_fn(|axis| {
                let [x, y, z] = seen.direction;
                turn[3 * axis].mul_add(x, turn[3 * axis + 1].mul_add(y, turn[3 * axis + 2] * z))
            }),
            versine: versine(seen.sin_squared),
        });
        let shares = self.shares.evaluate(caps);
        let mut visibility = [f32x8::ZERO; N];
        for (seen, &share) in self.seen.iter().zip(shares) {
            let scale = blockers.table.lookup::<N>(seen.sin_squared).map(|value| value * share);
            kernel::accumulate_lobe(seen.direction, &scale, &mut visibility);
        }
        visibility[0] += f32x8::splat(kernel::FULL);
        kernel::limit_to_visibility(&mut visibility);
        visibility
    }
}
