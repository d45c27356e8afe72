//! The estimator: direct light at receivers, with a standard error for every value.
//!
//! `L = albedo/π · ∫ L_in(ω) V(ω) max(n·ω, 0) dω` is a sum of integrals over lights (see [`crate::lights`]); a glossy
//! receiver adds those over its lobes (see [`crate::glossy`]), a translucent one has in place of irradiance what enters elsewhere
//! (see [`crate::translucent`]), which is sampled whole, without a control variate.
//!
//! **Standard error.** Low-discrepancy points are not independent, so the spread of samples says nothing about the error
//! of their mean. Every estimate is therefore the mean of [`REPLICATES`] independently scrambled estimates, and its
//! standard error is their standard deviation over √[`REPLICATES`]; it is itself uncertain by 18 %.
//! Where no sample of an integral was blocked, or every one was, replicates agree without the value being exact: then
//! half a sample of that integral is added to the error in quadrature.
//! Errors have heavy tails where a receiver sees a rare event (a thin blocker, a small light through a gap): their root
//! mean square over receivers is right, single values exceed three standard errors several times as often as normal ones.
//! Channels of one receiver share their rays and err together; receivers are independent.
//!
//! **Draws of the noise.** Whoever needs more than a standard error gets [`DRAWS`] contrasts of the sixteen estimates,
//! sums with as many plus as minus signs over sixteen: each has the variance of the mean's error, its tails and its
//! correlation between channels, and is uncorrelated with the mean and with the other contrasts.
//!
//! **Control variate.** Unshadowed irradiance E is known, so what is estimated is
//! `mean(f V) + β (E - mean(f))`: where little is blocked, the noise of the light itself cancels. β is the fraction of
//! light that was visible in the *other* replicates, so that it is independent of the replicate it corrects and adds no
//! bias.

use crate::{
    batch::{BATCH, Batch},
    blocker_caps::BlockerCaps,
    environment::LUMINANCE,
    glossy::{GlossyIntegral, GlossyTechnique},
    lights::Integral,
    mixture::Mixture,
    options::{Geometry, MAX_SAMPLES, Options, REPLICATES, Transport},
    parts::{DRAWS, Parts},
    paths::{Orders, Paths},
    points::{Points, Scramble},
    receiver::Receiver,
    sphere_albedo::SphereAlbedo,
    tracer::Tracer,
    translucent::Translucent,
    visibility::trace_mesh,
};
use glam::{DVec3, Vec3};
use halfshade_scene::{Lobes, Progress, RadianceBuffer, Receivers};
use rayon::prelude::*;
use std::f64::consts::FRAC_1_PI;

/// Numbers of scramblings of glossy receivers: past those of diffuse light.
const FIRST_GLOSSY_SCRAMBLE: u32 = 1 << 22;

/// Receivers per unit of parallel work.
const CHUNK: usize = 32;

/// Outgoing radiance of every receiver, and how well it is known.
#[derive(Debug, Clone, PartialEq)]
pub struct Estimate {
    /// Outgoing radiance: albedo/π times irradiance, and towards the eye what lobes reflect.
    pub radiance: RadianceBuffer,
    /// One standard error of each value.
    pub standard_error: RadianceBuffer,
    /// Draws of the noise of each value, [`DRAWS`] of them, or none if the result is exact: each is distributed as the
    /// value's error is, channels of a receiver together.
    pub draws: Vec<RadianceBuffer>,
    /// Unshadowed radiance of each receiver, mean over channels.
    pub unshadowed: Vec<f32>,
    /// Samples per receiver and technique that the result rests on; 0 if it is exact.
    pub samples: usize,
    /// Rays traced in all, rounds that a noise target threw away included.
    pub rays: u64,
    /// Root mean square of the standard errors over receivers and channels, in units of radiance.
    pub rms_standard_error: f64,
    /// Mean unshadowed radiance over receivers and channels.
    pub unshadowed_mean: f64,
}

impl Estimate {
    /// The RMS standard error as a fraction of the mean unshadowed radiance; 0 where there is no light.
    pub fn relative_rms_standard_error(&self) -> f64 {
        if self.rms_standard_error > 0.0 { self.rms_standard_error / self.unshadowed_mean.abs() } else { 0.0 }
    }
}

