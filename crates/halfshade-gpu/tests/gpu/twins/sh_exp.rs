//! Variables that functions of `sh-exp` read, and spheres and receivers to call them with.

use super::{axis_or_any, compare, direction, given, tolerance};
use glam::{DVec3, Vec3};
use halfshade_gpu::{
    Gpu,
    probe::{DeviceBlocker, Probe, Tables, Variable},
};
use halfshade_scene::{
    Environment, Scene,
    progress::Silent,
    spheres::{AdjustRule, FADE_HEIGHT, adjust},
};
use halfshade_sh::{
    blocker_table::{INTERVALS, Quantity},
    zonal,
};
use halfshade_strategies::{ShExp, sh_exp::arrays::FirstPass};
use halfshade_strategy::Strategy;
use libtest_mimic::Failed;
use rand::RngExt;
use rand_pcg::Pcg64Mcg;
use std::sync::Arc;

/// The rule for spheres that cut the tangent plane; the others are held in `tangent_plane`.
pub(super) const RULE: [(&str, f64); 2] = [("RULE", 0.0), ("FULL_HEIGHT", FADE_HEIGHT)];

/// The variables of `sh_exp/frame.wgsl`.
pub(super) struct Frame {
    pub(super) tables: Tables,
    pub(super) blockers: Vec<DeviceBlocker>,
    pub(super) numbers: Vec<u32>,
    pub(super) radiating: Vec<[f32; 4]>,
}

/// A receiver; its numbers are those that the device gets.
#[derive(Debug, Clone, Copy)]
pub(super) struct Receiver {
    pub(super) position: Vec3,
    pub(super) normal: Vec3,
}

/// Spheres that some receivers see.
pub(super) struct Arrangement {
    pub(super) name: String,
    pub(super) blockers: Vec<DeviceBlocker>,
    pub(super) receivers: Vec<Receiver>,
}

/// Zonal vectors by angular radius: those of a table exactly, and straight lines between them, as its readers do.
pub(super) struct ExactTable {
    /// Divided by the squared sine.
    entries: Vec<Vec<f64>>,
}

impl Frame {
    /// Tables of `sh-exp` with some settings under constant light; no spheres.
    pub(super) fn new(settings: &str) -> Result<Self, Failed> {
        let failed = |error: &dyn std::fmt::Display| Failed::from(error.to_string());
        let scene = Scene { bounces: 1, ..Scene::at_rest("empty", Vec::new(), Environment::constant(Vec3::ONE)) };
        let params = ShExp.info().parse(settings).map_err(|error| failed(&error))?;
        let mut baked = ShExp::bake_scene(&scene, &params, &Silent).map_err(|error| failed(&error))?;
        baked.prepare_frame(&scene.frame(0), FirstPass::Here).map_err(|error| failed(&error))?;
        let tables = Tables::new(&baked.scene_arrays(), &baked.frame_arrays(), None);
        Ok(Self { tables, blockers: Vec::new(), numbers: vec![0; 8], radiating: Vec::new() })
    }

    pub(super) fn variables(&self) -> [Variable<'_>; 5] {
        [
            Variable::uniform(0, "frame", &self.tables.uniforms),
            Variable::storage(1, "blockers", &self.blockers),
            Variable::storage(2, "numbers", &self.numbers),
            Variable::storage(3, "tables", &self.tables.rows),
            Variable::storage(4, "radiating", &self.radiating),
        ]
    }

    /// Rows at the end of the tables, and the number of the first.
    pub(super) fn add_rows(&mut self, rows: impl IntoIterator<Item = [f32; 4]>) -> u32 {
        let first = self.tables.rows.len() as u32;
        self.tables.rows.extend(rows);
        first
    }

    /// The spheres of all arrangements, each a cut, and the receivers as rows: the cut after the position.
    pub(super) fn place(&mut self, arrangements: &[Arrangement]) -> Vec<[f32; 4]> {
        let mut inputs = Vec::new();
        for (cut, Arrangement { blockers, receivers, .. }) in arrangements.iter().enumerate() {
            self.numbers.extend([self.blockers.len() as u32, blockers.len() as u32]);
            self.blockers.extend(blockers);
            for Receiver { position, normal } in receivers {
                inputs.extend([position.extend(cut as f32).to_array(), normal.extend(0.0).to_array()]);
            }
        }
        inputs
    }
}

impl ExactTable {
    pub(super) fn new(bands: usize, quantity: Quantity) -> Self {
        let entry = |interval: usize| {
            let u = (interval as f64 / INTERVALS as f64).max(2f64.powi(-26));
            quantity.zonal(bands, u).iter().map(|value| value / (u * (2.0 - u))).collect()
        };
        Self { entries: (0..=INTERVALS).map(entry).collect() }
    }

    pub(super) fn zonal(&self, sin_squared: f64) -> Vec<f64> {
        let at = sin_squared / (1.0 + (1.0 - sin_squared).sqrt()) * INTERVALS as f64;
        let interval = (at as usize).min(INTERVALS - 1);
        let t = at - interval as f64;
        let pairs = self.entries[interval].iter().zip(&self.entries[interval + 1]);
        pairs.map(|(a, b)| (a + (b - a) * t) * sin_squared).collect()
    }
}

/// Direction and squared sine of the angular radius of a sphere; `None` where it has no influence.
pub(super) fn seen_from(receiver: &Receiver, blocker: &DeviceBlocker) -> Option<(DVec3, f64)> {
    let offset = Vec3::from(blocker.center).as_dvec3() - receiver.position.as_dvec3();
    let normal = receiver.normal.as_dvec3().normalize();
    let seen = adjust(AdjustRule::Continuous, offset, f64::from(blocker.radius), normal)?;
    Some((seen.direction(), seen.sin_angular_radius().powi(2)))
}

