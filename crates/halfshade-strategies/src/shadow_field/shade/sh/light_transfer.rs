//! Transfer towards a local light, which has its own where objects lie behind the light for some receivers.

use crate::shadow_field::kernel::bounded_product::Bound;
use halfshade_scene::lobe::MAX_LOBES;
use halfshade_sh::kernel::ShBatch;
use wide::f32x8;

/// Most transfers U of a receiver: that of the diffuse part, and of each glossy lobe.
pub(crate) const MOST_TRANSFERS: usize = 1 + MAX_LOBES;

/// Transfer towards one light past the objects so far.
#[derive(Clone)]
pub(crate) struct LightTransfer<const N: usize> {
    /// Whether it differs from the transfer that distant light has.
    pub(crate) is_apart: bool,
    pub(crate) transfers: [ShBatch<N>; MOST_TRANSFERS],
}

impl<const N: usize> LightTransfer<N> {
    pub(crate) const SHARED: Self = Self { is_apart: false, transfers: [[f32x8::ZERO; N]; MOST_TRANSFERS] };

    /// Takes what is visible behind an object where that is before the light; until it isn't everywhere, `shared` does.
    pub(crate) fn hide(&mut self, before: f32x8, visible: &ShBatch<N>, bounds: &[Bound<'_, N>], shared: &[ShBatch<N>]) {
        if !self.is_apart {
            if before.all() {
                return;
            }
            self.is_apart = true;
            self.transfers[..shared.len()].copy_from_slice(shared);
        }
        if before.any() {
            for (transfer, bound) in self.transfers.iter_mut().zip(bounds) {
                let product = bound.times(transfer, visible);
                transfer.iter_mut().zip(product).for_each(|(value, product)| *value = before.select(product, *value));
            }
        }
    }
}
