//! Shading as in [Tamura2006, figure 3], one receiver after another, over the texels of a cube.

use super::{
    HaarFields, Product,
    light::Cap,
    sparse::{forward, inverse},
    sum::Sum,
};
use crate::shadow_field::{
    arrangement::{Entity, LocalLight},
    baking::Source,
    traced::{self, Point},
};
use glam::Vec3;
use halfshade_scene::{Lobes, RadianceMut, Receivers, lobe::MAX_LOBES};
use halfshade_sh::haar::{product::product, transform};
use std::{f32::consts::FRAC_1_PI, ops::Range};
use wide::f32x8;

/// Shades all receivers, part by part of their objects: each has its order of entities.
pub(super) fn shade(fields: &HaarFields, receivers: Receivers<'_>, mut out: RadianceMut<'_>) {
    let count = fields.basis.cube.len();
    let mut scratch = Scratch {
        unit: vec![0.0; count],
        blocked: Sum::new(fields.basis.cube),
        visible: vec![0.0; fields.basis.cube.face_len()],
        product: vec![0.0; fields.basis.cube.face_len()],
        texels: vec![0.0; count],
        gloss: std::array::from_fn(|_| vec![0.0; count]),
    };
    fields.arrangement.each_part(receivers, |range, part| match part {
        Some(part) => scratch.shade_part(fields, receivers, range, part, &mut out),
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
}

impl Scratch {
    fn shade_part(
        &mut self,
        fields: &HaarFields,
        receivers: Receivers<'_>,
        range: Range<usize>,
        (object, part): (usize, usize),
        out: &mut RadianceMut<'_>,
    ) {
        let arrangement = &fields.arrangement;
        for i in range {
            let position = arrangement.point(receivers.position_at(i).as_dvec3());
            let lanes = position.map(f32x8::splat);
            let normal = arrangement.direction(receivers.normal_at(i));
            let lobes = arrangement.eye_lobes.as_ref().map_or(Lobes::NONE, |lobes| lobes.at(&receivers, i));
            let is_glossy = !lobes.is_empty();
            if is_glossy {
                self.set_gloss(fields, normal, receivers.albedo_at(i), &lobes);
            }
            self.set_unit(fields, normal, is_glossy);
            let local = arrangement.places[object].point_in_object(position);
            if let Some(between) = arrangement.vertex(object, receivers.index[i], local) {
                let own = &fields.known[object].own;
                between.parts().for_each(|(vertex, weight)| own.add(vertex, weight, &mut self.blocked));
                self.hide(fields, object);
            }
            let mut radiance = Vec3::ZERO;
            let order = arrangement.order(object, part);
            let point = Point { object, position, normal };
            for (number, entity) in order.iter().enumerate() {
                match *entity {
                    Entity::Object(_) if fields.source == Source::Together => {}
                    Entity::Object(other) => {
                        let (known, place) = (&fields.known[other], &arrangement.places[other]);
                        if let Some(field) = &known.field {
                            field.add_at(place.on_shells(&lanes), std::slice::from_mut(&mut self.blocked));
                        } else if let Some(traced) = &known.traced {
                            self.blocked.add(&traced.blocked_from(&fields.basis, place.point_in_object(position)));
                        }
                        self.hide(fields, other);
                    }
                    Entity::Light(light) => {
                        if fields.source == Source::Together {
                            self.set_together(fields, point, &order[..number], is_glossy);
                        }
                        let light = &arrangement.lights[light];
                        radiance += self.reached(fields, light, position, is_glossy) * Vec3::from(light.radiance);
                    }
                }
            }
            if fields.source == Source::Together {
                self.set_together(fields, point, order, is_glossy);
            }
            let Self { unit, texels, gloss, .. } = self;
            let texels = as_texels(fields, unit, texels);
            radiance += Vec3::from(std::array::from_fn(|channel| match is_glossy {
                false => dot(texels, &fields.light[channel]),
                true => dot_three(texels, &gloss[channel], &fields.light[channel]),
            }));
            out.set(i, if is_glossy { radiance } else { receivers.albedo_at(i) * radiance });
        }
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
    fn set_together(&mut self, fields: &HaarFields, point: Point, nearer: &[Entity], is_glossy: bool) {
        let reached =
            traced::reached(&fields.arrangement, |object| fields.known[object].traced.as_ref(), point, nearer);
        for (unit, &direction) in self.unit.iter_mut().zip(&fields.basis.directions) {
            let reached = reached(direction);
            *unit = if is_glossy { f32::from(u8::from(reached > 0.0)) } else { reached };
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
            match fields.product {
                // What is hidden lies within [0, 1], though the wavelets that are left may say otherwise.
                Product::Texels => {
                    turn.each(cube, face, &blocked.values, |k, value| unit[k] *= 1.0 - value.clamp(0.0, 1.0));
                }
                Product::Wavelets => {
                    turn.each(cube, face, &blocked.values, |k, value| visible[k] = 1.0 - value);
                    transform::forward(visible);
                    product(unit, visible, result);
                    unit.copy_from_slice(result);
                }
            }
        }
        blocked.clear();
    }

    /// `S_j · U` of a light of radiance 1, by channel where the BRDF differs among them.
    fn reached(&mut self, fields: &HaarFields, light: &LocalLight, position: [f32; 3], is_glossy: bool) -> Vec3 {
        let basis = &fields.basis;
        let offset = Vec3::from(light.center) - Vec3::from(position);
        // Within the light it is everywhere it can be, as far as a right angle.
        let sine = (light.radius / offset.length().max(f32::MIN_POSITIVE)).min(1.0);
        let cap = Cap::new(basis, offset.normalize_or(Vec3::Y), sine.asin());
        let Self { unit, texels, gloss, .. } = self;
        let (mut sum, mut covered) = (Vec3::ZERO, 0.0);
        for (texel, unit) in as_texels(fields, unit, texels).iter().enumerate() {
            let weight = cap.coverage(basis, texel) * basis.solid_angles[texel];
            if weight > 0.0 {
                let gloss = Vec3::from(gloss.each_ref().map(|channel| channel[texel]));
                sum += weight * unit * if is_glossy { gloss } else { Vec3::ONE };
                covered += weight;
            }
        }
        if covered > 0.0 { sum * (cap.solid_angle() / covered) } else { Vec3::ZERO }
    }
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
