//! Shading as in [Tamura2006, figure 3], one receiver after another, over the texels of a cube.

use super::{
    fields::HaarFields,
    light::Cap,
    projection::HaarBasis,
    sparse::{forward, inverse},
    sum::Sum,
};
use crate::shadow_field::{
    arrangement::{LightSeen, LocalLight},
    baking::Source,
    settings::Product,
    traced::{self, Point},
};
use glam::Vec3;
use halfshade_scene::{Lobes, RadianceMut, Receivers, SurfacePoint, lobe::MAX_LOBES};
use halfshade_sh::haar::{product::product, transform};
use std::{f32::consts::FRAC_1_PI, ops::Range};
use wide::f32x8;

/// Shades all receivers, object by object.
pub(super) fn shade(fields: &HaarFields, receivers: Receivers<'_>, mut out: RadianceMut<'_>) {
    let count = fields.basis.cube.len();
    let mut scratch = Scratch {
        unit: vec![0.0; count],
        blocked: Sum::new(fields.basis.cube),
        visible: vec![0.0; fields.basis.cube.face_len()],
        product: vec![0.0; fields.basis.cube.face_len()],
        texels: vec![0.0; count],
        gloss: std::array::from_fn(|_| vec![0.0; count]),
        order: Order::default(),
    };
    fields.arrangement.each_object(receivers, |range, object| match object {
        Some(object) => scratch.shade_object(fields, receivers, range, object, &mut out),
        None => range.for_each(|i| out.set(i, Vec3::ZERO)),
    });
}

/// What one receiver after another is worked out in.
struct Scratch {
    /// U: texels, or wavelets if those are multiplied.
    unit: Vec<f32>,
    /// What one object hides.
    blocked: Sum,
    /// One face of what is visible, and of a product.
    visible: Vec<f32>,
    product: Vec<f32>,
    /// Texels of U, where it is wavelets.
    texels: Vec<f32>,
    /// What a glossy receiver reflects: red, green, blue.
    gloss: [Vec<f32>; 3],
    order: Order,
}

/// Objects and lights as one receiver sees them.
#[derive(Debug, Default)]
struct Order {
    /// All others, from near to far, by squared distance.
    objects: Vec<(f32, usize)>,
    /// What is before each light.
    lights: Vec<Behind>,
}

/// What is before a light, of objects from near to far.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
enum Behind {
    /// The first so many.
    First(usize),
    /// Others too, as where the light is all around.
    Others,
}

impl Order {
    fn set(&mut self, fields: &HaarFields, receiver: &Receiver) {
        let Self { objects, lights } = self;
        let arrangement = &fields.arrangement;
        let distance = |&other: &usize| (arrangement.distance_squared(other, &receiver.position).as_array()[0], other);
        objects.clear();
        objects.extend(arrangement.order(receiver.point.object).iter().map(distance));
        objects.sort_unstable_by(|a, b| a.0.total_cmp(&b.0).then(a.1.cmp(&b.1)));
        lights.clear();
        lights.extend((0..arrangement.lights.len()).map(|light| {
            let seen = arrangement.see(light, &receiver.position);
            let is_before = |&(_, other): &(f32, usize)| is_before(fields, other, light, &seen, receiver);
            let first = objects.iter().take_while(|object| is_before(object)).count();
            if objects[first..].iter().any(is_before) { Behind::Others } else { Behind::First(first) }
        }));
    }

    /// The lights that have so much before them.
    fn behind(&self, what: Behind) -> impl Iterator<Item = usize> {
        (0..self.lights.len()).filter(move |&light| self.lights[light] == what)
    }
}

/// Where one receiver is and what it does.
struct Receiver {
    point: Point,
    position: [f32x8; 3],
    surface: SurfacePoint,
    is_glossy: bool,
}

