//! Radiance of spheres, and how receivers gather it.

use super::{
    compare, direction, given, numbers, rows,
    sh_exp::{Arrangement, ExactTable, Frame, RULE, Receiver, add_lobe, arrangements, seen_from, times_factors},
    tolerance,
};
use glam::{DMat3, DQuat, DVec3, Vec3};
use halfshade_gpu::{
    Gpu,
    kernels::SH_EXP_EMIT,
    probe::{self, DeviceBlocker, Emitter, Probe, Rounds, Variable},
};
use halfshade_sh::{
    basis,
    blocker_table::Quantity,
    exponential::{Exponential, Method},
    form_factor::{INTERVALS, Weighting, form_factor},
    logarithm::DEFAULT_CLIP,
    rotation::ShRotation,
    wgsl::MAX_WGSL_BANDS,
    zonal,
};
use libtest_mimic::Failed;
use rand::{RngExt, SeedableRng};
use rand_pcg::Pcg64Mcg;
use std::{f64::consts::PI, sync::Arc};

/// Magnitude at which squaring starts.
const LIMIT: f64 = 4.8;

/// Settings of the second pass.
#[derive(Debug, Clone, Copy, Default)]
struct Way {
    bands: usize,
    by_power: bool,
    is_precomputed: bool,
    is_quadratic: bool,
    is_series: bool,
    /// Channels and scale of what spheres radiate.
    channels: usize,
    scale: f64,
}

/// Spheres that radiate, and those that don't cover them.
struct Radiating {
    /// By emitter and channel.
    vectors: Vec<Vec<f64>>,
    /// By emitter.
    skipped: Vec<Vec<u32>>,
}

/// Exact forms of what the shader tabulates.
struct Exact {
    way: Way,
    logs: ExactTable,
    /// By sine.
    forms: Vec<Vec<f64>>,
    exponential: Exponential,
    cosine: Vec<f64>,
}

/// Spheres in order at every number of bands, all other ways at one.
pub(super) fn gather(gpu: &Arc<Gpu>) -> Result<(), Failed> {
    let plain = |bands| Way { bands, channels: if bands % 2 == 0 { 3 } else { 1 }, scale: 1.0, ..Way::default() };
    let mut ways: Vec<Way> = (1..=MAX_WGSL_BANDS).map(plain).collect();
    let (three, four) = (plain(3), plain(4));
    ways.extend([
        Way { by_power: true, scale: 1e-20, ..four },
        Way { is_precomputed: true, scale: 1e20, ..four },
        Way { is_precomputed: true, by_power: true, ..three },
        Way { is_quadratic: true, is_series: true, ..three },
        Way { is_quadratic: true, is_precomputed: true, by_power: true, ..plain(2) },
    ]);
    ways.into_iter().try_for_each(|way| hold(gpu, way))
}

