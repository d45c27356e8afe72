//! Light that surfaces reflect: paths of a fixed number of bounces.
//!
//! ```text
//! L_b(x) = a(x) · [ E(x)/π + ∫ L_{b-1}(hit of ω) cos θ/π dω ]        L_0(x) = a(x) · E(x)/π
//! ```
//!
//! A path leaves the receiver along a direction drawn with the density cos θ/π and goes on in the same way from what it
//! hits, `bounces` times. At every hit, direct light E is estimated with one sample of each technique of each light.
//! There is no Russian roulette: b bounces are b bounces. Every depth and technique has a scrambling of its own, and
//! visits the points in an order of its own: scramblings of one point share its binary subdivisions, and paths that
//! took the k-th point everywhere would leave most combinations out.
//!
//! A path goes on from a glossy surface along a direction that all of its lobes draw, the diffuse one among them, and
//! carries reflectance over density; direct light there is sampled by light and by reflectance (see `glossy.rs`).
//!
//! From a translucent surface a path goes on from another point of it, drawn by how much light comes from there to where it was met
//! (see `translucent.rs`); such a passage is part of the surface's reflection, and no bounce of its own.
//!
//! Both faces of a triangle reflect, as both block, but for the inside of translucent objects, which is black. On a sphere the albedo is that of the vertex of the object's mesh
//! that is nearest to the point, from a table over directions.

use crate::{
    batch::Batch,
    blocker_caps::BlockerCaps,
    glossy::{GlossyIntegral, GlossyTechnique},
    mixture::Mixture,
    options::{Geometry, Options, Transport},
    points::{Points, Scramble, unit_f32, unit_f64},
    receiver::Receiver,
    sphere_albedo::SphereAlbedo,
    tracer::Tracer,
    translucent::{Cut, Translucent},
    visibility::trace_mesh,
};
use glam::{DVec3, Vec3};
use halfshade_scene::{Gloss, Lobes};
use std::f64::consts::{FRAC_1_PI, PI};

/// Numbers of scramblings: past those of direct light, and so many for each depth.
const FIRST_SCRAMBLE: u32 = 1 << 24;
const SCRAMBLES_PER_DEPTH: u32 = 1 << 16;

/// Random orders in which points are visited, one for each depth and technique; the same for all receivers, whose
/// scramblings differ.
#[derive(Debug)]
pub(crate) struct Orders {
    orders: Vec<Vec<u32>>,
    per_depth: usize,
}

impl Orders {
    /// `points` points for so many depths and scramblings per depth.
    pub(crate) fn new(points: usize, depths: usize, per_depth: usize, seed: u64) -> Self {
        let shuffled = |number: usize| {
            let mut order: Vec<u32> = (0..points as u32).collect();
            for last in (1..points).rev() {
                let [random, _] = Scramble::new(seed, number as u32, u32::MAX, last as u32).words();
                order.swap(last, random as usize % (last + 1));
            }
            order
        };
        Self { orders: (0..depths * per_depth).map(shuffled).collect(), per_depth }
    }

    fn at(&self, depth: usize, number: u32, k: usize) -> usize {
        self.orders[depth * self.per_depth + number as usize][k] as usize
    }
}

/// A surface that a path meets, ready to be lit.
struct SurfaceHit {
    receiver: Receiver,
    albedo: DVec3,
    /// Reflection into the path beside its diffuse part.
    lobes: Lobes,
    /// The object, which matters where it is translucent.
    object: u32,
}

/// Share of light that passes a surface at a cosine.
type Passing<'a> = &'a dyn Fn(f64) -> f64;

/// Traces paths from one receiver after another.
pub(crate) struct Paths<'a> {
    tracer: &'a Tracer,
    options: &'a Options,
    points: &'a Points,
    orders: &'a Orders,
    sphere_albedo: Option<&'a SphereAlbedo>,
    /// Spheres as the receiver and each surface along a path see them.
    caps: Vec<BlockerCaps>,
    /// Bounces, none of which there are without shadows.
    bounces: usize,
    /// Number of the scrambling that points below surfaces are drawn with.
    entry: u32,
    batch: Batch,
    pub(crate) rays: u64,
}

