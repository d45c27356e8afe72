//! Eight receivers: their view of all spheres, then receiver by receiver the light that is left.

use super::shader::Shader;
use crate::{
    mask::kernel::{
        boxes::BoxView,
        cap::{Cap8, Receivers8},
        directions::{BLOCK, DirectionSet, Sums, close},
        lamp::LampView,
        own::OwnView,
    },
    shared::placed_lamps::{Lamp, LampPlace},
};
use glam::Vec3;
use halfshade_scene::{RadianceMut, Receivers};
use std::{f32::consts::PI, ops::Range};
use wide::f32x8;

/// Memory that batches share.
pub(super) struct Batch<'a> {
    shader: &'a Shader<'a>,
    /// The view of each sphere that any of the eight sees.
    caps: Vec<Cap8>,
    /// Boxes that the receiver at hand may see.
    boxes: Vec<BoxView<'a>>,
    /// Directions of the lamp at hand less its middle, and what is open of them.
    shifts: Vec<[f32x8; 3]>,
    open: Vec<f32x8>,
}

/// One of the eight.
struct Receiver<'a> {
    position: Vec3,
    normal: Vec3,
    lane: usize,
    own: Option<OwnView<'a>>,
    set: &'a DirectionSet,
}

impl<'a> Batch<'a> {
    pub(super) fn new(shader: &'a Shader<'a>) -> Self {
        Self {
            shader,
            caps: Vec::with_capacity(shader.frame.spheres.len()),
            boxes: Vec::with_capacity(shader.frame.boxes.len()),
            shifts: Vec::with_capacity(shader.spiral.within.len()),
            open: Vec::with_capacity(shader.spiral.within.len()),
        }
    }