/// Estimates the outgoing radiance of `receivers`.
///
/// The hemisphere is that of the receiver's shading normal. Rays start a few units in the last place of the receiver's
/// own coordinates above the surface; directions that lie above the shading normal's horizon and below the mesh's own
/// faces are blocked where the mesh blocks them, as they would be by the real surface. Local lights emit and block
/// nothing. A receiver whose position or normal is not finite gets radiance 0.
pub fn estimate(tracer: &Tracer, receivers: Receivers<'_>, options: &Options, progress: &dyn Progress) -> Estimate {
    let limit = options.max_samples.clamp(REPLICATES, MAX_SAMPLES);
    let mut points = options.samples.clamp(1, MAX_SAMPLES).div_ceil(REPLICATES);
    let mut spent_rays = 0;
    loop {
        let mut result = one_round(tracer, receivers, options, points, progress);
        result.rays += spent_rays;
        let Some(target) = options.noise_target.filter(|target| *target > 0.0) else { return result };
        let error = result.relative_rms_standard_error();
        if error <= target || points * REPLICATES >= limit {
            return result;
        }
        spent_rays = result.rays;
        // Errors shrink with about the 0.65th power of the number of points; a round that falls just short would cost
        // another, so aim a little lower.
        let growth = (1.1 * error / target).powf(1.0 / 0.65).clamp(2.0, 64.0);
        let wanted = (points as f64 * growth).min((limit / REPLICATES) as f64) as usize;
        points = wanted.checked_next_power_of_two().unwrap_or(wanted).min(limit / REPLICATES);
    }
}

fn one_round(
    tracer: &Tracer,
    receivers: Receivers<'_>,
    options: &Options,
    points: usize,
    progress: &dyn Progress,
) -> Estimate {
    let count = receivers.len();
    let shadowed = options.transport == Transport::Shadowed;
    let glossy = tracer.eye_lobes.is_some();
    let translucent = tracer.is_translucent();
    let table = Points::first(if shadowed || glossy || translucent { points } else { 0 });
    let on_spheres = shadowed && options.bounces > 0 && options.geometry != Geometry::Mesh;
    let sphere_albedo = on_spheres.then(|| SphereAlbedo::new(tracer));
    // Points below surfaces are drawn by one number more, and at one depth more for the receivers' own.
    let more = usize::from(translucent);
    let depths = more + if shadowed { options.bounces } else { 0 };
    let per_depth = 1 + 2 * tracer.lights.integrals().count() + more;
    let orders = Orders::new(points, depths, per_depth, options.seed);
    progress.start("tracing", count as u64);
    let chunks: Vec<Vec<Value>> = (0..count.div_ceil(CHUNK))
        .into_par_iter()
        .map(|chunk| {
            let range = chunk * CHUNK..((chunk + 1) * CHUNK).min(count);
            let mut worker = Worker::new(tracer, options, (&table, &orders), sphere_albedo.as_ref());
            let values = range.clone().map(|i| worker.value(&receivers, i)).collect();
            progress.advance(range.len() as u64);
            values
        })
        .collect();

    let mut radiance = RadianceBuffer::zeros(count);
    let mut standard_error = RadianceBuffer::zeros(count);
    let exact = !glossy && chunks.iter().flatten().all(|value| value.standard_error == DVec3::ZERO);
    let mut draws = vec![RadianceBuffer::zeros(count); if exact { 0 } else { DRAWS }];
    let mut unshadowed_means = Vec::with_capacity(count);
    let (mut squares, mut unshadowed, mut rays) = (0.0, 0.0, 0);
    for (i, value) in chunks.iter().flatten().enumerate() {
        radiance.view_mut().set(i, value.radiance.as_vec3());
        standard_error.view_mut().set(i, value.standard_error.as_vec3());
        for (draw, noise) in draws.iter_mut().zip(value.draws) {
            draw.view_mut().set(i, noise);
        }
        unshadowed_means.push((value.unshadowed.element_sum() / 3.0) as f32);
        squares += value.standard_error.length_squared();
        unshadowed += value.unshadowed.element_sum();
        rays += value.rays;
    }
    let values = (3 * count).max(1) as f64;
    Estimate {
        radiance,
        standard_error,
        draws,
        unshadowed: unshadowed_means,
        samples: if rays > 0 || glossy { points * REPLICATES } else { 0 },
        rays,
        rms_standard_error: (squares / values).sqrt(),
        unshadowed_mean: unshadowed / values,
    }
}

