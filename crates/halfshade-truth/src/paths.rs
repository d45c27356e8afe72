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
//! Both faces of a triangle reflect, as both block. On a sphere the albedo is that of the vertex of the object's mesh
//! that is nearest to the point, from a table over directions.

use crate::{
    batch::Batch,
    blocker_caps::BlockerCaps,
    glossy::{GlossyIntegral, GlossyTechnique},
    mixture::Mixture,
    options::{Geometry, Options},
    points::{Points, Scramble, unit_f32, unit_f64},
    receiver::Receiver,
    sphere_albedo::SphereAlbedo,
    tracer::Tracer,
    visibility::trace_mesh,
};
use glam::{DVec3, Vec3};
use halfshade_scene::{Gloss, Lobes};
use std::f64::consts::FRAC_1_PI;

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
}

/// Traces paths from one receiver after another.
pub(crate) struct Paths<'a> {
    tracer: &'a Tracer,
    options: &'a Options,
    points: &'a Points,
    orders: &'a Orders,
    sphere_albedo: Option<&'a SphereAlbedo>,
    /// Spheres as the receiver and each surface along a path see them.
    caps: Vec<BlockerCaps>,
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
        let caps = (0..=options.bounces).map(|_| BlockerCaps::default()).collect();
        Self { tracer, options, points, orders, sphere_albedo, caps, batch: Batch::new(), rays: 0 }
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

    /// The scramblings of a path at a depth, by number.
    fn scramble(&self, depth: usize, path: (u32, u32)) -> impl Fn(u32) -> Scramble + use<> {
        let (first, seed) = (FIRST_SCRAMBLE + SCRAMBLES_PER_DEPTH * depth as u32, self.options.seed);
        move |number| Scramble::new(seed, path.0, first + number, path.1)
    }

    /// Radiance that arrives along the k-th path at depth `depth`.
    fn incident(&mut self, from: &Receiver, depth: usize, k: usize, path: (u32, u32)) -> DVec3 {
        let point = self.points.as_slice()[self.orders.at(depth, 0, k)];
        let [u, v] = self.scramble(depth, path)(0).apply(point).map(unit_f32);
        let direction = from.axes.direction(u.sqrt(), (1.0 - u).sqrt(), v);
        self.arriving(from, Vec3::from(direction), depth, k, path)
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
        if met.lobes.is_empty() {
            let mut radiance = FRAC_1_PI * self.direct(&met.receiver, depth, k, scramble);
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
                    radiance += self.seen(at, depth);
                }
            }
        }
        radiance
    }

    /// The value of the batch's only sample if its light is seen.
    fn seen(&mut self, at: &Receiver, depth: usize) -> DVec3 {
        let Self { tracer, options, caps, batch, rays, .. } = self;
        *rays += match options.geometry {
            Geometry::Mesh => trace_mesh(tracer, at, batch),
            Geometry::Spheres(_) => {
                caps[depth + 1].trace(batch);
                1
            }
        };
        let value = DVec3::from_array(std::array::from_fn(|channel| f64::from(batch.value[channel][0])));
        f64::from(batch.visible[0]) * value
    }

    /// Direct irradiance from one sample of each technique.
    fn direct(&mut self, at: &Receiver, depth: usize, k: usize, scramble: impl Fn(u32) -> Scramble) -> DVec3 {
        let lights = &self.tracer.lights;
        let mut irradiance = DVec3::ZERO;
        for (number, integral) in lights.integrals().enumerate() {
            let techniques = lights.techniques(integral, at, &self.tracer.space);
            for (which, technique) in techniques.iter().enumerate().filter_map(|(i, t)| Some((i, t.as_ref()?))) {
                let own = 1 + 2 * number as u32 + which as u32;
                let place = self.orders.at(depth, own, k);
                let points = &self.points.as_slice()[place..=place];
                lights.sample(technique, at, points, scramble(own), &mut self.batch);
                irradiance += self.seen(at, depth);
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
                Some(SurfaceHit { receiver, albedo: surface.albedo.as_dvec3(), lobes })
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
                Some(SurfaceHit { receiver, albedo: albedo.as_dvec3(), lobes })
            }
        }
    }

    /// The lobes of what a path along `direction` meets, towards where it came from.
    fn lobes(&self, object: u32, gloss: Gloss, at: &Receiver, direction: Vec3) -> Lobes {
        let lobes = self.tracer.eye_lobes.as_ref();
        lobes.map_or(Lobes::NONE, |lobes| lobes.toward(object, gloss, at.normal.as_vec3(), -direction))
    }
}
