//! Gloss: lobes toward the eye, and directions drawn by them.

use super::{
    CALLS, compare, compare_in_turn, direction, finite,
    receivers::{PlacedReceiver, ReceiverBuffers, lobe_rows, peak, weighed},
    sampler::about,
    single, tolerance,
    traverse::{ray_buffers, ray_variables},
};
use glam::{DVec3, Quat, Vec3};
use halfshade_gpu::{
    Gpu,
    probe::{Probe, Variable},
};
use halfshade_scene::{
    Environment, Gloss, LafortuneLobe, Lobe, Material, Object, Pose, Reflectance, Scene, builtin::shapes,
    reflectance::tangent,
};
use libtest_mimic::Failed;
use rand::{RngExt, SeedableRng};
use rand_pcg::Pcg64Mcg;
use std::sync::Arc;

const EXPONENTS: [f32; 8] = [0.0, 1.0, 7.5, 60.0, 500.0, 2500.0, 1e4, 1e5];

/// A term of any model: mirrors, and lobes that are shrunk or stretched as far as their power leaves them of one size.
fn term(number: usize, exponent: f32, random: &mut Pcg64Mcg) -> Reflectance {
    let specular = Vec3::new(0.3, 0.2, 0.1);
    let mut stretch = || 1.0 - random.random_range(-2.0..3.0) / exponent.max(3.0);
    match number % 5 {
        0 => Reflectance::Phong { specular, exponent },
        1 => Reflectance::ModifiedPhong { specular, exponent },
        kind => {
            let axis = match kind {
                2 => Vec3::new(-1.0, -1.0, 1.0),
                3 => Vec3::new(-stretch(), -stretch(), stretch()),
                _ => Vec3::new(stretch(), -stretch(), stretch()),
            };
            let axis = if number % 100 == 99 { Vec3::ZERO } else { axis };
            Reflectance::Lafortune { lobes: vec![LafortuneLobe { scale: specular, axis, exponent }] }
        }
    }
}

/// The same in the rows of a table: model and numbers.
fn term_rows(term: &Reflectance) -> [[f32; 4]; 2] {
    let row = |scale: Vec3, exponent: f32, axis: Vec3, model: f32| {
        [scale.extend(exponent).to_array(), axis.extend(model).to_array()]
    };
    match term {
        Reflectance::Lambert => [[0.0; 4]; 2],
        Reflectance::Phong { specular, exponent } => row(*specular, *exponent, Vec3::ZERO, 0.0),
        Reflectance::ModifiedPhong { specular, exponent } => row(*specular, *exponent, Vec3::ZERO, 1.0),
        Reflectance::Lafortune { lobes } => row(lobes[0].scale, lobes[0].exponent, lobes[0].axis, 2.0),
    }
}

/// Unit normal and direction to the eye: straight above, on the horizon, a millionth above it, below it, or anywhere.
fn seen(number: usize, random: &mut Pcg64Mcg) -> [Vec3; 2] {
    let any = direction(random).as_vec3();
    match number % 11 {
        0 => [any, any],
        1 => [Vec3::Y, Vec3::X],
        2 => [Vec3::Y, Vec3::new(0.6, 1e-6, 0.8)],
        3 => [any, -any],
        4 => [Vec3::Y, any],
        5 => [Vec3::NEG_Y, any],
        _ => [any, direction(random).as_vec3()],
    }
}