fn hold(gpu: &Arc<Gpu>, way: Way) -> Result<(), Failed> {
    let mut random = Pcg64Mcg::seed_from_u64(13);
    let mut arrangements = arrangements(&mut random);
    let radiating = Radiating::new(&way, &mut arrangements, &mut random);
    let exact = Exact::new(way);
    let parts = (way.bands * way.bands).div_ceil(4);
    let form = if way.is_series { "series" } else { "hybrid" };
    let mut frame = Frame::new(&format!("bands={},reflection-exp={form}", way.bands))?;
    frame.numbers[1] = way.channels as u32;
    frame.radiating = radiating.vectors.iter().flat_map(|vector| rows(vector)).collect();
    let inputs = frame.place(&arrangements);
    radiating.add_masks(&mut frame);
    let flag = |is_set| f64::from(u8::from(is_set));
    let constants = [
        ("REFLECTION_METHOD", if way.is_series { 0.0 } else { 2.0 }),
        ("REFLECTION_TERMS", 9.0),
        ("REFLECTION_LIMIT", LIMIT),
        ("BY_POWER", flag(way.by_power)),
        ("IS_PRECOMPUTED", flag(way.is_precomputed)),
        ("IS_QUADRATIC", flag(way.is_quadratic)),
    ];
    let shader = "sh_exp/gather.wgsl";
    let found = Probe {
        shader,
        bands: Some(way.bands),
        constants: &[&RULE[..], &constants].concat(),
        rows: [2, 1 + parts],
        body: &format!(
            "let gathered = gather(Receiver(input[0].xyz, input[1].xyz, 0u, 0u), cut_of(u32(input[0].w)));
            output[0] = vec4f(gathered.radiance, 0.0);
            {}",
            given("gathered.log_sum", "1u")
        ),
        variables: &frame.variables(),
    }
    .call(gpu, &inputs)?;
    let calls = arrangements.iter().flat_map(|seen| seen.receivers.iter().map(|receiver| (&seen.blockers, receiver)));
    let (mut radiances, mut sums) = ((Vec::new(), Vec::new()), (Vec::new(), Vec::new()));
    for ((blockers, receiver), found) in calls.zip(found.chunks(1 + parts)) {
        let spheres = exact.seen(blockers, receiver, &radiating);
        sums.0.extend(&found[1..]);
        sums.1.extend(exact.log_sum(&spheres, |_| true));
        if is_in_order(&spheres) {
            radiances.0.push(found[0]);
            radiances.1.extend(exact.radiance(&spheres, receiver, &radiating).to_array());
        } else {
            check_bound(&found[0], &spheres)?;
        }
    }
    compare(&format!("{way:?}, sums"), tolerance(shader), &sums.0, &sums.1, way.bands * way.bands)?;
    compare(&format!("{way:?}"), tolerance(shader), &radiances.0, &radiances.1, 3)
}

impl Radiating {
    /// Numbers the spheres from last to first, and makes them radiate.
    fn new(way: &Way, arrangements: &mut [Arrangement], random: &mut Pcg64Mcg) -> Self {
        let mut number: u32 = arrangements.iter().map(|seen| seen.blockers.len() as u32).sum();
        let mut skipped = vec![Vec::new(); number as usize];
        for Arrangement { blockers, .. } in arrangements {
            let last = number;
            number -= blockers.len() as u32;
            for (blocker, emitter) in blockers.iter_mut().zip((number..last).rev()) {
                blocker.emitter = emitter;
                blocker.reflection_factor = random.random_range(0.5..2.0);
                skipped[emitter as usize] = (number..last).filter(|_| random.random_range(0.0..1.0) < 0.3).collect();
            }
        }
        let vector = |_| numbers(way.bands * way.bands, way.scale, random);
        let vectors = (0..skipped.len() * way.channels).map(vector).collect();
        Self { vectors, skipped }
    }

    /// Three numbers per sphere, then the bits that they tell of.
    fn add_masks(&self, frame: &mut Frame) {
        let masks = frame.numbers.len();
        frame.tables.uniforms.masks = masks as u32;
        frame.numbers.resize(masks + 3 * self.skipped.len(), 0);
        for (sphere, skipped) in self.skipped.iter().enumerate() {
            let (Some(first), Some(last)) = (skipped.first(), skipped.last()) else { continue };
            let mut bits = vec![0; (last - first) as usize / 32 + 1];
            skipped.iter().for_each(|other| bits[(other - first) as usize / 32] |= 1 << ((other - first) % 32));
            let place = frame.numbers.len() as u32;
            frame.numbers[masks + 3 * sphere..][..3].copy_from_slice(&[*first, last - first + 1, place]);
            frame.numbers.extend(bits);
        }
    }
}

/// The view of a receiver on a sphere.
struct Seen {
    emitter: u32,
    /// The number by which spheres are ordered, and the largest of those that it is the difference of.
    key: f64,
    size: f64,
    log: Vec<f64>,
    radiance: DVec3,
}

/// Whether single precision can tell which of two spheres is nearer, for all of them.
fn is_in_order(spheres: &[Seen]) -> bool {
    let mut sorted: Vec<&Seen> = spheres.iter().collect();
    sorted.sort_by(|a, b| a.key.total_cmp(&b.key));
    sorted.windows(2).all(|pair| pair[1].key - pair[0].key > 1e-6 * pair[0].size.max(pair[1].size))
}

