//! Glossy reflectance: each lobe is looked along in directions of its own, and sees lamps wherever they are narrower.

use super::batch::{Batch, Receiver};
use crate::{
    mask::kernel::{
        bundle::Bundle,
        lamp::LampView,
        lobe::{LobeView, cosines, horizon, power},
    },
    shared::placed_lamps::Lamp,
};
use glam::Vec3;
use halfshade_scene::Lobe;
use std::f32::consts::TAU;
use wide::f32x8;

impl Batch<'_> {
    /// Radiance toward the eye of the light that isn't a lamp's.
    pub(super) fn gloss_of_rest(&mut self, receiver: &Receiver<'_>) -> Vec3 {
        let Some(gloss) = self.shader.gloss else { return Vec3::ZERO };
        let mut radiance = Vec3::ZERO;
        for lobe in receiver.lobes.iter() {
            let mean = gloss.light.mean(lobe.axis, lobe.exponent);
            if mean == Vec3::ZERO {
                continue;
            }
            let view = self.look_along(lobe, f32::INFINITY, receiver);
            let level = gloss.light.level(lobe.exponent, gloss.spiral.count);
            let (mut seen, mut all) = ([f32x8::ZERO; 3], [f32x8::ZERO; 3]);
            for ((shift, open), sharpness) in self.looks.groups() {
                let light = level.map_or([f32x8::ONE; 3], |level| level.next_to(&view.bundle.directions(shift)));
                let above = horizon(lobe, cosines(&view.bundle, receiver.normal, shift), *sharpness);
                let open = open.fast_max(f32x8::ZERO) * above;
                for channel in 0..3 {
                    all[channel] += light[channel];
                    seen[channel] = open.mul_add(light[channel], seen[channel]);
                }
            }
            let share = |channel: usize| {
                let all: f32 = all[channel].reduce_add();
                if all > 0.0 { (seen[channel].reduce_add() / all).min(1.0) } else { 0.0 }
            };
            radiance += lobe.scale * mean * (TAU * view.versine) * Vec3::from(std::array::from_fn(share));
        }
        radiance
    }

    /// Radiance toward the eye of a lamp's light, which was looked into just now. Lobes that are narrower than the lamp come after
    /// all others.
    pub(super) fn gloss_of_lamp(&mut self, lamp: &Lamp, view: &LampView, receiver: &Receiver<'_>) -> Vec3 {
        let is_narrow = |lobe: &Lobe| 1.0 / (lobe.exponent + 1.0) < view.versine;
        let mut radiance = Vec3::ZERO;
        for lobe in receiver.lobes.iter().filter(|lobe| !is_narrow(lobe)) {
            radiance += lobe.scale * self.lobe_over_lamp(lobe, view, receiver.normal);
        }
        for lobe in receiver.lobes.iter().filter(|lobe| is_narrow(lobe)) {
            radiance += lobe.scale * self.lamp_in_lobe(lobe, view, receiver);
        }
        lamp.radiance * radiance
    }

    /// ∫ of the lobe over what is open of the lamp, by the lamp's directions.
    fn lobe_over_lamp(&self, lobe: &Lobe, view: &LampView, normal: Vec3) -> f32 {
        let spiral = self.shader.spiral;
        let mut sum = f32x8::ZERO;
        for (group, ((shift, open), sharpness)) in self.looks.groups().enumerate() {
            let above = horizon(lobe, cosines(&view.bundle, normal, shift), *sharpness);
            let power = power(lobe.exponent, view.bundle.versines_to(lobe.axis, shift));
            sum = (above * power * spiral.counts(8 * group)).mul_add(open.fast_max(f32x8::ZERO), sum);
        }
        sum.reduce_add() * TAU * view.versine / spiral.count as f32
    }

    /// The same by the lobe's directions.
    fn lamp_in_lobe(&mut self, lobe: &Lobe, lamp: &LampView, receiver: &Receiver<'_>) -> f32 {
        let view = self.look_along(lobe, lamp.bundle.distance, receiver);
        let mut dark = std::mem::take(&mut self.dark);
        dark.clear();
        dark.resize(self.looks.open.len(), f32x8::ONE);
        match lamp.cap() {
            _ if lamp.is_all_around => dark.fill(f32x8::ZERO),
            Some(cap) => view.bundle.close(&mut dark, &self.looks.shifts, &self.looks.sharpness, &cap),
            None => {}
        }
        let mut sum = f32x8::ZERO;
        for (((shift, open), sharpness), dark) in self.looks.groups().zip(&dark) {
            let above = horizon(lobe, cosines(&view.bundle, receiver.normal, shift), *sharpness);
            let lit = f32x8::ONE - dark.fast_max(f32x8::ZERO);
            sum = (above * lit).mul_add(open.fast_max(f32x8::ZERO), sum);
        }
        self.dark = dark;
        sum.reduce_add() * TAU * view.versine / (8 * self.looks.open.len()) as f32
    }

    /// Looks along a lobe; what is as far as `distance` hides nothing.
    fn look_along(&mut self, lobe: &Lobe, distance: f32, receiver: &Receiver<'_>) -> LobeView {
        let shader = self.shader;
        let spiral = shader.gloss.map(|gloss| &gloss.spiral);
        let (logs, turn): (&[f32x8], &[[f32x8; 2]]) = spiral.map_or((&[], &[]), |spiral| (&spiral.logs, &spiral.turn));
        let view = LobeView::new(lobe, distance, shader.edge, 8 * logs.len());
        let bundle: Bundle = view.bundle;
        let shift = |group: usize, least: f32| view.shift(least, logs[group], turn[group]);
        self.look(&bundle, receiver, logs.len(), shift, |group| view.sharpness(logs[group]));
        view
    }
}