impl<'a> Paths<'a> {
    pub(crate) fn new(
        tracer: &'a Tracer,
        options: &'a Options,
        (points, orders): (&'a Points, &'a Orders),
        sphere_albedo: Option<&'a SphereAlbedo>,
    ) -> Self {
        let caps = (0..=options.bounces + 1).map(|_| BlockerCaps::default()).collect();
        let bounces = if options.transport == Transport::Shadowed { options.bounces } else { 0 };
        let entry = 1 + 2 * tracer.lights.integrals().count() as u32;
        Self { tracer, options, points, orders, sphere_albedo, caps, bounces, entry, batch: Batch::new(), rays: 0 }
    }

    /// Irradiance by reflected light at `receiver`, whose stable number is `index`, as one replicate estimates it.
    pub(crate) fn irradiance(&mut self, receiver: &Receiver, index: u32, replicate: u32) -> DVec3 {
        if self.options.bounces == 0 {
            return DVec3::ZERO;
        }
        if let Geometry::Spheres(rule) = self.options.geometry {
            self.caps[0].adjust(self.tracer, rule, receiver);
        }
        let count = self.points.as_slice().len();
        let sum: DVec3 = (0..count).map(|k| self.incident(receiver, 0, k, (index, replicate))).sum();
        sum / (count as f64 * FRAC_1_PI)
    }

    /// Radiance that a glossy receiver reflects towards the eye of light that other surfaces reflect; `mixture` holds its
    /// diffuse lobe too.
    pub(crate) fn radiance(&mut self, receiver: &Receiver, mixture: &Mixture, index: u32, replicate: u32) -> DVec3 {
        if self.options.bounces == 0 {
            return DVec3::ZERO;
        }
        if let Geometry::Spheres(rule) = self.options.geometry {
            self.caps[0].adjust(self.tracer, rule, receiver);
        }
        let count = self.points.as_slice().len();
        let sum: DVec3 = (0..count).map(|k| self.incident_at_lobes(receiver, mixture, 0, k, (index, replicate))).sum();
        sum / count as f64
    }

    /// `∫ R_d E_t dA` at a point of a translucent object, light that surfaces reflect included, and the same of direct light that
    /// nothing hides, as one replicate estimates them.
    pub(crate) fn below(&mut self, surface: (&Translucent, &Cut), index: u32, replicate: u32) -> [DVec3; 2] {
        let count = self.points.as_slice().len();
        let mut sums = [DVec3::ZERO; 2];
        for k in 0..count {
            // Depths of bounces come before that of the receiver's own points.
            let found = self.entered(surface, self.bounces, 0, k, (index, replicate));
            sums.iter_mut().zip(found).for_each(|(sum, found)| *sum += found);
        }
        sums.map(|sum| sum / count as f64)
    }

    /// R_d E_t at a point drawn on a translucent object, over its density: with all that hides and reflects light, reflections from
    /// depth `next` on, and of direct light that nothing hides.
    fn entered(
        &mut self,
        (translucent, cut): (&Translucent, &Cut),
        depth: usize,
        next: usize,
        k: usize,
        path: (u32, u32),
    ) -> [DVec3; 2] {
        let scramble = self.scramble(depth, path);
        let point = self.points.as_slice()[self.orders.at(depth, self.entry, k)];
        let drawn = translucent.draw(cut, scramble(self.entry).apply(point).map(unit_f64));
        let Some(entry) = drawn else { return [DVec3::ZERO; 2] };
        let at = self.tracer.receiver(entry.position.as_vec3(), entry.normal.as_vec3());
        if let Geometry::Spheres(rule) = self.options.geometry {
            self.caps[depth + 1].adjust(self.tracer, rule, &at);
            self.caps[next].adjust(self.tracer, rule, &at);
        }
        let passing = |cosine: f64| translucent.dipole.transmittance(cosine);
        let [mut seen, all] = self.direct(&at, depth, k, scramble, &passing);
        if next < self.bounces {
            let direction = self.cosine_direction(&at, next, k, path);
            let share = passing(at.normal.dot(direction.as_dvec3()));
            seen += PI * share * self.arriving(&at, direction, next, k, path);
        }
        [entry.weight * seen, entry.weight * all]
    }

    /// The scramblings of a path at a depth, by number.
    fn scramble(&self, depth: usize, path: (u32, u32)) -> impl Fn(u32) -> Scramble + use<> {
        let (first, seed) = (FIRST_SCRAMBLE + SCRAMBLES_PER_DEPTH * depth as u32, self.options.seed);
        move |number| Scramble::new(seed, path.0, first + number, path.1)
    }

