//! Shading in spherical harmonics, eight receivers side by side, one object after another.

mod batch;
mod gloss;
mod light_transfer;
mod occlusion;

use super::{runs::each_object, traced::transfer};
use crate::{
    shadow_field::{
        bake::{basis::Basis, meshes::Source},
        kernel::{
            bounded_product::Bound,
            light_product::{add_distant, add_local},
        },
        prepare::sh::ShPrepared,
    },
    shared::light_cap::light_cap,
};
use batch::Batch;
use glam::Vec3;
use gloss::GlossBatch;
use halfshade_scene::{RadianceMut, Receivers};
use halfshade_sh::{
    dispatch_bands,
    kernel::{self, LANES, ShBatch},
};
use halfshade_strategy::Prepared;
use light_transfer::{LightTransfer, MOST_TRANSFERS};
use occlusion::{Own, own, visibility};
use std::ops::Range;
use wide::f32x8;

impl Prepared for ShPrepared<'_> {
    fn shade(&self, receivers: Receivers<'_>, out: RadianceMut<'_>) {
        // Baking made sure that there is a kernel for this number of bands.
        let _: Option<()> = dispatch_bands!(self.fields.bands, N => shade::<N>(self, receivers, out));
    }
}

/// Shades all receivers, object by object.
fn shade<const N: usize>(prepared: &ShPrepared<'_>, receivers: Receivers<'_>, mut out: RadianceMut<'_>) {
    let mut before_lights = vec![LightTransfer::SHARED; prepared.frame.data.lights.len()];
    each_object(receivers, prepared.fields.objects.len(), |range, object| match object {
        Some(object) => shade_object::<N>(prepared, receivers, range, object, &mut before_lights, &mut out),
        None => range.for_each(|i| out.set(i, Vec3::ZERO)),
    });
}

/// Shades receivers of one object.
fn shade_object<const N: usize>(
    prepared: &ShPrepared<'_>,
    receivers: Receivers<'_>,
    range: Range<usize>,
    object: usize,
    before_lights: &mut [LightTransfer<N>],
    out: &mut RadianceMut<'_>,
) {
    let (fields, data) = (prepared.fields, &prepared.frame.data);
    for start in range.clone().step_by(LANES) {
        let batch = Batch::new(data, receivers, object, start..range.end);
        let cosine = kernel::times_bands(&kernel::basis::<f32x8, N>(batch.normal), &fields.cosine);
        let gloss = data.eye_lobes.as_ref().map(|lobes| GlossBatch::new(data, lobes, &batch, &cosine));
        let count = 1 + gloss.as_ref().map_or(0, |gloss| gloss.count);
        let bounds: [Bound<'_, N>; MOST_TRANSFERS] = std::array::from_fn(|number| match &gloss {
            Some(gloss) if number > 0 => Bound::lobe(&gloss.shapes[number - 1]),
            _ => Bound::diffuse(&cosine),
        });
        let bounds = &bounds[..count];
        let own = own::<N>(prepared, &batch);
        let mut transfers = [[f32x8::ZERO; N]; MOST_TRANSFERS];
        let transfers = &mut transfers[..count];
        for (transfer, bound) in transfers.iter_mut().zip(bounds) {
            *transfer = match &own {
                Own::Visible(visible) => bound.times(bound.shape(), visible),
                Own::Transfer(own, found) => std::array::from_fn(|i| found.select(own[i], bound.shape()[i])),
            };
        }
        before_lights.iter_mut().for_each(|light| light.is_apart = false);
        if fields.source == Source::Together {
            trace_all(prepared, &batch, transfers, before_lights);
        } else {
            hide_all(prepared, &batch, bounds, transfers, before_lights);
        }
        let radiance = gather(prepared, &batch, transfers, before_lights);
        let mut glossy = [f32x8::ZERO; 3];
        if let Some(gloss) = &gloss {
            for (radiance, scale) in radiance[1..].iter().zip(&gloss.scales[..gloss.count]) {
                (0..3).for_each(|c| glossy[c] = radiance[c].mul_add(scale[c], glossy[c]));
            }
        }
        for k in batch.lanes() {
            let [white, glossy] =
                [&radiance[0], &glossy].map(|rgb| Vec3::from(rgb.each_ref().map(|c| c.as_array()[k])));
            out.set(start + k, receivers.albedo_at(start + k) * white + glossy);
        }
    }
}