/// Refuses more than any order gives: all radiance at the most that reflectance times a difference of visibilities can be.
fn check_bound(found: &[f32; 4], spheres: &[Seen]) -> Result<(), Failed> {
    let most = spheres.iter().map(|seen| seen.radiance.abs()).sum::<DVec3>() * 2.0 * (4.0 * PI).sqrt();
    let is_within = found.iter().zip(most.to_array()).all(|(found, most)| f64::from(found.abs()) <= most);
    if is_within { Ok(()) } else { Err(format!("{found:?} is more than {most}").into()) }
}

impl Exact {
    fn new(way: Way) -> Self {
        let logarithm = Quantity::Logarithm { clip: DEFAULT_CLIP };
        let form = |interval: usize| form_factor(way.bands, interval as f64 / INTERVALS as f64, Weighting::SolidAngle);
        let method = if way.is_series {
            Method::Series { terms: 9, magnitude_limit: Some(LIMIT) }
        } else {
            Method::Hybrid { magnitude_limit: LIMIT }
        };
        Self {
            way,
            logs: ExactTable::new(way.bands, logarithm),
            forms: (0..=INTERVALS).map(form).collect(),
            exponential: Exponential::new(way.bands, method, DEFAULT_CLIP).blended(),
            cosine: zonal::clamped_cosine(way.bands).into_iter().map(|value| value / PI).collect(),
        }
    }

    fn seen(&self, blockers: &[DeviceBlocker], receiver: &Receiver, radiating: &Radiating) -> Vec<Seen> {
        let each = |blocker: &DeviceBlocker| {
            let (direction, sin_squared) = seen_from(receiver, blocker)?;
            let mut log = vec![0.0; self.way.bands * self.way.bands];
            add_lobe(direction, &times_factors(blocker, self.logs.zonal(sin_squared)), 1.0, &mut log);
            let squared = (Vec3::from(blocker.center).as_dvec3()).distance_squared(receiver.position.as_dvec3());
            let radius_squared = f64::from(blocker.radius).powi(2);
            let key = if self.way.by_power { squared - radius_squared } else { squared };
            // Light that the sphere sends to the receiver leaves it in the opposite direction.
            let average = self.average(-direction, sin_squared.sqrt());
            let of_channel = |channel: usize| {
                let vector = blocker.emitter as usize * self.way.channels + channel % self.way.channels;
                basis::dot(&radiating.vectors[vector], &average) * f64::from(blocker.reflection_factor)
            };
            let radiance = DVec3::from_array(std::array::from_fn(of_channel));
            Some(Seen { emitter: blocker.emitter, key, size: squared.max(radius_squared), log, radiance })
        };
        blockers.iter().filter_map(each).collect()
    }

    /// Weights of a sphere's vector in its average as it is seen from a direction.
    fn average(&self, direction: DVec3, sine: f64) -> Vec<f64> {
        let at = sine * INTERVALS as f64;
        let interval = (at as usize).min(INTERVALS - 1);
        let t = at - interval as f64;
        let mut weights = basis::evaluate(self.way.bands, direction.to_array());
        for (i, weight) in weights.iter_mut().enumerate() {
            let (l, _) = basis::degree_and_order(i);
            *weight *= self.forms[interval][l] * (1.0 - t) + self.forms[interval + 1][l] * t;
        }
        weights
    }

    fn log_sum(&self, spheres: &[Seen], is_counted: impl Fn(&Seen) -> bool) -> Vec<f64> {
        let mut sum = vec![0.0; self.way.bands * self.way.bands];
        for seen in spheres.iter().filter(|seen| is_counted(seen)) {
            sum.iter_mut().zip(&seen.log).for_each(|(sum, log)| *sum += log);
        }
        sum
    }

