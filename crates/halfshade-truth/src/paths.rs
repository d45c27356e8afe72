//! Light that surfaces reflect: paths of a fixed number of diffuse bounces.
//!
//! ```text
//! L_b(x) = a(x) · [ E(x)/π + ∫ L_{b-1}(hit of ω) cos θ/π dω ]        L_0(x) = a(x) · E(x)/π
//! ```
//!
//! A path leaves the receiver along a direction drawn with the density cos θ/π and goes on in the same way from what it
//! hits, `bounces` times. At every hit, direct light E is estimated with one sample of each technique of each light. There
//! is no Russian roulette: b bounces are b bounces. Every depth and technique has a scrambling of its own, and visits the
//! points in an order of its own: scramblings of one point share its binary subdivisions, and paths that took the k-th
//! point everywhere would leave most combinations out.
//!
//! Both faces of a triangle reflect, as both block. On a sphere the albedo is that of the vertex of the object's mesh that
//! is nearest to the point, from a table over directions.

use crate::{
    batch::Batch,
    caps::Caps,
    estimate::{Geometry, Options, trace_mesh},
    points::{Points, Scramble, unit_f32},
    receiver::Receiver,
    sphere_albedo::SphereAlbedo,
    tracer::Tracer,
};
use glam::{DVec3, Vec3};
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
    /// Of `points` points for so many depths and scramblings per depth.
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

/// What a path meets, ready to be lit.
struct Met {
    receiver: Receiver,
    albedo: DVec3,
}

/// Traces paths from one receiver after another.
pub(crate) struct Paths<'a> {
    tracer: &'a Tracer,
    options: &'a Options,
    points: &'a Points,
    orders: &'a Orders,
    sphere_albedo: Option<&'a SphereAlbedo>,
    /// What the receiver and each surface along a path see of the spheres.
    caps: Vec<Caps>,
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
        let caps = (0..=options.bounces).map(|_| Caps::default()).collect();
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

    /// Radiance that arrives along the k-th path at depth `depth`.
    fn incident(&mut self, from: &Receiver, depth: usize, k: usize, path: (u32, u32)) -> DVec3 {
        let first = FIRST_SCRAMBLE + SCRAMBLES_PER_DEPTH * depth as u32;
        let scramble = |number| Scramble::new(self.options.seed, path.0, first + number, path.1);
        let point = self.points.as_slice()[self.orders.at(depth, 0, k)];
        let [u, v] = scramble(0).apply(point).map(unit_f32);
        let direction = from.axes.direction(u.sqrt(), (1.0 - u).sqrt(), v);
        self.rays += 1;
        let Some(met) = self.meet(from, depth, Vec3::from(direction)) else { return DVec3::ZERO };
        if met.albedo == DVec3::ZERO {
            return DVec3::ZERO;
        }
        if let Geometry::Spheres(rule) = self.options.geometry {
            self.caps[depth + 1].adjust(self.tracer, rule, &met.receiver);
        }
        let mut radiance = FRAC_1_PI * self.direct(&met.receiver, depth, k, scramble);
        if depth + 1 < self.options.bounces {
            radiance += self.incident(&met.receiver, depth + 1, k, path);
        }
        met.albedo * radiance
    }

    /// Direct irradiance from one sample of each technique.
    fn direct(&mut self, at: &Receiver, depth: usize, k: usize, scramble: impl Fn(u32) -> Scramble) -> DVec3 {
        let Self { tracer, options, points, orders, caps, batch, rays, .. } = self;
        let lights = &tracer.lights;
        let mut irradiance = DVec3::ZERO;
        for (number, integral) in lights.integrals().enumerate() {
            let techniques = lights.techniques(integral, at, &tracer.space);
            for (which, technique) in techniques.iter().enumerate().filter_map(|(i, t)| Some((i, t.as_ref()?))) {
                let own = 1 + 2 * number as u32 + which as u32;
                let place = orders.at(depth, own, k);
                lights.sample(technique, at, &points.as_slice()[place..=place], scramble(own), batch);
                *rays += match options.geometry {
                    Geometry::Mesh => trace_mesh(tracer, at.ray_origin, batch),
                    Geometry::Spheres(_) => {
                        caps[depth + 1].trace(batch);
                        1
                    }
                };
                let value = DVec3::from_array(std::array::from_fn(|channel| f64::from(batch.value[channel][0])));
                irradiance += f64::from(batch.visible[0]) * value;
            }
        }
        irradiance
    }

    fn meet(&self, from: &Receiver, depth: usize, direction: Vec3) -> Option<Met> {
        match self.options.geometry {
            Geometry::Mesh => {
                let hit = self.tracer.first_hit(from.ray_origin, direction.into())?;
                let surface = self.tracer.surface_at(&hit, direction);
                let receiver = self.tracer.receiver(surface.position, surface.normal);
                Some(Met { receiver, albedo: surface.albedo.as_dvec3() })
            }
            Geometry::Spheres(_) => {
                let (sphere, distance, normal) = self.caps[depth].first_hit(direction)?;
                let along = self.tracer.space.length_in_world(f64::from(distance));
                let position = from.position + along * direction.as_dvec3();
                let receiver =
                    Receiver::new(self.tracer.space.point(position), position, normal.as_dvec3().normalize());
                let albedo = self.sphere_albedo.map_or(Vec3::ONE, |table| table.at(sphere, normal));
                Some(Met { receiver, albedo: albedo.as_dvec3() })
            }
        }
    }
}