/// Multiplies with what the other objects leave visible, from near to far.
fn hide_all<const N: usize>(
    prepared: &ShPrepared<'_>,
    batch: &Batch<'_>,
    bounds: &[Bound<'_, N>],
    transfers: &mut [ShBatch<N>],
    before_lights: &mut [LightTransfer<N>],
) {
    let data = &prepared.frame.data;
    for &other in &data.nearest_first[batch.object] {
        let Some(visible) = visibility::<N>(prepared, other, &batch.position) else { continue };
        for (light, transfer) in before_lights.iter_mut().enumerate() {
            let before = data.is_before(other, light, &data.see(light, &batch.position), &batch.position);
            transfer.hide(before, &visible, bounds, transfers);
        }
        transfers.iter_mut().zip(bounds).for_each(|(transfer, bound)| *transfer = bound.times(transfer, &visible));
    }
}

/// Projects what rays at the receivers find of all objects at once.
fn trace_all<const N: usize>(
    prepared: &ShPrepared<'_>,
    batch: &Batch<'_>,
    transfers: &mut [ShBatch<N>],
    before_lights: &mut [LightTransfer<N>],
) {
    let (fields, data) = (prepared.fields, &prepared.frame.data);
    let order = &data.nearest_first[batch.object];
    let traced_transfer = |before: &dyn Fn(usize) -> f32x8| {
        let mut found = [[0.0_f32; LANES]; N];
        for k in batch.lanes() {
            let nearer = order.iter().copied().filter(|&other| before(other).to_bitmask() & (1 << k) != 0);
            let traced = |object: usize| fields.objects[object].occlusion.traced.as_ref();
            let vector = fields.basis.project(&transfer(data, traced, batch.receiver(k), nearer));
            found.iter_mut().zip(vector).for_each(|(row, value)| row[k] = value);
        }
        found.map(f32x8::from)
    };
    for (light, transfer) in before_lights.iter_mut().enumerate() {
        let seen = data.see(light, &batch.position);
        transfer.is_apart = true;
        transfer.transfers[0] = traced_transfer(&|other| data.is_before(other, light, &seen, &batch.position));
    }
    transfers[0] = traced_transfer(&|_| f32x8::ZERO.simd_eq(f32x8::ZERO));
}

/// `S · U` over all lights, for the diffuse part and each glossy lobe.
fn gather<const N: usize>(
    prepared: &ShPrepared<'_>,
    batch: &Batch<'_>,
    transfers: &[ShBatch<N>],
    before_lights: &[LightTransfer<N>],
) -> [[f32x8; 3]; MOST_TRANSFERS] {
    let data = &prepared.frame.data;
    let mut radiance = [[f32x8::ZERO; 3]; MOST_TRANSFERS];
    for ((number, light), before) in data.lights.iter().enumerate().zip(before_lights) {
        let seen = data.see(number, &batch.position);
        let cap =
            light_cap::<N>(&seen.offset, seen.distance_squared, seen.is_around, light.radius, &prepared.fields.table);
        let of_light = if before.is_apart { &before.transfers[..transfers.len()] } else { transfers };
        for (transfer, radiance) in of_light.iter().zip(&mut radiance) {
            add_local(&cap, transfer, light.radiance, radiance);
        }
    }
    for (transfer, radiance) in transfers.iter().zip(&mut radiance) {
        add_distant(&prepared.frame.light.coefficients, transfer, radiance);
    }
    radiance
}