    /// Shades at most eight receivers. What one gets depends on itself alone.
    pub(super) fn shade(&mut self, receivers: Receivers<'_>, range: Range<usize>, out: &mut RadianceMut<'_>) {
        let shader = self.shader;
        let space = &shader.frame.space;
        // The last of fewer than eight fills up the rest.
        let eight: [Receiver<'a>; 8] = std::array::from_fn(|lane| {
            let i = (range.start + lane).min(range.end - 1);
            let normal = space.direction(receivers.normal_at(i));
            Receiver {
                position: space.point(receivers.position_at(i).as_dvec3()),
                normal,
                lane,
                own: shader.own_view(&receivers, i),
                set: &shader.sets.sets[shader.sets.number(normal)],
            }
        });
        let objects: [u32; 8] = std::array::from_fn(|lane| receivers.object[(range.start + lane).min(range.end - 1)]);
        self.see(&eight, &objects);
        for (i, receiver) in range.zip(&eight) {
            self.boxes.clear();
            let others = shader.frame.boxes.iter().filter(|placed| placed.object != objects[receiver.lane]);
            self.boxes.extend(others.map(|placed| BoxView::new(placed, receiver.position.to_array())));
            let irradiance = self.irradiance(receiver);
            out.set(i, receivers.albedo_at(i) * irradiance / PI);
        }
    }

    /// The eight receivers' view of all spheres.
    fn see(&mut self, eight: &[Receiver<'_>; 8], objects: &[u32; 8]) {
        let lanes = |of: &dyn Fn(usize) -> f32| f32x8::from(std::array::from_fn::<f32, 8, _>(of));
        let view = Receivers8 {
            position: std::array::from_fn(|axis| lanes(&|lane| eight[lane].position[axis])),
            normal: std::array::from_fn(|axis| lanes(&|lane| eight[lane].normal[axis])),
            without: lanes(&|lane| if eight[lane].own.is_some() { objects[lane] as f32 } else { -1.0 }),
            sharpness: lanes(&|lane| eight[lane].set.mean_sharpness),
        };
        let Shader { frame, rule, .. } = self.shader;
        self.caps.clear();
        self.caps.extend(frame.spheres.iter().filter_map(|sphere| Cap8::new(sphere, &view, *rule)));
    }

    fn irradiance(&mut self, receiver: &Receiver<'_>) -> Vec3 {
        let shader = self.shader;
        let whole = shader.rest.at(receiver.normal);
        let mut irradiance = if whole == Vec3::ZERO { whole } else { whole * self.seen_share(receiver) };
        for lamp in &shader.frame.lamps {
            let whole = lamp.irradiance(receiver.position, receiver.normal);
            if whole != Vec3::ZERO {
                irradiance += whole * self.seen_of_lamp(lamp, receiver);
            }
        }
        irradiance
    }

    /// The share of the light that isn't a lamp's, by channel.
    fn seen_share(&self, receiver: &Receiver<'_>) -> Vec3 {
        let DirectionSet { directions, weights, .. } = receiver.set;
        let channels = self.shader.sets.channels;
        let normal = receiver.normal.to_array().map(f32x8::splat);
        let mut sums = Sums::default();
        let (blocks, _) = directions.as_chunks::<BLOCK>();
        for (number, block) in blocks.iter().enumerate() {
            let mut open: [f32x8; BLOCK] =
                std::array::from_fn(|k| self.open_of(receiver, &block[k].direction, f32::INFINITY));
            for cap in self.caps.iter().filter_map(|cap| cap.of(receiver.lane)) {
                close(&mut open, block, &cap);
            }
            for (k, open) in open.into_iter().enumerate() {
                let direction = &block[k].direction;
                let cosine = direction[0].mul_add(normal[0], direction[1].mul_add(normal[1], direction[2] * normal[2]));
                let (cosine, open) = (cosine.fast_max(f32x8::ZERO), open.fast_max(f32x8::ZERO));
                for (channel, weights) in weights.iter().enumerate().take(channels) {
                    let all = cosine * weights[BLOCK * number + k];
                    sums.all[channel] += all;
                    sums.seen[channel] = open.mul_add(all, sums.seen[channel]);
                }
            }
        }
        let shares = sums.shares();
        if channels == 1 { Vec3::splat(shares[0]) } else { Vec3::from(shares) }
    }

    /// The part of eight directions that neither the receiver's own object nor a box hides.
    #[inline(always)]
    fn open_of(&self, receiver: &Receiver<'_>, direction: &[f32x8; 3], limit: f32) -> f32x8 {
        let own = receiver.own.as_ref().map_or(f32x8::ONE, |own| own.open(direction));
        self.boxes.iter().fold(own, |open, view| open * view.open(direction, limit))
    }

    /// The share of a lamp's light.
    fn seen_of_lamp(&mut self, lamp: &Lamp, receiver: &Receiver<'_>) -> f32 {
        let Shader { spiral, edge, own, .. } = self.shader;
        let view = LampView::new(&lamp.place, receiver.position, receiver.normal, *edge, spiral.count);
        let cell = own.iter().flatten().next().map_or(0.0, |own| cell_versine(own.cells.side));
        let (mut shifts, mut open) = (std::mem::take(&mut self.shifts), std::mem::take(&mut self.open));
        shifts.clear();
        open.clear();
        let axis = view.axis.to_array().map(f32x8::splat);
        let limit = match lamp.place {
            LampPlace::Far { .. } => f32::INFINITY,
            LampPlace::Near { .. } => view.distance,
        };
        for (&within, &turn) in spiral.within.iter().zip(&spiral.turn) {
            let direction = |shift: &[f32x8; 3]| -> [f32x8; 3] {
                let shift = view.in_light_space(shift);
                std::array::from_fn(|k| axis[k] + shift[k])
            };
            let shift = view.shift(within, turn);
            let own = receiver
                .own
                .as_ref()
                .map_or(f32x8::ONE, |own| own.open(&direction(&view.shift_over_cell(cell, within, turn))));
            let along = direction(&shift);
            open.push(self.boxes.iter().fold(own, |open, view| open * view.open(&along, limit)));
            shifts.push(shift);
        }
        for cap in self.caps.iter().filter_map(|cap| cap.of(receiver.lane)) {
            view.close(&mut open, &shifts, &cap);
        }
        let normal = receiver.normal;
        let mut sums = Sums::default();
        let level = f32x8::splat(normal.dot(view.axis));
        for (group, (shift, open)) in shifts.iter().zip(&open).enumerate() {
            let shift = view.in_light_space(shift);
            let above = (0..3).fold(level, |sum, k| shift[k].mul_add(f32x8::splat(normal[k]), sum));
            let all = above.fast_max(f32x8::ZERO) * spiral.counts(8 * group);
            sums.all[0] += all;
            sums.seen[0] = open.fast_max(f32x8::ZERO).mul_add(all, sums.seen[0]);
        }
        (self.shifts, self.open) = (shifts, open);
        sums.shares()[0]
    }
}

/// 1 less the cosine of the angular radius of a cell of an octahedral grid, as if all were equal.
fn cell_versine(side: usize) -> f32 {
    2.0 / (side * side) as f32
}
