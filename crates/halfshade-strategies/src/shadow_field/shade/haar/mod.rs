//! Shading over the texels of a cube, one receiver after another.

mod order;
mod receiver;
mod transfer;

use super::runs::each_object;
use crate::shadow_field::{bake::meshes::Source, prepare::haar::HaarPrepared};
use glam::Vec3;
use halfshade_scene::{Lobes, RadianceMut, Receivers};
use halfshade_strategy::Prepared;
use order::{Before, Order, is_before};
use receiver::Receiver;
use transfer::Transfer;

impl Prepared for HaarPrepared<'_> {
    fn shade(&self, receivers: Receivers<'_>, mut out: RadianceMut<'_>) {
        let frame = &self.frame.data;
        let (mut transfer, mut order) = (Transfer::new(self), Order::default());
        each_object(receivers, self.fields.objects.len(), |range, object| {
            let Some(object) = object else { return range.for_each(|i| out.set(i, Vec3::ZERO)) };
            for i in range {
                let lobes = frame.eye_lobes.as_ref().map_or(Lobes::NONE, |lobes| lobes.at(&receivers, i));
                let receiver = Receiver::new(frame, &receivers, i, object, !lobes.is_empty());
                if receiver.is_glossy {
                    transfer.set_gloss(receiver.place.normal, receivers.albedo_at(i), &lobes);
                }
                let radiance = match self.fields.source {
                    Source::Together => traced_radiance(self, &receiver, &mut transfer),
                    Source::Fields | Source::Traced => radiance(self, &receiver, &mut transfer, &mut order),
                };
                out.set(i, if receiver.is_glossy { radiance } else { receivers.albedo_at(i) * radiance });
            }
        });
    }
}

/// `S · U` over all lights, object after object; with the BRDF if that is glossy.
fn radiance(prepared: &HaarPrepared<'_>, receiver: &Receiver, transfer: &mut Transfer<'_>, order: &mut Order) -> Vec3 {
    let frame = &prepared.frame.data;
    order.set(frame, receiver);
    let mut radiance = Vec3::ZERO;
    transfer.start(receiver);
    for step in 0..=order.objects.len() {
        let lights = order.lights_behind(Before::First(step));
        radiance += lights.map(|light| transfer.local(light, receiver)).sum::<Vec3>();
        if let Some(&(_, other)) = order.objects.get(step) {
            transfer.hide_behind(other, receiver);
        }
    }
    radiance += transfer.distant(receiver);
    for light in order.lights_behind(Before::Others) {
        let seen = frame.see(light, &receiver.position);
        transfer.start(receiver);
        for &(_, other) in &order.objects {
            if is_before(frame, other, light, &seen, receiver) {
                transfer.hide_behind(other, receiver);
            }
        }
        radiance += transfer.local(light, receiver);
    }
    radiance
}

/// The same, with all that hides at once.
fn traced_radiance(prepared: &HaarPrepared<'_>, receiver: &Receiver, transfer: &mut Transfer<'_>) -> Vec3 {
    let frame = &prepared.frame.data;
    let mut radiance = Vec3::ZERO;
    let others = || frame.nearest_first[receiver.place.object].iter().copied();
    for light in 0..frame.lights.len() {
        let seen = frame.see(light, &receiver.position);
        transfer.set_traced(receiver, others().filter(|&other| is_before(frame, other, light, &seen, receiver)));
        radiance += transfer.local(light, receiver);
    }
    transfer.set_traced(receiver, others());
    radiance + transfer.distant(receiver)
}
