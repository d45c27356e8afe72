//! Light of local lights, eight receivers at a time, on top of what is infinitely far.

use super::{open_vector, place::Place, places};
use crate::prt::{
    bake::table::Transfer,
    prepare::{lamps::FrameLamps, light::FrameLight},
};
use glam::Vec3;
use halfshade_scene::{RadianceMut, Receivers};
use halfshade_sh::{
    dispatch_bands,
    kernel::{self, LANES, ShBatch},
};
use halfshade_strategy::Prepared;
use wide::f32x8;

/// Adds local lights to what another one has shaded.
pub(crate) struct LampsOver<'a> {
    pub(crate) rest: Box<dyn Prepared + 'a>,
    pub(crate) transfer: &'a Transfer,
    pub(crate) light: &'a FrameLight,
    pub(crate) lamps: &'a FrameLamps,
}

impl Prepared for LampsOver<'_> {
    fn shade(&self, receivers: Receivers<'_>, mut out: RadianceMut<'_>) {
        self.rest.shade(receivers, RadianceMut { channels: out.channels.each_mut().map(|channel| &mut **channel) });
        // Settings allow no other number of bands.
        let _: Option<()> = dispatch_bands!(self.transfer.bands, N => self.add::<N>(&receivers, &mut out));
    }
}

impl LampsOver<'_> {
    fn add<const N: usize>(&self, receivers: &Receivers<'_>, out: &mut RadianceMut<'_>) {
        for start in (0..receivers.len()).step_by(LANES) {
            let lanes = (receivers.len() - start).min(LANES);
            let transfer = self.transfer::<N>(receivers, start, lanes);
            let places = places_in(self.lamps, receivers, start);
            let light = self.lamps.arriving::<N>(&places);
            for (channel, out) in out.channels.iter_mut().enumerate() {
                let white = kernel::dot(&transfer[channel], &light[channel]).to_array();
                let albedo = &receivers.albedo[channel][start..start + lanes];
                let rest = out[start..].iter_mut().zip(albedo).zip(white);
                rest.for_each(|((out, albedo), white)| *out += albedo * white);
            }
        }
    }

    /// Transfer of eight receivers, by channel.
    fn transfer<const N: usize>(&self, receivers: &Receivers<'_>, start: usize, lanes: usize) -> [ShBatch<N>; 3] {
        let places = places(self.transfer, receivers, start, lanes);
        let mut found = [[[0.0_f32; LANES]; N]; 3];
        for (lane, place) in places.iter().enumerate() {
            let Place::Between(between) = place else { continue };
            for (channel, found) in found.iter_mut().enumerate().take(self.transfer.channels) {
                let mut vector = [0.0; N];
                between.iter().for_each(|&(row, weight)| self.transfer.add_vector(row, channel, weight, &mut vector));
                found.iter_mut().zip(vector).for_each(|(lanes, value)| lanes[lane] = value);
            }
        }
        if self.transfer.channels == 1 {
            found = [found[0]; 3];
        }
        let mut found = found.map(|channel| channel.map(f32x8::from));
        if places.contains(&Place::Open) {
            let is_open =
                f32x8::from(places.map(|place| f32::from(u8::from(place == Place::Open)))).simd_gt(f32x8::ZERO);
            let open = open_vector::<N>(self.light, receivers, start);
            for channel in &mut found {
                channel.iter_mut().zip(open).for_each(|(value, open)| *value = is_open.select(open, *value));
            }
        }
        found
    }
}

/// Where eight receivers from `start` on are in the space of transfer; past the last, it is there again.
pub(crate) fn places_in(lamps: &FrameLamps, receivers: &Receivers<'_>, start: usize) -> [Vec3; LANES] {
    let last = receivers.len() - 1;
    std::array::from_fn(|lane| lamps.baked_from_world.transform_point(receivers.position_at((start + lane).min(last))))
}