impl Scratch {
    fn shade_object(
        &mut self,
        fields: &HaarFields,
        receivers: Receivers<'_>,
        range: Range<usize>,
        object: usize,
        out: &mut RadianceMut<'_>,
    ) {
        let arrangement = &fields.arrangement;
        for i in range {
            let place = arrangement.point(receivers.position_at(i).as_dvec3());
            let normal = arrangement.direction(receivers.normal_at(i));
            let lobes = arrangement.eye_lobes.as_ref().map_or(Lobes::NONE, |lobes| lobes.at(&receivers, i));
            let receiver = Receiver {
                point: Point { object, position: place, normal },
                position: place.map(f32x8::splat),
                surface: receivers.surface[i],
                is_glossy: !lobes.is_empty(),
            };
            if receiver.is_glossy {
                self.set_gloss(fields, normal, receivers.albedo_at(i), &lobes);
            }
            let radiance = match fields.source {
                Source::Together => self.radiance_together(fields, &receiver),
                Source::Fields | Source::Traced => self.radiance(fields, &receiver),
            };
            out.set(i, if receiver.is_glossy { radiance } else { receivers.albedo_at(i) * radiance });
        }
    }

    /// What reaches a receiver, object after object; times what it reflects if that is glossy.
    fn radiance(&mut self, fields: &HaarFields, receiver: &Receiver) -> Vec3 {
        let arrangement = &fields.arrangement;
        let mut order = std::mem::take(&mut self.order);
        order.set(fields, receiver);
        let mut radiance = Vec3::ZERO;
        self.start(fields, receiver);
        for step in 0..=order.objects.len() {
            radiance +=
                order.behind(Behind::First(step)).map(|light| self.reached(fields, light, receiver)).sum::<Vec3>();
            if let Some(&(_, other)) = order.objects.get(step) {
                self.hide_behind(fields, other, receiver);
            }
        }
        radiance += self.reached_from_far(fields, receiver);
        for light in order.behind(Behind::Others) {
            let seen = arrangement.see(light, &receiver.position);
            self.start(fields, receiver);
            for &(_, other) in &order.objects {
                if is_before(fields, other, light, &seen, receiver) {
                    self.hide_behind(fields, other, receiver);
                }
            }
            radiance += self.reached(fields, light, receiver);
        }
        self.order = order;
        radiance
    }

    /// The same, with all that hides at once.
    fn radiance_together(&mut self, fields: &HaarFields, receiver: &Receiver) -> Vec3 {
        let arrangement = &fields.arrangement;
        let mut radiance = Vec3::ZERO;
        let others = || arrangement.order(receiver.point.object).iter().copied();
        for light in 0..arrangement.lights.len() {
            let seen = arrangement.see(light, &receiver.position);
            self.set_together(
                fields,
                receiver,
                others().filter(|&other| is_before(fields, other, light, &seen, receiver)),
            );
            radiance += self.reached(fields, light, receiver);
        }
        self.set_together(fields, receiver, others());
        radiance + self.reached_from_far(fields, receiver)
    }

    /// U of a receiver that only its own object hides from.
    fn start(&mut self, fields: &HaarFields, receiver: &Receiver) {
        let Point { object, normal, .. } = receiver.point;
        self.set_unit(fields, normal, receiver.is_glossy);
        let (_, mesh) = fields.arrangement.object(object);
        if let Some(between) = receiver.surface.weights_in_front(mesh) {
            let own = &fields.known[object].own;
            between.parts().for_each(|(vertex, weight)| own.add(vertex, weight, &mut self.blocked));
            self.hide(fields, object);
        }
    }

    /// Takes away what another object hides.
    fn hide_behind(&mut self, fields: &HaarFields, other: usize, receiver: &Receiver) {
        let (known, place) = (&fields.known[other], &fields.arrangement.places[other]);
        if let Some(field) = &known.field {
            field.add_at(place.on_shells(&receiver.position), std::slice::from_mut(&mut self.blocked));
        } else if let Some(traced) = &known.traced {
            self.blocked.add(&traced.blocked_from(&fields.basis, place.point_in_object(receiver.point.position)));
        }
        self.hide(fields, other);
    }

