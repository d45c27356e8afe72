//! Shading as in [Tamura2006, figure 3], eight receivers side by side, one object after another.

use super::{
    fields::{OwnKind, ShFields},
    gloss::GlossBatch,
    reach::Bound,
    shell::MOST,
};
use crate::shadow_field::{
    arrangement::{LightSeen, LocalLight},
    baking::Source,
    basis::Basis,
    traced::{Point, reached as reached_together},
};
use glam::Vec3;
use halfshade_scene::{RadianceMut, Receivers, lobe::MAX_LOBES};
use halfshade_sh::kernel::{self, FULL, LANES, ShBatch};
use std::ops::Range;
use wide::f32x8;

/// Shades all receivers, object by object: each has its order of the others.
pub(super) fn shade<const N: usize>(fields: &ShFields, receivers: Receivers<'_>, mut out: RadianceMut<'_>) {
    let mut apart = vec![Apart::NOT; fields.arrangement.lights.len()];
    fields.arrangement.each_object(receivers, |range, object| match object {
        Some(object) => shade_object::<N>(fields, receivers, range, object, &mut apart, &mut out),
        None => range.for_each(|i| out.set(i, Vec3::ZERO)),
    });
}

/// U of the diffuse part, and of each glossy lobe.
type Units<const N: usize> = [ShBatch<N>; 1 + MAX_LOBES];

/// What reaches from a light that not all receivers see behind the objects so far.
#[derive(Clone)]
struct Apart<const N: usize> {
    is_apart: bool,
    units: Units<N>,
}

impl<const N: usize> Apart<N> {
    const NOT: Self = Self { is_apart: false, units: [[f32x8::ZERO; N]; 1 + MAX_LOBES] };

    /// Takes what is visible behind an object where that is before the light; until it isn't everywhere, `shared` does.
    fn hide(&mut self, before: f32x8, visible: &ShBatch<N>, bounds: &[Bound<'_, N>], shared: &[ShBatch<N>]) {
        if !self.is_apart {
            if before.all() {
                return;
            }
            self.is_apart = true;
            self.units[..shared.len()].copy_from_slice(shared);
        }
        if before.any() {
            for (unit, bound) in self.units.iter_mut().zip(bounds) {
                let product = bound.times(unit, visible);
                unit.iter_mut().zip(product).for_each(|(unit, product)| *unit = before.select(product, *unit));
            }
        }
    }
}

/// Shades receivers of one object.
fn shade_object<const N: usize>(
    fields: &ShFields,
    receivers: Receivers<'_>,
    range: Range<usize>,
    object: usize,
    apart: &mut [Apart<N>],
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
        let gloss = arrangement
            .eye_lobes
            .as_ref()
            .map(|lobes| GlossBatch::new(fields, lobes, &receivers, lane, (&normal, &cosine)));
        let count = 1 + gloss.as_ref().map_or(0, |gloss| gloss.count);
        let bounds: [Bound<'_, N>; 1 + MAX_LOBES] = std::array::from_fn(|number| match &gloss {
            Some(gloss) if number > 0 => Bound::lobe(&gloss.shapes[number - 1]),
            _ => Bound::diffuse(&cosine),
        });
        let bounds = &bounds[..count];
        let own = own::<N>(fields, object, receivers, lane);
        let mut units: Units<N> = [[f32x8::ZERO; N]; 1 + MAX_LOBES];
        let units = &mut units[..count];
        for (unit, bound) in units.iter_mut().zip(bounds) {
            *unit = match &own {
                Own::Visible(visible) => bound.times(bound.shape(), visible),
                Own::Transfer(transfer, found) => std::array::from_fn(|i| found.select(transfer[i], bound.shape()[i])),
            };
        }
        let seen = |light: usize| arrangement.see(light, &position);
        let order = arrangement.order(object);
        let together = |before: &dyn Fn(usize) -> f32x8| {
            let mut unit = [[0.0_f32; LANES]; N];
            for k in 0..lanes {
                let point = Point { object, position: positions[k], normal: normals[k] };
                let nearer = order.iter().copied().filter(|&other| before(other).to_bitmask() & (1 << k) != 0);
                let traced = |object: usize| fields.known[object].traced.as_ref();
                let vector = fields.basis.project(&reached_together(arrangement, traced, point, nearer));
                unit.iter_mut().zip(vector).for_each(|(row, value)| row[k] = value);
            }
            unit.map(f32x8::from)
        };
        apart.iter_mut().for_each(|apart| apart.is_apart = false);
        if fields.source == Source::Together {
            for (light, apart) in apart.iter_mut().enumerate() {
                let seen = seen(light);
                apart.is_apart = true;
                apart.units[0] = together(&|other| arrangement.is_before(other, light, &seen, &position));
            }
            units[0] = together(&|_| f32x8::ZERO.simd_eq(f32x8::ZERO));
        } else {
            for &other in order {
                let Some(visible) = visible::<N>(fields, other, &position) else { continue };
                for (light, apart) in apart.iter_mut().enumerate() {
                    let before = arrangement.is_before(other, light, &seen(light), &position);
                    apart.hide(before, &visible, bounds, units);
                }
                units.iter_mut().zip(bounds).for_each(|(unit, bound)| *unit = bound.times(unit, &visible));
            }
        }
        let mut radiance = [[f32x8::ZERO; 3]; 1 + MAX_LOBES];
        for ((number, light), apart) in arrangement.lights.iter().enumerate().zip(&*apart) {
            let cap = cap::<N>(fields, light, &seen(number));
            let units = if apart.is_apart { &apart.units } else { &*units };
            for (unit, radiance) in units[..count].iter().zip(&mut radiance) {
                let reached = kernel::dot(&cap, unit);
                (0..3).for_each(|c| radiance[c] += reached * f32x8::splat(light.radiance[c]));
            }
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

/// Interpolated between the vertices that the receivers lie between.
fn own<const N: usize>(
    fields: &ShFields,
    object: usize,
    receivers: Receivers<'_>,
    lane: impl Fn(usize) -> usize,
) -> Own<N> {
    let (known, (_, mesh)) = (&fields.known[object], fields.arrangement.object(object));
    let mut vector = [[0.0_f32; LANES]; N];
    let mut found = [0.0_f32; LANES];
    for k in 0..LANES {
        let Some(between) = receivers.surface[lane(k)].weights_in_front(mesh) else { continue };
        for (vertex, weight) in between.parts() {
            vector.iter_mut().zip(&known.own[vertex * N..]).for_each(|(row, &value)| row[k] += weight * value);
        }
        found[k] = 1.0;
    }
    let vector = turned(&vector.map(f32x8::from), &fields.rotations[object]);
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

/// S_j of a light of radiance 1: its cap, or all around.
fn cap<const N: usize>(fields: &ShFields, light: &LocalLight, seen: &LightSeen) -> ShBatch<N> {
    let squared = seen.distance_squared.fast_max(f32x8::splat(f32::MIN_POSITIVE));
    let inverse = f32x8::ONE / squared.sqrt();
    let direction = seen.offset.map(|axis| axis * inverse);
    let sine_squared = (f32x8::splat(light.radius * light.radius) / squared).fast_min(f32x8::ONE);
    let scale = fields.table.lookup::<N>(sine_squared);
    let mut minus_cap = [f32x8::ZERO; N];
    kernel::accumulate_lobe(direction, &scale, &mut minus_cap);
    std::array::from_fn(|i| {
        let all = if i == 0 { f32x8::splat(FULL) } else { f32x8::ZERO };
        seen.is_around.select(all, -minus_cap[i])
    })
}