    /// Every sphere's radiance by what the nearer ones that cover it leave visible of it.
    fn radiance(&self, spheres: &[Seen], receiver: &Receiver, radiating: &Radiating) -> DVec3 {
        let brdf = zonal::rotate_to_axis(&self.cosine, receiver.normal.as_dvec3().to_array());
        let each = |seen: &Seen| {
            let skipped = &radiating.skipped[seen.emitter as usize];
            let mut sum = self.log_sum(spheres, |other| {
                other.key < seen.key && !(self.way.is_precomputed && skipped.contains(&other.emitter))
            });
            let before = basis::dot(&self.exponential.evaluate(&sum), &brdf);
            sum.iter_mut().zip(&seen.log).for_each(|(sum, log)| *sum += log);
            seen.radiance * (before - basis::dot(&self.exponential.evaluate(&sum), &brdf))
        };
        spheres.iter().map(each).sum()
    }
}

/// Spheres with none to hundreds of sample points, in light of any size.
pub(super) fn emit(gpu: &Arc<Gpu>) -> Result<(), Failed> {
    let mut random = Pcg64Mcg::seed_from_u64(14);
    for bands in 1..=MAX_WGSL_BANDS {
        for ([channels, surface_channels], scale) in [([1, 1], 1.0), ([3, 1], 1e-20), ([3, 3], 1e20)] {
            let used = if channels == 1 { bands * bands } else { (bands - 1) * (bands - 1) };
            radiate(gpu, bands, [channels, surface_channels, used.max(1)], scale, &mut random)?;
        }
    }
    Ok(())
}

fn radiate(
    gpu: &Arc<Gpu>,
    bands: usize,
    [channels, surface_channels, used]: [usize; 3],
    scale: f64,
    random: &mut Pcg64Mcg,
) -> Result<(), Failed> {
    let (count, parts) = (bands * bands, (bands * bands).div_ceil(4));
    let counts = [0, 1, 7, 300, 20];
    let samples: usize = counts.iter().sum();
    let turns: [ShRotation; 2] = std::array::from_fn(|_| {
        let turn = DQuat::from_rotation_arc(direction(random).normalize(), direction(random).normalize());
        ShRotation::new(bands, &DMat3::from_quat(turn).transpose().to_cols_array_2d())
    });
    let rotations: Vec<f32> = (turns.iter())
        .flat_map(|turn| (0..bands).flat_map(|l| turn.block(l).transpose().iter().copied().collect::<Vec<f64>>()))
        .map(|value| value as f32)
        .collect();
    let mut any = |count: usize, scale: f64| -> Vec<f32> {
        numbers(count, scale, random).into_iter().map(|number| number as f32).collect()
    };
    let light = any(channels * samples, scale);
    let weights = any(samples * surface_channels * count, 1.0);
    let (mut emitters, mut expected, mut first) = (Vec::new(), Vec::new(), 0);
    for (sphere, of_sphere) in counts.into_iter().enumerate() {
        let own = first * surface_channels * count;
        let rotation = (sphere % 2 * rotations.len() / 2) as u32;
        emitters.push(Emitter { first_sample: first as u32, samples: of_sphere as u32, weights: own as u32, rotation });
        for channel in 0..channels {
            let mut sum = vec![0.0; count];
            for sample in 0..of_sphere {
                let radiance = f64::from(light[channel * samples + first + sample]);
                let row = own + (sample * surface_channels + channel % surface_channels) * count;
                sum.iter_mut().zip(&weights[row..]).for_each(|(sum, &weight)| *sum += radiance * f64::from(weight));
            }
            let mut turned = turns[sphere % 2].apply(&sum);
            turned.truncate(used);
            turned.resize(4 * parts, 0.0);
            expected.extend(turned);
        }
        first += of_sphere;
    }
    let [channels, surface_channels, used, samples] = [channels, surface_channels, used, samples].map(|n| n as u32);
    let rounds = Rounds { channels, surface_channels, used, samples };
    let variables = [
        Variable::uniform(0, "rounds", &rounds),
        Variable::storage(1, "emitters", &emitters),
        Variable::storage(2, "weights", &weights),
        Variable::storage(3, "rotations", &rotations),
        Variable::storage(4, "light", &light),
    ];
    let workgroups = expected.len() / (4 * parts);
    let found = probe::run(gpu, &SH_EXP_EMIT, Some(bands), &variables, workgroups, expected.len() / 4)?;
    compare(&format!("{bands} bands, {rounds:?}"), tolerance(SH_EXP_EMIT.shader), &found, &expected, 4 * parts)
}