    /// `S_d · U`, by channel where the BRDF differs among them.
    fn reached_from_far(&mut self, fields: &HaarFields, receiver: &Receiver) -> Vec3 {
        let Self { unit, texels, gloss, .. } = self;
        let texels = as_texels(fields, unit, texels);
        Vec3::from(std::array::from_fn(|channel| match receiver.is_glossy {
            false => dot(texels, &fields.light[channel]),
            true => dot_three(texels, &gloss[channel], &fields.light[channel]),
        }))
    }

    /// U = ρ̂: the clamped cosine over π; 1 for a glossy receiver, whose BRDF waits in `gloss`.
    fn set_unit(&mut self, fields: &HaarFields, normal: Vec3, is_glossy: bool) {
        if is_glossy {
            self.unit.fill(1.0);
        } else {
            let [x, y, z] = &fields.directions;
            for (((unit, x), y), z) in self.unit.iter_mut().zip(x).zip(y).zip(z) {
                *unit = FRAC_1_PI * (x * normal.x + y * normal.y + z * normal.z).max(0.0);
            }
        }
        self.enter_basis(fields);
    }

    /// U as wavelets, if those are multiplied.
    fn enter_basis(&mut self, fields: &HaarFields) {
        if fields.product == Product::Wavelets {
            forward(fields.basis.cube, &mut self.unit);
        }
    }

    /// All that a receiver reflects, the diffuse part too, by texel and channel.
    ///
    /// A lobe that is narrower than texels is made as wide as they are, and keeps its integral.
    fn set_gloss(&mut self, fields: &HaarFields, normal: Vec3, albedo: Vec3, lobes: &Lobes) {
        let sharpest = SHARPEST * (fields.basis.cube.side() as f32).powi(2);
        let axes: [Vec3; MAX_LOBES] =
            std::array::from_fn(|i| lobes.get(i).map_or(Vec3::Y, |lobe| fields.arrangement.direction(lobe.axis)));
        let [red, green, blue] = &mut self.gloss;
        for (((direction, red), green), blue) in fields.basis.directions.iter().zip(red).zip(green).zip(blue) {
            let cosine = direction.dot(normal);
            let mut sum = Vec3::ZERO;
            if cosine > 0.0 {
                sum = FRAC_1_PI * cosine * albedo;
                for (lobe, axis) in lobes.iter().zip(axes) {
                    let exponent = lobe.exponent.min(sharpest);
                    let kept = (exponent + 1.0) / (lobe.exponent + 1.0);
                    let along = direction.dot(axis).clamp(0.0, 1.0);
                    let foreshortened = if lobe.times_cosine { cosine } else { 1.0 };
                    sum += kept * foreshortened * power(along, exponent) * lobe.scale;
                }
            }
            (*red, *green, *blue) = sum.into();
        }
    }

    /// U = V ρ̂ with all that hides at once; V alone for a glossy receiver.
    fn set_together(&mut self, fields: &HaarFields, receiver: &Receiver, nearer: impl Iterator<Item = usize>) {
        let traced = |object: usize| fields.known[object].traced.as_ref();
        let reached = traced::reached(&fields.arrangement, traced, receiver.point, nearer);
        for (unit, &direction) in self.unit.iter_mut().zip(&fields.basis.directions) {
            let reached = reached(direction);
            *unit = if receiver.is_glossy { f32::from(u8::from(reached > 0.0)) } else { reached };
        }
        self.enter_basis(fields);
    }

    /// U = (1 - B) U with the wavelets B in `blocked`, which are then cleared.
    fn hide(&mut self, fields: &HaarFields, object: usize) {
        let (cube, turn) = (fields.basis.cube, &fields.turns[object]);
        let Self { unit, blocked, visible, product: result, .. } = self;
        let faces = blocked.faces;
        for (face, values) in blocked.values.chunks_exact_mut(cube.face_len()).enumerate() {
            if faces & (1 << face) != 0 {
                transform::inverse(values);
            }
        }
        for (face, unit) in unit.chunks_exact_mut(cube.face_len()).enumerate() {
            if !turn.meets(face, faces) {
                continue;
            }
            // What is hidden lies within [0, 1], though the wavelets that are left may say otherwise.
            match fields.product {
                Product::Texels => {
                    turn.each(cube, face, &blocked.values, |k, value| unit[k] *= 1.0 - value.clamp(0.0, 1.0));
                }
                Product::Wavelets => {
                    turn.each(cube, face, &blocked.values, |k, value| visible[k] = 1.0 - value.clamp(0.0, 1.0));
                    transform::forward(visible);
                    product(unit, visible, result);
                    unit.copy_from_slice(result);
                }
            }
        }
        blocked.clear();
    }

