//! Shading as in [Tamura2006, figure 3], eight receivers side by side, one entity after another.

use super::{OwnKind, ShFields, gloss::GlossBatch, shell::MOST};
use crate::shadow_field::{
    arrangement::{Entity, LocalLight},
    baking::Source,
    basis::Basis,
    traced::{Point, reached as reached_together},
};
use glam::Vec3;
use halfshade_scene::{RadianceMut, Receivers, lobe::MAX_LOBES};
use halfshade_sh::kernel::{self, FULL, LANES, ShBatch};
use std::ops::Range;
use wide::f32x8;

/// Shades all receivers, part by part of their objects: each has its order of entities.
pub(super) fn shade<const N: usize>(fields: &ShFields, receivers: Receivers<'_>, mut out: RadianceMut<'_>) {
    fields.arrangement.each_part(receivers, |range, part| match part {
        Some(part) => shade_part::<N>(fields, receivers, range, part, &mut out),
        None => range.for_each(|i| out.set(i, Vec3::ZERO)),
    });
}

/// Shades receivers of one part of an object.
fn shade_part<const N: usize>(
    fields: &ShFields,
    receivers: Receivers<'_>,
    range: Range<usize>,
    (object, part): (usize, usize),
    out: &mut RadianceMut<'_>,
) {
    let arrangement = &fields.arrangement;
    for start in range.clone().step_by(LANES) {
        let lanes = (range.end - start).min(LANES);
        let lane = |k: usize| start + k.min(lanes - 1);
        let positions: [[f32; 3]; LANES] =
            std::array::from_fn(|k| arrangement.point(receivers.position_at(lane(k)).as_dvec3()));
        let position: [f32x8; 3] = std::array::from_fn(|axis| f32x8::from(positions.map(|p| p[axis])));
        let normals: [Vec3; LANES] = std::array::from_fn(|k| arrangement.direction(receivers.normal_at(lane(k))));
        let normal = std::array::from_fn(|axis| f32x8::from(normals.map(|n| n[axis])));
        let cosine = kernel::times_bands(&kernel::basis::<f32x8, N>(normal), &fields.cosine);
        let own = own::<N>(fields, object, receivers, &position, lane);
        // U of the diffuse part, and of each glossy lobe.
        let mut units = [[f32x8::ZERO; N]; 1 + MAX_LOBES];
        units[0] = match &own {
            Own::Visible(visible) => kernel::product(visible, &cosine),
            Own::Transfer(transfer, found) => std::array::from_fn(|i| found.select(transfer[i], cosine[i])),
        };
        let gloss = arrangement
            .eye_lobes
            .as_ref()
            .map(|lobes| GlossBatch::new(fields, lobes, &receivers, lane, (&normal, &cosine)));
        if let (Some(gloss), Own::Visible(visible)) = (&gloss, &own) {
            for (unit, shape) in units[1..].iter_mut().zip(&gloss.shapes[..gloss.count]) {
                *unit = kernel::product(visible, shape);
            }
        }
        let units = &mut units[..1 + gloss.as_ref().map_or(0, |gloss| gloss.count)];
        let mut radiance = [[f32x8::ZERO; 3]; 1 + MAX_LOBES];
        let order = arrangement.order(object, part);
        let together = |nearer: &[Entity]| {
            let mut unit = [[0.0_f32; LANES]; N];
            for k in 0..lanes {
                let point = Point { object, position: positions[k], normal: normals[k] };
                let vector = fields.basis.project(&reached_together(
                    arrangement,
                    |object| fields.known[object].traced.as_ref(),
                    point,
                    nearer,
                ));
                unit.iter_mut().zip(vector).for_each(|(row, value)| row[k] = value);
            }
            unit.map(f32x8::from)
        };
        for (number, entity) in order.iter().enumerate() {
            match *entity {
                Entity::Object(_) if fields.source == Source::Together => {}
                Entity::Object(other) => {
                    if let Some(visible) = visible::<N>(fields, other, &position) {
                        units.iter_mut().for_each(|unit| *unit = kernel::product(&visible, unit));
                    }
                }
                Entity::Light(light) => {
                    if fields.source == Source::Together {
                        units[0] = together(&order[..number]);
                    }
                    let light = &arrangement.lights[light];
                    let cap = cap::<N>(fields, light, &position);
                    for (unit, radiance) in units.iter().zip(&mut radiance) {
                        let reached = kernel::dot(&cap, unit);
                        (0..3).for_each(|c| radiance[c] += reached * f32x8::splat(light.radiance[c]));
                    }
                }
            }
        }
        if fields.source == Source::Together {
            units[0] = together(order);
        }
        for (unit, radiance) in units.iter().zip(&mut radiance) {
            for (values, weights) in unit.iter().zip(&fields.light) {
                (0..3).for_each(|c| radiance[c] = values.mul_add(f32x8::splat(weights[c]), radiance[c]));
            }
        }
        let mut glossy = [f32x8::ZERO; 3];
        if let Some(gloss) = &gloss {
            for (radiance, scale) in radiance[1..].iter().zip(&gloss.scales[..gloss.count]) {
                (0..3).for_each(|c| glossy[c] = radiance[c].mul_add(scale[c], glossy[c]));
            }
        }
        for k in 0..lanes {
            let [white, glossy] =
                [&radiance[0], &glossy].map(|rgb| Vec3::from(rgb.each_ref().map(|c| c.as_array()[k])));
            out.set(start + k, receivers.albedo_at(start + k) * white + glossy);
        }
    }
}

