//! The clause about glossy reflectance, with every model's formula written out here once more.

use super::bounds::{Bounds, Checked, Violation, violation};
use super::{render::frame_of, scenes};
use crate::{Effect, Effects, Params, Strategy, StrategyError};
use glam::{DVec3, Vec3};
use halfshade_scene::{
    Environment, Frame, LafortuneLobe, Material, Motion, Pose, ReceiverBuffer, Reflectance, Scene, SphereLight,
    progress::Silent,
};
use std::{
    f64::consts::{PI, TAU},
    sync::OnceLock,
};

const EXPONENT: f64 = 15.0;

/// Receivers per model.
const PLACES: usize = 29;

/// A model, and its integrand towards the eye for normal, direction of the eye, and direction of light: no diffuse part.
type Model = (Reflectance, fn(DVec3, DVec3, DVec3) -> f64);

fn models() -> [Model; 3] {
    let exponent = EXPONENT as f32;
    fn mirrored(n: DVec3, o: DVec3, v: DVec3) -> f64 {
        (2.0 * n.dot(o) * n - o).dot(v).max(0.0).powf(EXPONENT)
    }
    // Equal along the surface, so that it doesn't matter where tangents point.
    let lobe = LafortuneLobe { scale: Vec3::ONE, axis: Vec3::new(0.9, 0.9, 1.0), exponent };
    [
        (Reflectance::Phong { specular: Vec3::splat(0.5), exponent }, |n, o, v| 0.5 * mirrored(n, o, v)),
        (Reflectance::ModifiedPhong { specular: Vec3::splat(0.5), exponent }, |n, o, v| {
            0.5 * (EXPONENT + 2.0) / TAU * n.dot(v) * mirrored(n, o, v)
        }),
        (Reflectance::Lafortune { lobes: vec![lobe] }, |n, o, v| {
            let along = (o - n.dot(o) * n).dot(v - n.dot(v) * n);
            (0.9 * along + n.dot(v) * n.dot(o)).max(0.0).powf(EXPONENT) * n.dot(v)
        }),
    ]
}

/// Light of a case.
#[derive(Debug, Clone, Copy)]
enum Light {
    Constant,
    Map,
    Lamp,
}

/// Expected radiance by model and [`Light`], the same for all strategies: quadrature takes longer than most of them do.
static EXPECTED: [[OnceLock<Vec<DVec3>>; 3]; 3] = [const { [const { OnceLock::new() }; 3] }; 3];

/// ∫ f over the hemisphere of `normal` for light from infinitely far, by the midpoint rule; caps of local lights apart.
fn quadrature(frame: &Frame<'_>, position: Vec3, normal: DVec3, f: impl Fn(DVec3) -> f64) -> DVec3 {
    let (rings, spokes) = (160, 320);
    let around = |axis: DVec3, height: f64, each: &dyn Fn(DVec3) -> DVec3| -> DVec3 {
        let (t, b) = axis.any_orthonormal_pair();
        let mut sum = DVec3::ZERO;
        for ring in 0..rings {
            let below = height * (f64::from(ring) + 0.5) / f64::from(rings);
            let across = (below * (2.0 - below)).sqrt();
            for spoke in 0..spokes {
                let (y, x) = (TAU * (f64::from(spoke) / f64::from(spokes) + 0.618_034 * f64::from(ring))).sin_cos();
                sum += each(across * (x * t + y * b) + (1.0 - below) * axis);
            }
        }
        sum * TAU * height / f64::from(rings * spokes)
    };
    let distant = |v: DVec3| f(v) * frame.environment_radiance(v.as_vec3()).as_dvec3();
    let mut radiance = around(normal, 1.0, &distant);
    for SphereLight { center, radius, radiance: emitted } in &frame.lights {
        let offset = (*center - position).as_dvec3();
        let sine_squared = (f64::from(*radius) / offset.length()).powi(2);
        let height = sine_squared / (1.0 + (1.0 - sine_squared).sqrt());
        let above = |v: DVec3| if normal.dot(v) > 0.0 { f(v) * emitted.as_dvec3() } else { DVec3::ZERO };
        radiance += around(offset.normalize(), height, &above);
    }
    radiance
}