/// Outgoing radiance of one receiver.
#[derive(Debug, Clone, Copy, Default)]
struct Value {
    radiance: DVec3,
    standard_error: DVec3,
    draws: [Vec3; DRAWS],
    unshadowed: DVec3,
    rays: u64,
}

/// Sums over the samples of one replicate of one integral.
#[derive(Debug, Clone, Copy, Default)]
struct Sums {
    seen: [f64; 3],
    all: [f64; 3],
    /// Luminance of absolute values: seen, all.
    weight: [f64; 2],
}

/// State of one thread that estimates receivers one after another.
struct Worker<'a> {
    tracer: &'a Tracer,
    options: &'a Options,
    points: &'a Points,
    caps: BlockerCaps,
    batch: Batch,
    paths: Paths<'a>,
}

impl<'a> Worker<'a> {
    fn new(
        tracer: &'a Tracer,
        options: &'a Options,
        (points, orders): (&'a Points, &'a Orders),
        sphere_albedo: Option<&'a SphereAlbedo>,
    ) -> Self {
        let paths = Paths::new(tracer, options, (points, orders), sphere_albedo);
        Self { tracer, options, points, caps: BlockerCaps::default(), batch: Batch::new(), paths }
    }

    fn value(&mut self, receivers: &Receivers<'_>, i: usize) -> Value {
        let (position, normal) = (receivers.position_at(i), receivers.normal_at(i));
        let mut value = Value::default();
        if !(position.is_finite() && normal.is_finite()) {
            return value;
        }
        let receiver = self.tracer.receiver(position, normal);
        let blocked = match (self.options.transport, self.options.geometry) {
            (Transport::Unshadowed, _) => false,
            (Transport::Shadowed, Geometry::Mesh) => self.tracer.triangle_count() > 0,
            (Transport::Shadowed, Geometry::Spheres(rule)) => {
                self.caps.adjust(self.tracer, rule, &receiver);
                !self.caps.is_empty()
            }
        };
        let albedo = receivers.albedo_at(i).as_dvec3();
        let scale = FRAC_1_PI * albedo;
        let index = receivers.index[i];
        let lobes = self.tracer.eye_lobes.as_ref().map_or(Lobes::NONE, |lobes| lobes.at(receivers, i));
        let translucent = self.tracer.translucent(receivers.object[i]);
        if let Some(surface) = translucent {
            let mut parts = Parts::NOTHING;
            // Within a translucent object it is dark.
            if !receivers.surface[i].is_from_behind() {
                parts = self.below(surface, &receiver, index);
                parts.scale(scale);
            }
            if !lobes.is_empty() {
                parts.add(&self.glossy_beside(&receiver, lobes, blocked, index, &mut value.rays));
            }
            (value.radiance, value.standard_error) = parts.mean_and_error();
            value.draws = parts.draws().map(|draw| draw.as_vec3());
            value.unshadowed = parts.unshadowed;
        } else if lobes.is_empty() {
            let (irradiance, error);
            if blocked {
                let mut parts = self.irradiance(&receiver, index, &mut value.rays);
                for (number, replicate) in parts.replicates.iter_mut().enumerate() {
                    *replicate += self.paths.irradiance(&receiver, index, number as u32);
                }
                (irradiance, error) = parts.mean_and_error();
                value.draws = parts.draws().map(|draw| (scale * draw).as_vec3());
                value.unshadowed = scale * parts.unshadowed;
            } else {
                (irradiance, error) = (self.unshadowed(&receiver), DVec3::ZERO);
                value.unshadowed = scale * irradiance;
            }
            (value.radiance, value.standard_error) = (scale * irradiance, scale * error);
        } else {
            let mut parts =
                self.glossy(&receiver, &Mixture::new(lobes, receiver.normal), blocked, index, &mut value.rays);
            let diffuse = if blocked {
                self.irradiance(&receiver, index, &mut value.rays)
            } else {
                let irradiance = self.unshadowed(&receiver);
                Parts { replicates: [irradiance; REPLICATES], unshadowed: irradiance, ..Parts::NOTHING }
            };
            parts.floor_squared += scale * scale * diffuse.floor_squared;
            parts.unshadowed += scale * diffuse.unshadowed;
            let all = Mixture::with_diffuse(lobes, albedo, receiver.normal);
            for (number, replicate) in parts.replicates.iter_mut().enumerate() {
                *replicate += scale * diffuse.replicates[number];
                if blocked {
                    *replicate += self.paths.radiance(&receiver, &all, index, number as u32);
                }
            }
            (value.radiance, value.standard_error) = parts.mean_and_error();
            value.draws = parts.draws().map(|draw| draw.as_vec3());
            value.unshadowed = parts.unshadowed;
        }
        value.rays += std::mem::take(&mut self.paths.rays);
        value
    }