/// What eight receivers know of their own object, in light space.
enum Own<const N: usize> {
    /// What it leaves visible.
    Visible(ShBatch<N>),
    /// With the cosine over π; and where that is known.
    Transfer(ShBatch<N>, f32x8),
}

/// From the receivers' vertices.
fn own<const N: usize>(
    fields: &ShFields,
    object: usize,
    receivers: Receivers<'_>,
    position: &[f32x8; 3],
    lane: impl Fn(usize) -> usize,
) -> Own<N> {
    let (known, arrangement) = (&fields.known[object], &fields.arrangement);
    let mut local = [[0.0_f32; LANES]; N];
    let mut found = [0.0_f32; LANES];
    let points = arrangement.places[object].in_object(position).map(f32x8::to_array);
    for k in 0..LANES {
        let point = Vec3::from(points.map(|axis| axis[k]));
        if let Some(between) = arrangement.vertex(object, receivers.index[lane(k)], point) {
            for (vertex, weight) in between.parts() {
                local.iter_mut().zip(&known.own[vertex * N..]).for_each(|(row, &value)| row[k] += weight * value);
            }
            found[k] = f32::from(u8::from(between.is_vertex));
        }
    }
    let vector = turned(&local.map(f32x8::from), &fields.rotations[object]);
    match fields.own_kind {
        OwnKind::Blocked => Own::Visible(one_less(&vector)),
        OwnKind::Transfer => Own::Transfer(vector, f32x8::from(found).simd_gt(f32x8::ZERO)),
    }
}

/// What an object leaves visible of eight places, in light space; `None` if it hides nothing.
#[inline(never)]
fn visible<const N: usize>(fields: &ShFields, object: usize, position: &[f32x8; 3]) -> Option<ShBatch<N>> {
    let mut blocked = [[0.0; MOST]; LANES];
    let place = &fields.arrangement.places[object];
    let known = &fields.known[object];
    if let Some(field) = &known.field {
        field.add_at(place.on_shells(position), &mut blocked);
    } else {
        let traced = known.traced.as_ref()?;
        let points = place.in_object(position).map(f32x8::to_array);
        for (k, blocked) in blocked.iter_mut().enumerate() {
            let vector = traced.blocked_from(&fields.basis, Vec3::from(points.map(|axis| axis[k])));
            blocked[..N].copy_from_slice(&vector);
        }
    }
    Some(one_less(&turned(&transposed(&blocked), &fields.rotations[object])))
}

/// Vectors of eight receivers, one after another, as coefficients.
#[inline(always)]
fn transposed<const N: usize>(vectors: &[[f32; MOST]; LANES]) -> ShBatch<N> {
    let mut batch = [f32x8::ZERO; N];
    for (block, rows) in batch.chunks_mut(LANES).enumerate() {
        let eight = vectors.each_ref().map(|vector| f32x8::from(vector.as_chunks::<LANES>().0[block]));
        rows.copy_from_slice(&f32x8::transpose(eight)[..rows.len()]);
    }
    batch
}

/// `1 - B`.
#[inline(always)]
fn one_less<const N: usize>(blocked: &ShBatch<N>) -> ShBatch<N> {
    let mut visible = blocked.map(|value| -value);
    visible[0] += f32x8::splat(FULL);
    visible
}

/// Eight vectors, turned band by band.
#[inline(always)]
fn turned<const N: usize>(vector: &ShBatch<N>, rotation: &[f32]) -> ShBatch<N> {
    let mut turned = [f32x8::ZERO; N];
    let mut blocks = rotation;
    for l in 0..const { N.isqrt() } {
        let side = 2 * l + 1;
        let (block, rest) = blocks.split_at(side * side);
        blocks = rest;
        for (row, sum) in block.chunks_exact(side).zip(&mut turned[l * l..]) {
            for (&weight, value) in row.iter().zip(&vector[l * l..]) {
                *sum = value.mul_add(f32x8::splat(weight), *sum);
            }
        }
    }
    turned
}

/// S_j of a light of radiance 1: its cap.
fn cap<const N: usize>(fields: &ShFields, light: &LocalLight, position: &[f32x8; 3]) -> ShBatch<N> {
    let offset: [f32x8; 3] = std::array::from_fn(|axis| f32x8::splat(light.center[axis]) - position[axis]);
    let squared = offset[0].mul_add(offset[0], offset[1].mul_add(offset[1], offset[2] * offset[2]));
    let squared = squared.fast_max(f32x8::splat(f32::MIN_POSITIVE));
    let inverse = f32x8::ONE / squared.sqrt();
    let direction = offset.map(|axis| axis * inverse);
    // Within the light it is everywhere it can be: the table ends at a right angle.
    let sine_squared = (f32x8::splat(light.radius * light.radius) / squared).fast_min(f32x8::ONE);
    let scale = fields.table.lookup::<N>(sine_squared);
    let mut minus_cap = [f32x8::ZERO; N];
    kernel::accumulate_lobe(direction, &scale, &mut minus_cap);
    minus_cap.map(|value| -value)
}
