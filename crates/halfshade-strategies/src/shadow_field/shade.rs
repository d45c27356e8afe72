//! Shading as in [Tamura2006, figure 3], eight receivers side by side, one entity after another.

use super::{
    LocalLight, Place, Prepared,
    field::{Field, MOST},
    own::Kind,
};
use glam::Vec3;
use halfshade_scene::{RadianceMut, Receivers};
use halfshade_sh::kernel::{self, LANES, ShBatch};
use std::{
    f32::consts::{FRAC_1_PI, TAU},
    ops::Range,
};
use wide::f32x8;

/// How far, in radii of its object, a receiver may be from the vertex that its number says it is.
const SAME_PLACE: f32 = 1e-4;

/// What is multiplied or added up.
#[derive(Debug, Clone, Copy)]
pub(super) enum Entity {
    Object(usize),
    Light(usize),
}

/// Shades all receivers, part by part of their objects: each has its order of entities.
pub(super) fn shade<const N: usize>(prepared: &Prepared, receivers: Receivers<'_>, mut out: RadianceMut<'_>) {
    let whose = |i: usize| {
        let object = receivers.object[i] as usize;
        (object, prepared.part_of(object, receivers.index[i]))
    };
    let mut first = 0;
    while first < receivers.len() {
        let (object, part) = whose(first);
        let end = (first + 1..receivers.len()).find(|&i| whose(i) != (object, part)).unwrap_or(receivers.len());
        match prepared.places.get(object) {
            Some(_) => shade_part::<N>(prepared, receivers, first..end, (object, part), &mut out),
            None => (first..end).for_each(|i| out.set(i, Vec3::ZERO)),
        }
        first = end;
    }
}

/// Shades receivers of one part of an object.
fn shade_part<const N: usize>(
    prepared: &Prepared,
    receivers: Receivers<'_>,
    range: Range<usize>,
    (object, part): (usize, usize),
    out: &mut RadianceMut<'_>,
) {
    for start in range.clone().step_by(LANES) {
        let lanes = (range.end - start).min(LANES);
        let lane = |k: usize| start + k.min(lanes - 1);
        let positions: [[f32; 3]; LANES] =
            std::array::from_fn(|k| prepared.point(receivers.position_at(lane(k)).as_dvec3()));
        let position: [f32x8; 3] = std::array::from_fn(|axis| f32x8::from(positions.map(|p| p[axis])));
        let mut unit = own::<N>(prepared, object, receivers, &position, lane);
        let mut radiance = [f32x8::ZERO; 3];
        for entity in &prepared.orders[object][part] {
            match *entity {
                Entity::Object(other) => {
                    let Some(field) = &prepared.entities[other].field else { continue };
                    let visible = occlusion::<N>(field, &prepared.places[other], &position);
                    unit = kernel::product(&visible, &unit);
                }
                Entity::Light(number) => {
                    let light = &prepared.lights[number];
                    let reached = reached::<N>(prepared, light, &position, &unit);
                    (0..3).for_each(|c| radiance[c] += reached * f32x8::splat(light.radiance[c]));
                }
            }
        }
        for (values, weights) in unit.iter().zip(&prepared.light) {
            (0..3).for_each(|c| radiance[c] = values.mul_add(f32x8::splat(weights[c]), radiance[c]));
        }
        for k in 0..lanes {
            let white = Vec3::from(radiance.each_ref().map(|channel| channel.as_array()[k]));
            out.set(start + k, receivers.albedo_at(start + k) * white);
        }
    }
}