    /// `S_j · U` of a light, by channel where the BRDF differs among them.
    fn reached(&mut self, fields: &HaarFields, light: usize, receiver: &Receiver) -> Vec3 {
        let (basis, seen) = (&fields.basis, fields.arrangement.see(light, &receiver.position));
        let light = &fields.arrangement.lights[light];
        let cap = cap(basis, light, &seen);
        let Self { unit, texels, gloss, .. } = self;
        let (mut sum, mut covered) = (Vec3::ZERO, 0.0);
        for (texel, unit) in as_texels(fields, unit, texels).iter().enumerate() {
            let weight = cap.coverage(basis, texel) * basis.solid_angles[texel];
            if weight > 0.0 {
                let gloss = Vec3::from(gloss.each_ref().map(|channel| channel[texel]));
                sum += weight * unit * if receiver.is_glossy { gloss } else { Vec3::ONE };
                covered += weight;
            }
        }
        if covered > 0.0 { sum * (cap.solid_angle() / covered) * Vec3::from(light.radiance) } else { Vec3::ZERO }
    }
}

/// The cap that a light is, or all directions from within it.
fn cap(basis: &HaarBasis, light: &LocalLight, seen: &LightSeen) -> Cap {
    if seen.is_around.as_array()[0].to_bits() != 0 {
        return Cap::ALL;
    }
    let offset = Vec3::from(seen.offset.each_ref().map(|axis| axis.as_array()[0]));
    let sine = (light.radius / offset.length().max(f32::MIN_POSITIVE)).min(1.0);
    Cap::new(basis, offset.normalize_or(Vec3::Y), sine.asin())
}

/// Whether an object is before a light.
fn is_before(fields: &HaarFields, object: usize, light: usize, seen: &LightSeen, receiver: &Receiver) -> bool {
    fields.arrangement.is_before(object, light, seen, &receiver.position).to_bitmask() & 1 != 0
}

/// U as texels, in `texels` if it is wavelets.
fn as_texels<'a>(fields: &HaarFields, unit: &'a [f32], texels: &'a mut [f32]) -> &'a [f32] {
    match fields.product {
        Product::Texels => unit,
        Product::Wavelets => {
            texels.copy_from_slice(unit);
            inverse(fields.basis.cube, texels);
            texels
        }
    }
}

/// Highest exponent over the square of texels along an edge: half of such a lobe lies within a texel of its axis.
const SHARPEST: f32 = 0.35;

/// `cosine^exponent`, 1 if the exponent is 0 and the cosine isn't.
fn power(cosine: f32, exponent: f32) -> f32 {
    if cosine > 0.0 { cosine.powf(exponent) } else { 0.0 }
}

/// `Σ a b c`.
fn dot_three(a: &[f32], b: &[f32], c: &[f32]) -> f32 {
    a.iter().zip(b).zip(c).map(|((a, b), c)| a * b * c).sum()
}

/// The dot product, eight sums side by side.
fn dot(a: &[f32], b: &[f32]) -> f32 {
    let mut sums = [0.0_f32; 8];
    let (a_rows, b_rows) = (a.chunks_exact(8), b.chunks_exact(8));
    let rest: f32 = a_rows.remainder().iter().zip(b_rows.remainder()).map(|(a, b)| a * b).sum();
    for (a, b) in a_rows.zip(b_rows) {
        for ((sum, a), b) in sums.iter_mut().zip(a).zip(b) {
            *sum = a.mul_add(*b, *sum);
        }
    }
    sums.iter().sum::<f32>() + rest
}