    /// `∫ R_d E_t dA` at a translucent receiver, by direct light and by what surfaces reflect.
    fn below(&mut self, surface: &Translucent, receiver: &Receiver, index: u32) -> Parts {
        let cut = surface.cut(receiver.position);
        let mut parts = Parts::NOTHING;
        for (number, replicate) in parts.replicates.iter_mut().enumerate() {
            let [seen, all] = self.paths.below((surface, &cut), index, number as u32);
            *replicate = if self.options.transport == Transport::Shadowed { seen } else { all };
            parts.unshadowed += all / REPLICATES as f64;
        }
        parts
    }

    /// Radiance that the lobes of a translucent receiver reflect, of direct light and of what surfaces reflect.
    fn glossy_beside(&mut self, receiver: &Receiver, lobes: Lobes, blocked: bool, index: u32, rays: &mut u64) -> Parts {
        let mixture = Mixture::new(lobes, receiver.normal);
        let mut parts = self.glossy(receiver, &mixture, blocked, index, rays);
        for (number, replicate) in parts.replicates.iter_mut().enumerate().filter(|_| blocked) {
            *replicate += self.paths.radiance(receiver, &mixture, index, number as u32);
        }
        parts
    }

    fn unshadowed(&self, receiver: &Receiver) -> DVec3 {
        let lights = &self.tracer.lights;
        lights.integrals().map(|integral| lights.unshadowed(integral, receiver)).sum()
    }

    /// Irradiance by direct light.
    fn irradiance(&mut self, receiver: &Receiver, index: u32, rays: &mut u64) -> Parts {
        let mut parts = Parts::NOTHING;
        for (number, integral) in self.tracer.lights.integrals().enumerate() {
            let exact = self.tracer.lights.unshadowed(integral, receiver);
            parts.unshadowed += exact;
            let sums = self.sums((number as u32, integral), receiver, index, rays);
            let points = self.points.as_slice().len() as f64;
            let [seen, all] = [0, 1].map(|j| sums.iter().map(|s| s.weight[j]).sum::<f64>());
            for (replicate, sum) in parts.replicates.iter_mut().zip(&sums) {
                let others = all - sum.weight[1];
                let beta = if others > 0.0 { (seen - sum.weight[0]) / others } else { 1.0 };
                *replicate += DVec3::from(sum.seen) / points + beta * (exact - DVec3::from(sum.all) / points);
            }
            if seen == 0.0 || seen == all {
                parts.floor_squared += (0.5 * exact / (points * REPLICATES as f64)).powf(2.0);
            }
        }
        parts
    }