    /// Radiance that arrives along the k-th path at depth `depth`.
    fn incident(&mut self, from: &Receiver, depth: usize, k: usize, path: (u32, u32)) -> DVec3 {
        let direction = self.cosine_direction(from, depth, k, path);
        self.arriving(from, direction, depth, k, path)
    }

    /// The direction of the k-th path at a depth, of density cos/π.
    fn cosine_direction(&self, from: &Receiver, depth: usize, k: usize, path: (u32, u32)) -> Vec3 {
        let point = self.points.as_slice()[self.orders.at(depth, 0, k)];
        let [u, v] = self.scramble(depth, path)(0).apply(point).map(unit_f32);
        Vec3::from(from.axes.direction(u.sqrt(), (1.0 - u).sqrt(), v))
    }

    /// Radiance that arrives along the k-th path at depth `depth`, times the reflectance of a glossy surface over the
    /// density with which its lobes draw the direction.
    fn incident_at_lobes(
        &mut self,
        from: &Receiver,
        mixture: &Mixture,
        depth: usize,
        k: usize,
        path: (u32, u32),
    ) -> DVec3 {
        let point = self.points.as_slice()[self.orders.at(depth, 0, k)];
        let direction = mixture.sample(self.scramble(depth, path)(0).apply(point).map(unit_f64));
        let (reflectance, density) = mixture.evaluate(direction.as_dvec3());
        if reflectance == DVec3::ZERO || density <= 0.0 {
            return DVec3::ZERO;
        }
        reflectance / density * self.arriving(from, direction, depth, k, path)
    }

    /// Radiance that arrives along a direction.
    fn arriving(&mut self, from: &Receiver, direction: Vec3, depth: usize, k: usize, path: (u32, u32)) -> DVec3 {
        self.rays += 1;
        let Some(met) = self.meet(from, depth, direction) else { return DVec3::ZERO };
        if met.albedo == DVec3::ZERO && met.lobes.is_empty() {
            return DVec3::ZERO;
        }
        if let Geometry::Spheres(rule) = self.options.geometry {
            self.caps[depth + 1].adjust(self.tracer, rule, &met.receiver);
        }
        let scramble = self.scramble(depth, path);
        if let Some(translucent) = self.tracer.translucent(met.object) {
            return self.arriving_from_below(translucent, &met, depth, k, path);
        }
        if met.lobes.is_empty() {
            let mut radiance = FRAC_1_PI * self.direct(&met.receiver, depth, k, scramble, &|_| 1.0)[0];
            if depth + 1 < self.options.bounces {
                radiance += self.incident(&met.receiver, depth + 1, k, path);
            }
            return met.albedo * radiance;
        }
        let mixture = Mixture::with_diffuse(met.lobes, met.albedo, met.receiver.normal);
        let mut radiance = self.direct_at_lobes(&met.receiver, &mixture, depth, k, scramble);
        if depth + 1 < self.options.bounces {
            radiance += self.incident_at_lobes(&met.receiver, &mixture, depth + 1, k, path);
        }
        radiance
    }

    /// Radiance that arrives from a translucent surface: light from below, and what its lobes reflect.
    fn arriving_from_below(
        &mut self,
        translucent: &Translucent,
        met: &SurfaceHit,
        depth: usize,
        k: usize,
        path: (u32, u32),
    ) -> DVec3 {
        let mut radiance = DVec3::ZERO;
        if met.albedo != DVec3::ZERO {
            let cut = translucent.cut(met.receiver.position);
            radiance += FRAC_1_PI * met.albedo * self.entered((translucent, &cut), depth, depth + 1, k, path)[0];
        }
        if !met.lobes.is_empty() {
            let mixture = Mixture::new(met.lobes, met.receiver.normal);
            if let Geometry::Spheres(rule) = self.options.geometry {
                self.caps[depth + 1].adjust(self.tracer, rule, &met.receiver);
            }
            radiance += self.direct_at_lobes(&met.receiver, &mixture, depth, k, self.scramble(depth, path));
            if depth + 1 < self.options.bounces {
                radiance += self.incident_at_lobes(&met.receiver, &mixture, depth + 1, k, path);
            }
        }
        radiance
    }

