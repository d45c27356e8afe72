//! Receivers of a compressed table, eight at a time.

use super::{by_eights, places, with_open};
use crate::prt::{
    bake::table::Transfer,
    kernel::decode::{Product, Weights, between_rows, of_row, transposed},
    prepare::light::FrameLight,
    shade::place::{Place, first_of_eight},
};
use halfshade_scene::{RadianceMut, Receivers};
use halfshade_sh::dispatch_bands;
use halfshade_strategy::Prepared;
use wide::f32x4;

/// A frame ready to be shaded.
pub(crate) struct ClusterShader<'a> {
    pub(crate) transfer: &'a Transfer,
    pub(crate) table: Weights<'a>,
    pub(crate) light: &'a FrameLight,
    /// Light times means and axes.
    pub(crate) products: &'a [Product],
}

impl Prepared for ClusterShader<'_> {
    fn shade(&self, receivers: Receivers<'_>, out: RadianceMut<'_>) {
        // Settings allow no other number of bands.
        let _: Option<()> = dispatch_bands!(self.transfer.bands, N => self.shade_all::<N>(receivers, out));
    }
}

impl ClusterShader<'_> {
    fn shade_all<const N: usize>(&self, receivers: Receivers<'_>, out: RadianceMut<'_>) {
        let Self { transfer, table, light, products } = *self;
        by_eights(receivers, out, |start, lanes| match first_of_eight(transfer, &receivers, start) {
            Some(first) => transposed(|lane| of_row(table, first + lane, products)),
            None => {
                let places = places(transfer, &receivers, start, lanes);
                let white = transposed(|lane| match &places[lane] {
                    Place::Between(between) => between_rows(table, between, products),
                    Place::Dark | Place::Open => f32x4::ZERO,
                });
                with_open::<N>(white, &places, light, &receivers, start)
            }
        });
    }
}
