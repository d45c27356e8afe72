//! Eight receivers: their view of all spheres, then receiver by receiver the light that is left.

use super::shader::Shader;
use crate::{
    mask::kernel::{
        boxes::BoxView,
        bundle::Bundle,
        cap::{Cap8, Receivers8},
        directions::{BLOCK, DirectionSet, Sums, close},
        lamp::LampView,
        lobe::cosines,
        own::OwnView,
    },
    shared::placed_lamps::Lamp,
};
use glam::Vec3;
use halfshade_scene::{RadianceMut, Receivers, lobe::Lobes};
use std::{f32::consts::PI, ops::Range};
use wide::f32x8;

/// Memory that batches share.
pub(super) struct Batch<'a> {
    pub(super) shader: &'a Shader<'a>,
    /// The view of each sphere that any of the eight sees.
    caps: Vec<Cap8>,
    /// Boxes that the receiver at hand may see.
    boxes: Vec<BoxView<'a>>,
    /// The bundle at hand.
    pub(super) looks: Looks,
    /// Directions of a lobe that don't meet the lamp at hand.
    pub(super) dark: Vec<f32x8>,
}

/// Directions of a bundle less its axis, how sharp edges are there, and what is open of them.
#[derive(Debug, Default)]
pub(super) struct Looks {
    pub(super) shifts: Vec<[f32x8; 3]>,
    pub(super) sharpness: Vec<f32x8>,
    pub(super) open: Vec<f32x8>,
}

impl Looks {
    fn clear(&mut self) {
        self.shifts.clear();
        self.sharpness.clear();
        self.open.clear();
    }

    /// Eight by eight: shifts, what is open, sharpness.
    pub(super) fn groups(&self) -> impl Iterator<Item = ((&[f32x8; 3], &f32x8), &f32x8)> {
        self.shifts.iter().zip(&self.open).zip(&self.sharpness)
    }
}

/// One of the eight.
pub(super) struct Receiver<'a> {
    position: Vec3,
    pub(super) normal: Vec3,
    lane: usize,
    own: Option<OwnView<'a>>,
    set: &'a DirectionSet,
    /// Reflectance toward the eye beside the diffuse part, in light space.
    pub(super) lobes: Lobes,
}

impl<'a> Batch<'a> {
    pub(super) fn new(shader: &'a Shader<'a>) -> Self {
        Self {
            shader,
            caps: Vec::with_capacity(shader.frame.spheres.len()),
            boxes: Vec::with_capacity(shader.frame.boxes.len()),
            looks: Looks::default(),
            dark: Vec::new(),
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
                lobes: shader.lobes_of(&receivers, i),
            }
        });
        let objects: [u32; 8] = std::array::from_fn(|lane| receivers.object[(range.start + lane).min(range.end - 1)]);
        self.see(&eight, &objects);
        for (i, receiver) in range.zip(&eight) {
            self.boxes.clear();
            let others = shader.frame.boxes.iter().filter(|placed| placed.object != objects[receiver.lane]);
            self.boxes.extend(others.map(|placed| BoxView::new(placed, receiver.position.to_array())));
            let [irradiance, glossy] = self.light(receiver);
            out.set(i, receivers.albedo_at(i) * irradiance / PI + glossy);
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

    /// Irradiance, and what glossy lobes send toward the eye.
    fn light(&mut self, receiver: &Receiver<'_>) -> [Vec3; 2] {
        let shader = self.shader;
        let whole = shader.rest.at(receiver.normal);
        let mut irradiance = if whole == Vec3::ZERO { whole } else { whole * self.seen_share(receiver) };
        let mut glossy = self.gloss_of_rest(receiver);
        for lamp in &shader.frame.lamps {
            let whole = lamp.irradiance(receiver.position, receiver.normal);
            if whole != Vec3::ZERO {
                let view = self.look_into(lamp, receiver);
                irradiance += whole * self.seen_of_lamp(&view, receiver.normal);
                glossy += self.gloss_of_lamp(lamp, &view, receiver);
            }
        }
        [irradiance, glossy]
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

    /// Looks into a lamp.
    fn look_into(&mut self, lamp: &Lamp, receiver: &Receiver<'_>) -> LampView {
        let Shader { spiral, edge, .. } = self.shader;
        let view = LampView::new(&lamp.place, receiver.position, receiver.normal, *edge, spiral.count);
        let shift = |group: usize, least: f32| view.shift(least, spiral.within[group], spiral.turn[group]);
        self.look(&view.bundle, receiver, spiral.within.len(), shift, |_| f32x8::splat(view.sharpness));
        view
    }

    /// Looks into so many eights of directions of a bundle. `shift` gives them by number, and as wide as cells of a least versine.
    #[inline(always)]
    pub(super) fn look(
        &mut self,
        bundle: &Bundle,
        receiver: &Receiver<'_>,
        groups: usize,
        shift: impl Fn(usize, f32) -> [f32x8; 3],
        sharpness: impl Fn(usize) -> f32x8,
    ) {
        let own = self.shader.own.iter().flatten().next();
        let cell = own.map_or(0.0, |own| cell_versine(own.cells.side));
        let mut looks = std::mem::take(&mut self.looks);
        looks.clear();
        for group in 0..groups {
            let own = receiver.own.as_ref();
            let own = own.map_or(f32x8::ONE, |own| own.open(&bundle.directions(&shift(group, cell))));
            let shift = shift(group, 0.0);
            let along = bundle.directions(&shift);
            looks.open.push(self.boxes.iter().fold(own, |open, view| open * view.open(&along, bundle.distance)));
            looks.shifts.push(shift);
            looks.sharpness.push(sharpness(group));
        }
        for cap in self.caps.iter().filter_map(|cap| cap.of(receiver.lane)) {
            bundle.close(&mut looks.open, &looks.shifts, &looks.sharpness, &cap);
        }
        self.looks = looks;
    }

    /// The share of the light of the lamp that was looked into.
    fn seen_of_lamp(&self, view: &LampView, normal: Vec3) -> f32 {
        let mut sums = Sums::default();
        for (group, ((shift, open), _)) in self.looks.groups().enumerate() {
            let above = cosines(&view.bundle, normal, shift);
            let all = above.fast_max(f32x8::ZERO) * self.shader.spiral.counts(8 * group);
            sums.all[0] += all;
            sums.seen[0] = open.fast_max(f32x8::ZERO).mul_add(all, sums.seen[0]);
        }
        sums.shares()[0]
    }
}

/// 1 less the cosine of the angular radius of a cell of an octahedral grid, as if all were equal.
fn cell_versine(side: usize) -> f32 {
    2.0 / (side * side) as f32
}