/// All models at all exponents.
pub(super) fn lobes(gpu: &Arc<Gpu>) -> Result<(), Failed> {
    let mut random = Pcg64Mcg::seed_from_u64(30);
    let shader = "common/reflectance.wgsl";
    let body = "let term = Term(input[0].xyz, input[0].w, input[1].xyz, u32(input[1].w));
        let lobe = lobe_toward(term, input[2].xyz, input[3].xyz, input[4].xyz);
        output[0] = vec4f(lobe.axis, select(0.0, 1.0, lobe.times_cosine));
        output[1] = vec4f(lobe.scale, lobe.exponent);";
    let calls: Vec<(Reflectance, [Vec3; 3])> = (0..4 * CALLS)
        .map(|i| {
            let (exponent, turn) = (EXPONENTS[i % EXPONENTS.len()], i / EXPONENTS.len());
            let [normal, to_eye] = seen(turn, &mut random);
            (term(turn, exponent, &mut random), [normal, tangent(normal), to_eye])
        })
        .collect();
    let inputs: Vec<[f32; 4]> = (calls.iter())
        .flat_map(|(term, vectors)| {
            let vectors = vectors.map(|vector| vector.extend(0.0).to_array());
            term_rows(term).into_iter().chain(vectors)
        })
        .collect();
    let found = Probe { shader, bands: None, constants: &[], rows: [5, 2], body, variables: &[] }.call(gpu, &inputs)?;
    let most = |term: &Reflectance| peak(term, 1.0).max(1e-30);
    let found: Vec<[f32; 4]> = (found.as_chunks::<2>().0.iter().zip(&calls))
        .flat_map(|(rows, (term, _))| weighed(*rows, most(term)))
        .collect();
    let expected: Vec<f64> = (calls.iter())
        .flat_map(|(term, [normal, tangent, to_eye])| {
            let lobes = term.lobes(Gloss::NEUTRAL, *normal, *tangent, *to_eye);
            weighed(lobe_rows(lobes.first()), most(term))
        })
        .flat_map(|row| row.map(f64::from))
        .collect();
    compare_in_turn("exponent", &EXPONENTS, tolerance(shader), &found, &expected, 8)
}

/// Objects of all models, turned, within a box that makes the space of kernels that of the world.
fn glossy_scene(random: &mut Pcg64Mcg) -> Scene {
    let mut objects = vec![Object::new("box", shapes::box_mesh(1))];
    for (number, exponent) in EXPONENTS.into_iter().enumerate() {
        let model = match number {
            3 => {
                let mut lobe = |exponent| match term(3, exponent, random) {
                    Reflectance::Lafortune { lobes } => lobes[0],
                    _ => unreachable!("the third is a Lafortune model"),
                };
                Reflectance::Lafortune { lobes: [1e4, 60.0, 1.0, 0.0].map(&mut lobe).into() }
            }
            _ => term(number, exponent, random),
        };
        let axis = direction(random).as_vec3().normalize();
        let rotation = Quat::from_axis_angle(axis, random.random_range(0.0..6.0));
        let pose = Pose { scale: 0.25, rotation, translation: 0.5 * direction(random).as_vec3() };
        let material = Material { reflectance: model, ..Material::default() };
        objects.push(Object::new("object", shapes::plane(1)).material(material).pose(pose));
    }
    Scene::at_rest("glossy", objects, Environment::constant(Vec3::ONE))
}

/// Eyes near, far away, and at a receiver.
pub(super) fn eye_lobes(gpu: &Arc<Gpu>) -> Result<(), Failed> {
    let mut random = Pcg64Mcg::seed_from_u64(31);
    let shader = "common/eye_lobes.wgsl";
    let mut scene = glossy_scene(&mut random);
    let body = "let receiver = receiver_at(number);
        let kind = vec4u(bitcast<vec3u>(input[1].xyz), u32(input[1].w));
        let lobe = eye_lobe(number, receiver, input[2].xyz, bitcast<vec4u>(input[0]), kind);
        output[0] = vec4f(lobe.axis, select(0.0, 1.0, lobe.times_cosine));
        output[1] = vec4f(lobe.scale, lobe.exponent);";
    for eye in [Vec3::new(1.5, 1.25, -1.0), Vec3::new(-2e20, 3e20, 1e20), Vec3::ZERO] {
        scene.camera.eye = eye;
        // The first object has no gloss: its receivers lie at the last eye.
        let objects = scene.objects.len();
        let receivers: Vec<PlacedReceiver> = (0..CALLS)
            .map(|i| {
                let receiver = PlacedReceiver::random(i % objects, i, &mut random);
                if i % objects == 0 { PlacedReceiver { position: Vec3::ZERO, ..receiver } } else { receiver }
            })
            .collect();
        let placed = ReceiverBuffers::new(&receivers, &scene);
        scene.objects[0].material.reflectance = Reflectance::Phong { specular: Vec3::ONE, exponent: 5.0 };
        let inputs: Vec<[f32; 4]> = (receivers.iter())
            .flat_map(|receiver| {
                let rows = term_rows(&scene.objects[receiver.object].material.reflectance);
                rows.into_iter().chain([eye.extend(0.0).to_array()])
            })
            .collect();
        let variables = placed.variables();
        let found = Probe { shader, bands: None, constants: &[], rows: [3, 2], body, variables: &variables }
            .call(gpu, &inputs)?;
        let first: Vec<(Option<Lobe>, f64)> = receivers.iter().map(|receiver| receiver.lobes(&scene)[0]).collect();
        let found: Vec<[f32; 4]> =
            (found.as_chunks::<2>().0.iter().zip(&first)).flat_map(|(rows, (_, peak))| weighed(*rows, *peak)).collect();
        let expected: Vec<f64> = (first.iter())
            .flat_map(|(lobe, peak)| weighed(lobe_rows(lobe.as_ref()), *peak))
            .flat_map(|row| row.map(f64::from))
            .collect();
        compare(&format!("eye {eye}"), tolerance(shader), &found, &expected, 8)?;
    }
    Ok(())
}

