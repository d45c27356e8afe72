//! Transfer U of one receiver over the texels of a cube: what starts it, hides of it, and reaches the receiver through it.

use super::receiver::Receiver;
use crate::shadow_field::{
    bake::haar::sum::Sum,
    kernel::{
        cube_cap::CubeCap,
        light_order::LightSeen,
        texels::{clamped_cosine, dot, dot_three, forward, hide_texels, hide_wavelets, inverse},
    },
    prepare::{
        frame::{FrameData, LocalLight},
        haar::HaarPrepared,
    },
    settings::Product,
    shade::traced::transfer,
};
use glam::Vec3;
use halfshade_scene::{Lobes, lobe::MAX_LOBES};
use halfshade_sh::haar::transform;
use std::f32::consts::FRAC_1_PI;

/// Highest exponent over the square of texels along an edge: half of such a lobe lies within a texel of its axis.
const SHARPEST: f32 = 0.35;

/// Working memory of one receiver after another.
pub(crate) struct Transfer<'a> {
    prepared: &'a HaarPrepared<'a>,
    /// U: texels, or wavelets if those are multiplied.
    values: Vec<f32>,
    /// Occlusion by one object.
    blocked: Sum,
    /// One face of what is visible, and of a product.
    visible: Vec<f32>,
    product: Vec<f32>,
    /// Texels of U, where it is wavelets.
    texels: Vec<f32>,
    /// The BRDF of a glossy receiver: red, green, blue.
    gloss: [Vec<f32>; 3],
}

impl<'a> Transfer<'a> {
    pub(crate) fn new(prepared: &'a HaarPrepared<'a>) -> Self {
        let cube = prepared.fields.basis.cube;
        let count = cube.len();
        Self {
            prepared,
            values: vec![0.0; count],
            blocked: Sum::new(cube),
            visible: vec![0.0; cube.face_len()],
            product: vec![0.0; cube.face_len()],
            texels: vec![0.0; count],
            gloss: std::array::from_fn(|_| vec![0.0; count]),
        }
    }