    /// Direct light that lobes reflect into the path, from one sample of each technique of each light.
    fn direct_at_lobes(
        &mut self,
        at: &Receiver,
        mixture: &Mixture,
        depth: usize,
        k: usize,
        scramble: impl Fn(u32) -> Scramble,
    ) -> DVec3 {
        let mut radiance = DVec3::ZERO;
        for (number, integral) in self.tracer.lights.integrals().enumerate() {
            let glossy = GlossyIntegral::new(self.tracer, integral, at, mixture);
            for (which, technique) in GlossyTechnique::BOTH.into_iter().enumerate() {
                let own = 1 + 2 * number as u32 + which as u32;
                let place = self.orders.at(depth, own, k);
                if glossy.sample(technique, &self.points.as_slice()[place..=place], scramble(own), &mut self.batch) {
                    radiance += self.seen(at, depth)[0];
                }
            }
        }
        radiance
    }

    /// The value of the batch's only sample if its light is seen, and in any case.
    fn seen(&mut self, at: &Receiver, depth: usize) -> [DVec3; 2] {
        let Self { tracer, options, caps, batch, rays, .. } = self;
        *rays += match options.geometry {
            Geometry::Mesh => trace_mesh(tracer, at, batch),
            Geometry::Spheres(_) => {
                caps[depth + 1].trace(batch);
                1
            }
        };
        let value = DVec3::from_array(std::array::from_fn(|channel| f64::from(batch.value[channel][0])));
        [f64::from(batch.visible[0]) * value, value]
    }

    /// Direct irradiance from one sample of each technique, times what passes at its cosine; and the same if nothing hid any light.
    fn direct(
        &mut self,
        at: &Receiver,
        depth: usize,
        k: usize,
        scramble: impl Fn(u32) -> Scramble,
        passing: Passing<'_>,
    ) -> [DVec3; 2] {
        let lights = &self.tracer.lights;
        let mut irradiance = [DVec3::ZERO; 2];
        for (number, integral) in lights.integrals().enumerate() {
            let techniques = lights.techniques(integral, at, &self.tracer.space);
            for (which, technique) in techniques.iter().enumerate().filter_map(|(i, t)| Some((i, t.as_ref()?))) {
                let own = 1 + 2 * number as u32 + which as u32;
                let place = self.orders.at(depth, own, k);
                let points = &self.points.as_slice()[place..=place];
                lights.sample(technique, at, points, scramble(own), &mut self.batch);
                let direction = DVec3::from_array(self.batch.direction.each_ref().map(|axis| f64::from(axis[0])));
                let share = passing(at.normal.dot(direction));
                irradiance.iter_mut().zip(self.seen(at, depth)).for_each(|(sum, value)| *sum += share * value);
            }
        }
        irradiance
    }

    fn meet(&self, from: &Receiver, depth: usize, direction: Vec3) -> Option<SurfaceHit> {
        match self.options.geometry {
            Geometry::Mesh => {
                let hit = self.tracer.first_hit(from, direction)?;
                let surface = self.tracer.receiver_at(&hit, direction);
                let receiver = self.tracer.receiver(surface.position, surface.normal);
                let lobes = self.lobes(surface.object, surface.gloss, &receiver, direction);
                let object = surface.object;
                let is_within = self.tracer.translucent(object).is_some() && surface.surface.is_from_behind();
                let albedo = if is_within { DVec3::ZERO } else { surface.albedo.as_dvec3() };
                Some(SurfaceHit { receiver, albedo, lobes, object })
            }
            Geometry::Spheres(_) => {
                let (sphere, distance, normal) = self.caps[depth].first_hit(direction)?;
                let along = self.tracer.space.length_in_world(f64::from(distance));
                let position = from.position + along * direction.as_dvec3();
                let receiver =
                    Receiver::new(self.tracer.space.exact_point(position), position, normal.as_dvec3().normalize());
                let (albedo, gloss) =
                    self.sphere_albedo.map_or((Vec3::ONE, Gloss::NEUTRAL), |table| table.at(sphere, normal));
                let object = self.tracer.sphere_owners[sphere].0 as u32;
                let lobes = self.lobes(object, gloss, &receiver, direction);
                Some(SurfaceHit { receiver, albedo: albedo.as_dvec3(), lobes, object })
            }
        }
    }

    /// The lobes of what a path along `direction` meets, towards where it came from.
    fn lobes(&self, object: u32, gloss: Gloss, at: &Receiver, direction: Vec3) -> Lobes {
        let lobes = self.tracer.eye_lobes.as_ref();
        lobes.map_or(Lobes::NONE, |lobes| lobes.toward(object, gloss, at.normal.as_vec3(), -direction))
    }
}