/// Who claims glossy reflectance gives what quadrature gives, without blockers, within [`Bounds::gloss`]; of who doesn't,
/// a glossy scene is known to ask too much.
pub fn gloss_is_modelled_or_refused(strategy: &dyn Strategy, params: &Params, bounds: &Bounds) -> Checked {
    let effects = strategy.info().effects;
    let models = models();
    if !effects.contains(Effect::GlossyReflectance) {
        let asks_for_it = |model| {
            let missing = effects.missing(Effects::required_by(&glossy(&[model])));
            missing.contains(Effect::GlossyReflectance)
        };
        return match models.iter().all(asks_for_it) {
            true => Ok(()),
            false => violation("a glossy scene seems to ask nothing that it can't model".into()),
        };
    }
    // Together, so that light is baked once for all of them; alone where one of them is refused.
    let all: Vec<(usize, &Model)> = models.iter().enumerate().collect();
    if check(strategy, params, bounds, &all)? == Answer::Refused {
        for model in &all {
            check(strategy, params, bounds, &[*model])?;
        }
    }
    Ok(())
}

/// Answer of a strategy to a glossy scene, with its parameters.
#[derive(PartialEq)]
enum Answer {
    Modelled,
    Refused,
}

/// A scene of one speck per model.
fn glossy(models: &[&Model]) -> Scene {
    let mut scene = scenes::spheres(scenes::map(), &[]);
    let speck = scene.objects.remove(0);
    scene.objects = models
        .iter()
        .map(|(model, _)| {
            let material = Material { reflectance: model.clone(), ..Material::default() };
            speck.clone().material(material)
        })
        .collect();
    scene.camera.eye = Vec3::new(0.5, 3.0, 1.0);
    scene
}

/// The same places and normals for each of so many specks.
fn receivers(specks: usize) -> ReceiverBuffer {
    let places = scenes::receivers(PLACES);
    let numbers: Vec<u32> = (0..PLACES as u32).cycle().take(specks * PLACES).collect();
    let mut all = ReceiverBuffer::gathered(places.view(), &numbers);
    all.object.iter_mut().enumerate().for_each(|(i, object)| *object = (i / PLACES) as u32);
    all
}

/// Numbered models in one scene under every light that the strategy knows.
fn check(
    strategy: &dyn Strategy,
    params: &Params,
    bounds: &Bounds,
    models: &[(usize, &Model)],
) -> Result<Answer, Violation> {
    let effects = strategy.info().effects;
    let scene = glossy(&models.iter().map(|(_, model)| *model).collect::<Vec<_>>());
    let mut cases = Vec::new();
    if effects.contains(Effect::EnvironmentLight) {
        cases.push((Light::Constant, Scene { environment: Environment::constant(Vec3::ONE), ..scene.clone() }));
        cases.push((Light::Map, scene.clone()));
    }
    if effects.contains(Effect::LocalLights) {
        let lights = vec![(scenes::lamp(), Motion::Still(Pose::IDENTITY))];
        cases.push((Light::Lamp, Scene { environment: Environment::constant(Vec3::ZERO), lights, ..scene }));
    }
    let receivers = receivers(models.len());
    for (light, scene) in &cases {
        let mut baked = match strategy.bake(scene, params, &Silent) {
            // It can, but not with these parameters, and says so.
            Err(StrategyError::Unsupported(_)) => return Ok(Answer::Refused),
            baked => baked.map_err(|error| Violation(format!("bake: {error}")))?,
        };
        let found = frame_of(baked.as_mut(), &scene.frame(0), &receivers)?;
        for (speck, (number, model)) in models.iter().enumerate() {
            let expected = EXPECTED[*number][*light as usize].get_or_init(|| expected(scene, model.1));
            let mean = expected.iter().map(|value| value.element_sum()).sum::<f64>() / (3 * PLACES) as f64;
            for (i, exact) in expected.iter().enumerate() {
                let found = found.at(speck * PLACES + i);
                let error = (found.as_dvec3() - *exact).abs().max_element();
                if error.is_nan() || error > f64::from(bounds.gloss) * mean {
                    let place = format!("model {number}, light {light:?}, receiver {i}");
                    return Err(Violation(format!("{place}: {found} instead of {exact}")));
                }
            }
        }
    }
    Ok(Answer::Modelled)
}

/// Radiance of every place by quadrature.
fn expected(scene: &Scene, integrand: fn(DVec3, DVec3, DVec3) -> f64) -> Vec<DVec3> {
    let receivers = scenes::receivers(PLACES);
    let frame = scene.frame(0);
    let view = receivers.view();
    (0..PLACES)
        .map(|i| {
            let (position, n) = (view.position_at(i), view.normal_at(i).as_dvec3().normalize());
            let o = (scene.camera.eye - position).as_dvec3().normalize();
            let gloss = |v: DVec3| if n.dot(o) > 0.0 { integrand(n, o, v) } else { 0.0 };
            let diffuse = quadrature(&frame, position, n, |v| n.dot(v) / PI) * view.albedo_at(i).as_dvec3();
            diffuse + quadrature(&frame, position, n, gloss)
        })
        .collect()
}