/// A zonal vector by band times the factors of a sphere.
pub(super) fn times_factors(blocker: &DeviceBlocker, zonal: Vec<f64>) -> Vec<f64> {
    zonal.iter().zip(blocker.factors).map(|(value, factor)| value * f64::from(factor)).collect()
}

/// Adds `factor` times a zonal vector that is turned to a direction.
pub(super) fn add_lobe(direction: DVec3, zonal: &[f64], factor: f64, sum: &mut [f64]) {
    let lobe = zonal::rotate_to_axis(zonal, direction.to_array());
    sum.iter_mut().zip(lobe).for_each(|(sum, value)| *sum += factor * value);
}

/// A sphere that counts as it is.
pub(super) fn sphere(center: DVec3, radius: f64) -> DeviceBlocker {
    DeviceBlocker {
        center: center.as_vec3().to_array(),
        radius: radius as f32,
        factors: [1.0; 8],
        emitter: 0,
        reflection_factor: 1.0,
        padding: [0; 2],
    }
}

/// None, one of any size with receivers in it, on it and far away, many at one place, many of all sizes, hundreds.
pub(super) fn arrangements(random: &mut Pcg64Mcg) -> Vec<Arrangement> {
    let around = |count: usize, distances: &[f64], random: &mut Pcg64Mcg| -> Vec<Receiver> {
        (0..count)
            .map(|i| {
                let position = (direction(random) * distances[i % distances.len()]).as_vec3();
                Receiver { position, normal: axis_or_any(i, random).as_vec3() }
            })
            .collect()
    };
    let mut all = vec![("none".to_owned(), Vec::new(), around(6, &[1.0], random))];
    for size in [1e-4, 1.0, 1e4] {
        let distances = [0.0, 1e-6, 1.0 - 1e-6, 1.0, 1.0 + 1e-6, 1.5, 3.0, 1e3].map(|distance| distance * size);
        all.push((format!("one of {size:e}"), vec![sphere(DVec3::ZERO, size)], around(64, &distances, random)));
        // Tangent to the receivers' plane from in front and from behind.
        let tangent = |i: usize, side: f64, random: &mut Pcg64Mcg| {
            let normal = axis_or_any(i, random).as_vec3();
            let aside = direction(random).cross(normal.as_dvec3()) * size;
            Receiver { position: (aside - normal.as_dvec3() * size * side).as_vec3(), normal }
        };
        let receivers = (0..32).map(|i| tangent(i / 2, if i % 2 == 0 { 1.0 } else { -1.0 }, random)).collect();
        all.push((format!("tangent of {size:e}"), vec![sphere(DVec3::ZERO, size)], receivers));
    }
    all.push(("coincident".to_owned(), vec![sphere(DVec3::ONE, 1.0); 12], around(32, &[0.0, 1.0, 3.0], random)));
    let of_all_sizes = (0..20)
        .map(|_| {
            let radius = 10f64.powf(random.random_range(-4.0..4.0));
            let factors = std::array::from_fn(|_| random.random_range(0.5..1.5));
            let center = direction(random) * radius * random.random_range(1.0..4.0);
            DeviceBlocker { factors, ..sphere(center, radius) }
        })
        .collect();
    all.push(("of all sizes".to_owned(), of_all_sizes, around(32, &[0.0, 1e-3, 1.0], random)));
    let hundreds = (0..160)
        .map(|_| sphere(direction(random) * random.random_range(1.0..3.0), random.random_range(0.05..0.3)))
        .collect();
    all.push(("hundreds".to_owned(), hundreds, around(12, &[0.0, 1.0, 2.0], random)));
    let arrangement = |(name, blockers, receivers)| Arrangement { name, blockers, receivers };
    all.into_iter().map(arrangement).collect()
}

/// A function of position, normal and cut that gives a vector.
pub(super) struct OfCut<'a> {
    pub(super) shader: &'a str,
    pub(super) function: &'a str,
    pub(super) bands: usize,
    pub(super) constants: &'a [(&'a str, f64)],
}

impl OfCut<'_> {
    /// Holds it to what is `expected` of it, arrangement by arrangement.
    pub(super) fn hold(
        &self,
        gpu: &Arc<Gpu>,
        frame: &mut Frame,
        arrangements: &[Arrangement],
        expected: impl Fn(&[DeviceBlocker], &Receiver) -> Vec<f64>,
    ) -> Result<(), Failed> {
        let &Self { shader, function, bands, constants } = self;
        let count = bands * bands;
        let inputs = frame.place(arrangements);
        let body = given(&format!("{function}(input[0].xyz, input[1].xyz, cut_of(u32(input[0].w)))"), "0u");
        let found = Probe {
            shader,
            bands: Some(bands),
            constants: &[&RULE, constants].concat(),
            rows: [2, count.div_ceil(4)],
            body: &body,
            variables: &frame.variables(),
        }
        .call(gpu, &inputs)?;
        let mut found = found.as_slice();
        for Arrangement { name, blockers, receivers } in arrangements {
            let (own, others) = found.split_at(receivers.len() * count.div_ceil(4));
            found = others;
            let expected: Vec<f64> = receivers.iter().flat_map(|receiver| expected(blockers, receiver)).collect();
            let what = format!("{function} of {bands} bands, {constants:?}, {name}");
            compare(&what, tolerance(shader), own, &expected, count)?;
        }
        Ok(())
    }
}