    /// Radiance that the lobes reflect of direct light.
    fn glossy(&mut self, receiver: &Receiver, mixture: &Mixture, blocked: bool, index: u32, rays: &mut u64) -> Parts {
        let Self { tracer, options, points, caps, batch, .. } = self;
        let mut parts = Parts::NOTHING;
        let count = points.as_slice().len() as f64;
        for (number, integral) in tracer.lights.integrals().enumerate() {
            let glossy = GlossyIntegral::new(tracer, integral, receiver, mixture);
            let mut sums = [Sums::default(); REPLICATES];
            for (which, technique) in GlossyTechnique::BOTH.into_iter().enumerate() {
                for (replicate, sum) in sums.iter_mut().enumerate() {
                    let stream = FIRST_GLOSSY_SCRAMBLE + 2 * number as u32 + which as u32;
                    let scramble = Scramble::new(options.seed, index, stream, replicate as u32);
                    for points in points.as_slice().chunks(BATCH) {
                        if !glossy.sample(technique, points, scramble, batch) {
                            break;
                        }
                        *rays += match options.geometry {
                            _ if !blocked => {
                                batch.visible = [1.0; BATCH];
                                0
                            }
                            Geometry::Mesh => trace_mesh(tracer, receiver, batch),
                            Geometry::Spheres(_) => {
                                caps.trace(batch);
                                batch.len as u64
                            }
                        };
                        sum.add(batch);
                    }
                }
            }
            let [seen, all] = [0, 1].map(|j| sums.iter().map(|s| s.weight[j]).sum::<f64>());
            let unshadowed = sums.iter().map(|s| DVec3::from(s.all)).sum::<DVec3>() / (count * REPLICATES as f64);
            for (replicate, sum) in parts.replicates.iter_mut().zip(&sums) {
                *replicate += DVec3::from(sum.seen) / count;
            }
            parts.unshadowed += unshadowed;
            if blocked && (seen == 0.0 || seen == all) {
                parts.floor_squared += (0.5 * unshadowed / (count * REPLICATES as f64)).powf(2.0);
            }
        }
        parts
    }

    fn sums(
        &mut self,
        integral: (u32, Integral),
        receiver: &Receiver,
        index: u32,
        rays: &mut u64,
    ) -> [Sums; REPLICATES] {
        let mut sums = [Sums::default(); REPLICATES];
        let Self { tracer, options, points, caps, batch, .. } = self;
        for_every_batch(tracer, integral, receiver, (options.seed, index), points, batch, |replicate, batch| {
            *rays += match options.geometry {
                Geometry::Mesh => trace_mesh(tracer, receiver, batch),
                Geometry::Spheres(_) => {
                    caps.trace(batch);
                    batch.len as u64
                }
            };
            sums[replicate].add(batch);
        });
        sums
    }
}

/// Draws all samples of one integral at one receiver: technique by technique, replicate by replicate.
pub(crate) fn for_every_batch(
    tracer: &Tracer,
    (number, integral): (u32, Integral),
    receiver: &Receiver,
    (seed, index): (u64, u32),
    points: &Points,
    batch: &mut Batch,
    mut each: impl FnMut(usize, &mut Batch),
) {
    for (which, technique) in tracer.lights.techniques(integral, receiver, &tracer.space).iter().enumerate() {
        let Some(technique) = technique else { continue };
        for replicate in 0..REPLICATES {
            let scramble = Scramble::new(seed, index, 2 * number + which as u32, replicate as u32);
            for points in points.as_slice().chunks(BATCH) {
                tracer.lights.sample(technique, receiver, points, scramble, batch);
                each(replicate, batch);
            }
        }
    }
}

impl Sums {
    /// Adds a batch, a vector register at a time.
    fn add(&mut self, batch: &Batch) {
        const LANES: usize = 4;
        let (mut seen, mut all) = ([[0.0_f64; LANES]; 3], [[0.0_f64; LANES]; 3]);
        let mut weight = [[0.0_f64; LANES]; 2];
        for first in (0..BATCH).step_by(LANES) {
            let visible: [f64; LANES] = std::array::from_fn(|k| f64::from(batch.visible[first + k]));
            let mut luminances = [0.0_f64; LANES];
            for (channel, luminance) in LUMINANCE.into_iter().enumerate() {
                for k in 0..LANES {
                    let value = f64::from(batch.value[channel][first + k]);
                    seen[channel][k] += value * visible[k];
                    all[channel][k] += value;
                    luminances[k] += f64::from(luminance) * value.abs();
                }
            }
            for k in 0..LANES {
                weight[0][k] += luminances[k] * visible[k];
                weight[1][k] += luminances[k];
            }
        }
        let total = |lanes: &[f64; LANES]| lanes.iter().sum::<f64>();
        for channel in 0..3 {
            self.seen[channel] += total(&seen[channel]);
            self.all[channel] += total(&all[channel]);
        }
        for (sum, lanes) in self.weight.iter_mut().zip(&weight) {
            *sum += total(lanes);
        }
    }
}