/// Lobes of a receiver beside its diffuse one, and that.
struct Reflector {
    lobes: Vec<Lobe>,
    normal: DVec3,
}

fn sum_of(scale: Vec3) -> f64 {
    scale.as_dvec3().element_sum()
}

impl Reflector {
    /// `None` where rounding decides whether a lobe is black.
    fn new(receiver: &PlacedReceiver, scene: &Scene) -> Option<Self> {
        let normal = receiver.normal(scene);
        let mut lobes: Vec<Lobe> = receiver.lobes(scene).into_iter().filter_map(|(lobe, _)| lobe).collect();
        if lobes.iter().any(|lobe| lobe.scale.max_element() < 1e-30) {
            return None;
        }
        if !lobes.is_empty() {
            lobes.push(Lobe::diffuse(receiver.albedo, normal.as_vec3()));
        }
        Some(Self { lobes, normal })
    }

    fn total(&self) -> f64 {
        self.lobes.iter().map(|lobe| sum_of(lobe.scale) * lobe.power_integral()).sum()
    }

    /// `None` where rounding decides which lobe is drawn, or between tangents.
    fn drawn(&self, [choice, u, v]: [f64; 3]) -> Option<DVec3> {
        let total = self.total();
        let mut left = choice * total;
        let chosen = self.lobes.iter().find(|lobe| {
            left -= sum_of(lobe.scale) * lobe.power_integral();
            left < 1e-5 * total
        });
        let lobe = chosen.filter(|_| left.abs() > 1e-5 * total)?;
        let one_minus_cosine = -((-u).ln_1p() / (f64::from(lobe.exponent) + 1.0)).exp_m1();
        about(lobe.axis.as_dvec3().normalize(), one_minus_cosine, v)
    }

    /// Reflectance and density.
    fn along(&self, direction: DVec3) -> [f64; 4] {
        let sum = |value: &dyn Fn(&Lobe) -> DVec3| self.lobes.iter().map(value).sum::<DVec3>();
        let reflectance = sum(&|lobe| lobe.shape(self.normal, direction) * lobe.scale.as_dvec3());
        let powers = sum(&|lobe| lobe.power(direction) * lobe.scale.as_dvec3());
        reflectance.extend(powers.element_sum() / self.total()).to_array()
    }

    /// The most that [`Self::along`] could give.
    fn most(&self) -> [f64; 4] {
        let sum = self.lobes.iter().map(|lobe| lobe.scale.as_dvec3()).sum::<DVec3>();
        DVec3::splat(sum.max_element()).extend(sum.element_sum() / self.total()).to_array()
    }

    /// A direction above the horizon, mostly near the axis of a lobe.
    fn direction(&self, number: usize, random: &mut Pcg64Mcg) -> DVec3 {
        let near = self
            .lobes
            .get(number % 6)
            .map_or(DVec3::ZERO, |lobe| lobe.axis.as_dvec3() * f64::from(lobe.exponent).sqrt());
        let found = (near + direction(random)).normalize();
        let up = found.dot(self.normal);
        (if up < 0.0 { found - 2.0 * up * self.normal } else { found }).as_vec3().as_dvec3()
    }
}

