//! Receivers, eight at a time.

pub(crate) mod clusters;
pub(crate) mod gloss;
pub(crate) mod lamps;
pub(crate) mod place;
pub(crate) mod volume;

use super::{
    bake::table::Transfer,
    kernel::dot::{added, between_rows, of_row},
    prepare::light::FrameLight,
};
use halfshade_scene::{RadianceMut, Receivers};
use halfshade_sh::{
    dispatch_bands,
    kernel::{self, LANES, ShBatch},
};
use halfshade_strategy::Prepared;
use place::{Place, first_of_eight};
use wide::f32x8;

/// A frame ready to be shaded.
pub(crate) struct Shader<'a> {
    pub(crate) transfer: &'a Transfer,
    pub(crate) light: &'a FrameLight,
}

impl Prepared for Shader<'_> {
    fn shade(&self, receivers: Receivers<'_>, out: RadianceMut<'_>) {
        // Settings allow no other number of bands.
        let _: Option<()> = dispatch_bands!(self.transfer.bands, N => match self.transfer.channels {
            1 => self.shade_all::<N, 1>(receivers, out),
            _ => self.shade_all::<N, 3>(receivers, out),
        });
    }
}

impl Shader<'_> {
    fn shade_all<const N: usize, const C: usize>(&self, receivers: Receivers<'_>, out: RadianceMut<'_>) {
        by_eights(receivers, out, |start, lanes| match first_of_eight(self.transfer, &receivers, start) {
            Some(first) => {
                let table = &self.transfer.values[first * C * N..];
                added(|lane| of_row::<N, C>(&table[lane * C * N..], &self.light.vectors))
            }
            None => self.anywhere::<N, C>(&receivers, start, lanes),
        });
    }

    /// Radiance of white receivers that lie anywhere.
    fn anywhere<const N: usize, const C: usize>(
        &self,
        receivers: &Receivers<'_>,
        start: usize,
        lanes: usize,
    ) -> [f32x8; 3] {
        let places = places(self.transfer, receivers, start, lanes);
        let white = added(|lane| match &places[lane] {
            Place::Between(between) => between_rows::<N, C>(&self.transfer.values, between, &self.light.vectors),
            Place::Dark | Place::Open => [f32x8::ZERO; 3],
        });
        with_open::<N>(white, &places, self.light, receivers, start)
    }
}

/// Writes radiance of receivers, eight by eight, given that of white ones from a number on, of which so many are asked for.
pub(crate) fn by_eights(
    receivers: Receivers<'_>,
    mut out: RadianceMut<'_>,
    white: impl Fn(usize, usize) -> [f32x8; 3],
) {
    for start in (0..receivers.len()).step_by(LANES) {
        let white = white(start, (receivers.len() - start).min(LANES));
        for ((out, albedo), white) in out.channels.iter_mut().zip(receivers.albedo).zip(white) {
            match (out[start..].first_chunk_mut::<LANES>(), albedo[start..].first_chunk::<LANES>()) {
                (Some(out), Some(albedo)) => *out = (f32x8::from(*albedo) * white).to_array(),
                _ => {
                    let rest = out[start..].iter_mut().zip(&albedo[start..]).zip(white.to_array());
                    rest.for_each(|((out, albedo), white)| *out = albedo * white);
                }
            }
        }
    }
}

/// Places of so many receivers from a number on.
pub(crate) fn places(transfer: &Transfer, receivers: &Receivers<'_>, start: usize, lanes: usize) -> [Place; LANES] {
    std::array::from_fn(|lane| if lane < lanes { Place::of(transfer, receivers, start + lane) } else { Place::Dark })
}

/// Radiance of eight white receivers, those in the open added.
pub(crate) fn with_open<const N: usize>(
    mut white: [f32x8; 3],
    places: &[Place; LANES],
    light: &FrameLight,
    receivers: &Receivers<'_>,
    start: usize,
) -> [f32x8; 3] {
    if places.contains(&Place::Open) {
        let is_open = f32x8::from(places.map(|place| if place == Place::Open { 1.0 } else { 0.0 }));
        let open = open::<N>(light, receivers, start);
        (0..3).for_each(|c| white[c] = is_open.simd_gt(f32x8::ZERO).select(open[c], white[c]));
    }
    white
}

/// Radiance of white receivers that see everything.
fn open<const N: usize>(light: &FrameLight, receivers: &Receivers<'_>, start: usize) -> [f32x8; 3] {
    let transfer = open_vector::<N>(light, receivers, start);
    light.coefficients.each_ref().map(|light| {
        let products = transfer.iter().zip(light);
        products.fold(f32x8::ZERO, |sum, (t, &l)| t.mul_add(f32x8::splat(l), sum))
    })
}

/// Transfer of receivers that see everything.
pub(crate) fn open_vector<const N: usize>(light: &FrameLight, receivers: &Receivers<'_>, start: usize) -> ShBatch<N> {
    let FrameLight { baked_from_world, cosine, .. } = light;
    let last = receivers.len() - 1;
    let normals: [glam::Vec3; LANES] =
        std::array::from_fn(|lane| *baked_from_world * receivers.normal_at((start + lane).min(last)));
    let normal = std::array::from_fn(|axis| f32x8::from(normals.map(|normal| normal[axis])));
    kernel::times_bands(&kernel::basis::<f32x8, N>(normal), cosine)
}