    fn frame(&self) -> &'a FrameData {
        &self.prepared.frame.data
    }

    /// U of a receiver that only its own object hides from.
    pub(crate) fn start(&mut self, receiver: &Receiver) {
        self.set_unblocked(receiver);
        let object = &self.prepared.fields.objects[receiver.place.object];
        if let Some(between) = receiver.surface.weights_in_front(&object.mesh) {
            let own = &object.occlusion.own;
            between.parts().for_each(|(vertex, weight)| own.add(vertex, weight, &mut self.blocked));
            self.hide(receiver.place.object);
        }
    }

    /// Takes away what another object hides.
    pub(crate) fn hide_behind(&mut self, other: usize, receiver: &Receiver) {
        let fields = self.prepared.fields;
        let (occlusion, placement) = (&fields.objects[other].occlusion, &self.frame().objects[other]);
        if let Some(field) = &occlusion.field {
            field.add_at(placement.on_shells(&receiver.position), std::slice::from_mut(&mut self.blocked));
        } else if let Some(traced) = &occlusion.traced {
            let point = placement.point_in_object(receiver.place.position);
            self.blocked.add(&traced.blocked_from(&fields.basis, point));
        }
        self.hide(other);
    }

    /// U = V ρ̂ with all that hides at once; V alone for a glossy receiver.
    pub(crate) fn set_traced(&mut self, receiver: &Receiver, nearer: impl Iterator<Item = usize>) {
        let fields = self.prepared.fields;
        let traced = |object: usize| fields.objects[object].occlusion.traced.as_ref();
        let transfer = transfer(self.frame(), traced, receiver.place, nearer);
        for (value, &direction) in self.values.iter_mut().zip(&fields.basis.directions) {
            let transfer = transfer(direction);
            *value = if receiver.is_glossy { f32::from(u8::from(transfer > 0.0)) } else { transfer };
        }
        self.enter_basis();
    }

    /// U = ρ̂: the clamped cosine over π; 1 for a glossy receiver, whose BRDF waits in `gloss`.
    fn set_unblocked(&mut self, receiver: &Receiver) {
        if receiver.is_glossy {
            self.values.fill(1.0);
        } else {
            let directions = self.prepared.fields.directions.each_ref().map(Vec::as_slice);
            clamped_cosine(directions, receiver.place.normal, &mut self.values);
        }
        self.enter_basis();
    }

    /// U as wavelets, if those are multiplied.
    fn enter_basis(&mut self) {
        let fields = self.prepared.fields;
        if fields.product == Product::Wavelets {
            forward(fields.basis.cube.face_len(), &mut self.values);
        }
    }

    /// U = (1 - B) U with the wavelets B in `blocked`, which are then cleared.
    fn hide(&mut self, object: usize) {
        let fields = self.prepared.fields;
        let (face_len, map) = (fields.basis.cube.face_len(), &self.prepared.frame.texel_maps[object]);
        let Self { values, blocked, visible, product, .. } = self;
        let faces = blocked.faces;
        for (face, values) in blocked.values.chunks_exact_mut(face_len).enumerate() {
            if faces & (1 << face) != 0 {
                transform::inverse(values);
            }
        }
        for (face, values) in values.chunks_exact_mut(face_len).enumerate() {
            if !map.meets(face, faces) {
                continue;
            }
            let first = face * face_len;
            match fields.product {
                Product::Texels => hide_texels(values, first, &blocked.values, map.sources()),
                Product::Wavelets => {
                    hide_wavelets(values, first, &blocked.values, map.sources(), [visible, product]);
                }
            }
        }
        blocked.clear();
    }

    /// The BRDF of a receiver by texel and channel, the diffuse part too.
    ///
    /// A lobe that is narrower than texels is made as wide as they are, and keeps its integral.
    pub(crate) fn set_gloss(&mut self, normal: Vec3, albedo: Vec3, lobes: &Lobes) {
        let (fields, frame) = (self.prepared.fields, self.frame());
        let sharpest = SHARPEST * (fields.basis.cube.side() as f32).powi(2);
        let axes: [Vec3; MAX_LOBES] =
            std::array::from_fn(|i| lobes.get(i).map_or(Vec3::Y, |lobe| frame.direction(lobe.axis)));
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

    /// `S_d · U`, by channel where the BRDF differs among them.
    pub(crate) fn distant(&mut self, receiver: &Receiver) -> Vec3 {
        let light = &self.prepared.frame.light.texels;
        let (texels, gloss) = self.texels_and_gloss();
        Vec3::from(std::array::from_fn(|channel| match receiver.is_glossy {
            false => dot(texels, &light[channel]),
            true => dot_three(texels, &gloss[channel], &light[channel]),
        }))
    }

    /// `S_j · U` of a light, by channel where the BRDF differs among them.
    pub(crate) fn local(&mut self, light: usize, receiver: &Receiver) -> Vec3 {
        let (basis, frame) = (&self.prepared.fields.basis, self.frame());
        let seen = frame.see(light, &receiver.position);
        let light = &frame.lights[light];
        let cap = light_cap(basis.cube.side(), light, &seen);
        let (texels, gloss) = self.texels_and_gloss();
        let (mut sum, mut covered) = (Vec3::ZERO, 0.0);
        for (texel, value) in texels.iter().enumerate() {
            let weight = cap.coverage(basis.directions[texel]) * basis.solid_angles[texel];
            if weight > 0.0 {
                let gloss = Vec3::from(gloss.each_ref().map(|channel| channel[texel]));
                sum += weight * value * if receiver.is_glossy { gloss } else { Vec3::ONE };
                covered += weight;
            }
        }
        if covered > 0.0 { sum * (cap.solid_angle() / covered) * Vec3::from(light.radiance) } else { Vec3::ZERO }
    }

    /// U as texels, and the BRDF.
    fn texels_and_gloss(&mut self) -> (&[f32], &[Vec<f32>; 3]) {
        let fields = self.prepared.fields;
        let texels = match fields.product {
            Product::Texels => &self.values,
            Product::Wavelets => {
                self.texels.copy_from_slice(&self.values);
                inverse(fields.basis.cube.face_len(), &mut self.texels);
                &self.texels
            }
        };
        (texels, &self.gloss)
    }
}

/// The cap that a light is, or all directions from within it.
fn light_cap(side: usize, light: &LocalLight, seen: &LightSeen) -> CubeCap {
    if seen.is_around.as_array()[0].to_bits() != 0 {
        return CubeCap::ALL;
    }
    let offset = Vec3::from(seen.offset.each_ref().map(|axis| axis.as_array()[0]));
    let sine = (light.radius / offset.length().max(f32::MIN_POSITIVE)).min(1.0);
    CubeCap::new(side, offset.normalize_or(Vec3::Y), sine.asin())
}

/// `cosine^exponent`, 1 if the exponent is 0 and the cosine isn't.
fn power(cosine: f32, exponent: f32) -> f32 {
    if cosine > 0.0 { cosine.powf(exponent) } else { 0.0 }
}