/// Directions drawn by lobes, and what is reflected along others.
pub(super) fn reflector(gpu: &Arc<Gpu>) -> Result<(), Failed> {
    let mut random = Pcg64Mcg::seed_from_u64(32);
    let shader = "ray_traced/reflector.wgsl";
    let mut scene = glossy_scene(&mut random);
    scene.camera.eye = Vec3::new(1.5, 1.25, -1.0);
    let receivers: Vec<PlacedReceiver> =
        (0..CALLS).map(|i| PlacedReceiver::random(i % scene.objects.len(), i, &mut random)).collect();
    let (placed, rays) = (ReceiverBuffers::new(&receivers, &scene), ray_buffers(&scene.frame(0))?);
    // As many buffers as a device binds.
    let [frame, _, _, rows] = ray_variables(&rays);
    let variables: Vec<Variable<'_>> = placed.variables().into_iter().chain([frame, rows]).collect();
    let reflectors: Vec<Option<Reflector>> =
        receivers.iter().map(|receiver| Reflector::new(receiver, &scene)).collect();
    let calls: Vec<([f64; 3], DVec3)> = (reflectors.iter().enumerate())
        .map(|(i, reflector)| {
            let numbers =
                std::array::from_fn(|k| single(if (i >> k) % 64 == 0 { 0.0 } else { random.random_range(0.0..1.0) }));
            (numbers, reflector.as_ref().map_or(DVec3::Y, |reflector| reflector.direction(i, &mut random)))
        })
        .collect();
    let inputs: Vec<[f32; 4]> = (calls.iter())
        .flat_map(|(numbers, direction)| [DVec3::from(*numbers), *direction])
        .map(|row| row.extend(0.0).as_vec4().to_array())
        .collect();
    let body = "let receiver = receiver_at(number);
        var reflector = reflector_of(number, receiver);
        if (reflector.count > 0u) {
            output[0] = vec4f(reflected_direction(&reflector, input[0].x, input[0].y, input[0].z), f32(reflector.count));
            let reflected = reflected_along(&reflector, receiver.normal, input[1].xyz);
            output[1] = vec4f(reflected.reflectance, reflected.density);
            output[2].x = reflector.total;
        }";
    let found =
        Probe { shader, bands: None, constants: &[], rows: [2, 3], body, variables: &variables }.call(gpu, &inputs)?;
    finite(&found)?;
    let (mut kept, mut expected) = (Vec::new(), Vec::new());
    for ((rows, reflector), (numbers, direction)) in found.as_chunks::<3>().0.iter().zip(&reflectors).zip(&calls) {
        let Some(reflector) = reflector else { continue };
        let count = reflector.lobes.len() as f64;
        let Some(drawn) = (if count > 0.0 { reflector.drawn(*numbers) } else { Some(DVec3::ZERO) }) else { continue };
        // As shares of what they may be.
        let most = if count > 0.0 { reflector.most() } else { [1.0; 4] };
        let total = if count > 0.0 { reflector.total() } else { 1.0 };
        kept.push([rows[0][0], rows[0][1], rows[0][2], rows[0][3] / 5.0]);
        kept.push(std::array::from_fn(|k| rows[1][k] / most[k] as f32));
        kept.push([rows[2][0] / total as f32, 0.0, 0.0, 0.0]);
        expected.extend(drawn.extend(count / 5.0).to_array());
        let along = if count > 0.0 { reflector.along(*direction) } else { [0.0; 4] };
        expected.extend((0..4).map(|k| along[k] / most[k]));
        expected.push(if count > 0.0 { 1.0 } else { 0.0 });
    }
    if kept.len() < 3 * CALLS * 9 / 10 {
        return Err(format!("only {} calls are beyond doubt", kept.len() / 3).into());
    }
    compare("lobes", tolerance(shader), &kept, &expected, 9)
}