/// U of eight receivers, from their vertices, in light space.
fn own<const N: usize>(
    prepared: &Prepared,
    object: usize,
    receivers: Receivers<'_>,
    position: &[f32x8; 3],
    lane: impl Fn(usize) -> usize,
) -> ShBatch<N> {
    let (entity, place) = (&prepared.entities[object], &prepared.places[object]);
    let (middle, radius) = entity.field.as_ref().map_or((Vec3::ZERO, 0.0), |field| (field.center, 5.0 * field.spacing));
    let mut local = [[0.0_f32; LANES]; N];
    let mut known = [0.0_f32; LANES];
    let points = in_object(place, position).map(f32x8::to_array);
    for k in 0..LANES {
        let in_object = Vec3::from(points.map(|axis| axis[k])) + middle;
        let guess = receivers.index[lane(k)].checked_sub(prepared.first_vertices[object]).map(|v| v as usize);
        if let Some((vector, is_vertex)) = entity.own.at(guess, in_object, SAME_PLACE * radius) {
            local.iter_mut().zip(vector).for_each(|(row, &value)| row[k] = value);
            known[k] = f32::from(is_vertex || entity.own.kind == Kind::Visibility);
        }
    }
    let vector = turned(&local.map(f32x8::from), &place.rotation);
    let normals: [Vec3; LANES] =
        std::array::from_fn(|k| (prepared.light_from_world * receivers.normal_at(lane(k)).as_dvec3()).as_vec3());
    let basis = kernel::basis::<f32x8, N>(std::array::from_fn(|axis| f32x8::from(normals.map(|n| n[axis]))));
    let cosine = kernel::times_bands(&basis, &prepared.cosine);
    let unit = match entity.own.kind {
        Kind::Visibility => kernel::product(&vector, &cosine),
        Kind::Transfer => vector,
    };
    let known = f32x8::from(known).simd_gt(f32x8::ZERO);
    std::array::from_fn(|i| known.select(unit[i], cosine[i]))
}

/// Eight points of light space relative to the object's field, in the object's space.
#[inline(always)]
fn in_object(place: &Place, position: &[f32x8; 3]) -> [f32x8; 3] {
    let offset: [f32x8; 3] = std::array::from_fn(|axis| position[axis] - f32x8::splat(place.field_center[axis]));
    place.object_from_light.map(|row| {
        let [a, b, c] = row.map(f32x8::splat);
        a.mul_add(offset[0], b.mul_add(offset[1], c * offset[2])) * f32x8::splat(place.inverse_scale)
    })
}

/// What an object leaves visible of eight places, in light space.
#[inline(never)]
fn occlusion<const N: usize>(field: &Field, place: &Place, position: &[f32x8; 3]) -> ShBatch<N> {
    let [x, y, z] = in_object(place, position);
    let distance = (x * x + y * y + z * z).sqrt();
    let cosine = y / distance.fast_max(f32x8::splat(f32::MIN_POSITIVE));
    let polar = cosine.fast_max(-f32x8::ONE).fast_min(f32x8::ONE).acos();
    let (v, u) = (polar * f32x8::splat(FRAC_1_PI), z.atan2(x) * f32x8::splat(1.0 / TAU));
    let shell = distance * f32x8::splat(1.0 / field.spacing);
    let (shell, u, v) = (shell.to_array(), u.to_array(), v.to_array());
    let mut local = [[0.0_f32; LANES]; N];
    let mut visibility = [0.0; MOST];
    for k in 0..LANES {
        field.at(shell[k], u[k], v[k], &mut visibility);
        local.iter_mut().zip(&visibility).for_each(|(row, &value)| row[k] = value);
    }
    turned(&local.map(f32x8::from), &place.rotation)
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

/// `S_j · U` of a light of radiance 1: its cap, dotted.
fn reached<const N: usize>(prepared: &Prepared, light: &LocalLight, position: &[f32x8; 3], unit: &ShBatch<N>) -> f32x8 {
    let offset: [f32x8; 3] = std::array::from_fn(|axis| f32x8::splat(light.center[axis]) - position[axis]);
    let squared = offset[0].mul_add(offset[0], offset[1].mul_add(offset[1], offset[2] * offset[2]));
    let squared = squared.fast_max(f32x8::splat(f32::MIN_POSITIVE));
    let inverse = f32x8::ONE / squared.sqrt();
    let direction = offset.map(|axis| axis * inverse);
    // Within the light it is everywhere it can be: the table ends at a right angle.
    let sine_squared = (f32x8::splat(light.radius * light.radius) / squared).fast_min(f32x8::ONE);
    let scale = prepared.table.lookup::<N>(sine_squared);
    let mut minus_cap = [f32x8::ZERO; N];
    kernel::accumulate_lobe(direction, &scale, &mut minus_cap);
    -kernel::dot(&minus_cap, unit)
}
