//! Strategies, lights and a scene that all tests share.

use crate::cached_fields::shadow_fields;
use crate::common::{baked, shade};
use glam::{Quat, Vec3};
use halfshade_scene::{
    Camera, Environment, Mesh, Motion, Object, Pose, RadianceBuffer, ReceiverBuffer, Reflectance, Scene, Sphere,
    SphereLight, SphereSet,
    builtin::shapes,
    light::{DistantLight, EnvironmentMap, Sun},
};
use halfshade_strategies::{CosineLobe, RayTraced, ShExp, ShadowField, Unshadowed};
use halfshade_strategy::{Baked, Effect, Strategy};
use std::{cell::RefCell, sync::Arc};

/// A strategy with its settings.
pub(super) struct Variant {
    pub(super) strategy: Box<dyn Strategy>,
    pub(super) settings: &'static str,
    /// Distance that two estimates of the same by rays may have, relative to the mean.
    pub(super) noise: f32,
    /// Baked for the objects of [`still_life`].
    known: RefCell<Option<Box<dyn Baked>>>,
}

impl Variant {
    pub(super) fn new(strategy: impl Strategy + 'static, settings: &'static str) -> Self {
        Self { strategy: Box::new(strategy), settings, noise: 0.0, known: RefCell::default() }
    }

    pub(super) fn name(&self) -> String {
        format!("{}:{}", self.strategy.info().name, self.settings)
    }

    pub(super) fn models(&self, effect: Effect) -> bool {
        self.strategy.info().effects.contains(effect)
    }

    /// Baked for a scene, whatever was baked before.
    pub(super) fn baked(&self, scene: &Scene) -> Box<dyn Baked> {
        baked(self.strategy.as_ref(), scene, self.settings)
    }

    pub(super) fn shade(&self, scene: &Scene, receivers: &ReceiverBuffer) -> RadianceBuffer {
        shade(self.baked(scene).as_mut(), &scene.frame(0), receivers)
    }

    /// The objects of [`still_life`] in other light or places: baked once.
    pub(super) fn shade_lit(&self, scene: &Scene, receivers: &ReceiverBuffer) -> RadianceBuffer {
        let mut known = self.known.borrow_mut();
        let baked = known.get_or_insert_with(|| self.baked(&still_life()));
        shade(baked.as_mut(), &scene.frame(0), receivers)
    }
}

/// All strategies. What shadow fields trace of a mesh is kept for other tests.
pub(super) fn variants() -> Vec<Variant> {
    variants_with(shadow_fields)
}

/// All strategies, for tests of what baking may depend on: shadow fields trace every mesh of every scene anew.
pub(super) fn variants_baked_anew() -> Vec<Variant> {
    variants_with(ShadowField::default)
}

fn variants_with(fields: fn() -> ShadowField) -> Vec<Variant> {
    let mut all = vec![
        Variant::new(Unshadowed, ""),
        Variant { noise: 0.25, ..Variant::new(RayTraced, "unfiltered,samples=256") },
        Variant::new(ShExp, "bounces=0,normals=16,own-directions=32"),
        Variant::new(ShExp, "bounces=0,exp=product,normals=16,own-directions=32"),
    ];
    all.extend(fields_and_lobes_with(fields));
    all
}

/// Shadow fields and cosine lobes.
pub(super) fn fields_and_lobes() -> Vec<Variant> {
    fields_and_lobes_with(shadow_fields)
}

fn fields_and_lobes_with(fields: fn() -> ShadowField) -> Vec<Variant> {
    vec![
        Variant::new(fields(), "shells=6,resolution=4,map=24"),
        Variant::new(fields(), "shells=6,resolution=4,map=24,own=projected"),
        Variant::new(fields(), "basis=haar,face=8,shells=6,resolution=4,kept=0.1"),
        Variant::new(fields(), "basis=haar,face=8,shells=6,resolution=4,kept=0.1,product=wavelets"),
        Variant::new(CosineLobe, ""),
        Variant::new(CosineLobe, "order=published,leaves=aggressive,fit=least-squares,product=published"),
        Variant::new(CosineLobe, "share=0.05"),
    ]
}

pub(super) fn object(mesh: Mesh, set: Option<SphereSet>, pose: Pose) -> Object {
    let object = Object::new("object", mesh).albedo(Vec3::splat(0.8)).cluster_count(1).pose(pose);
    if let Some(set) = set { object.spheres(set) } else { object }
}

/// A ball whose spheres are exact up to its facets.
pub(super) fn ball(pose: Pose) -> Object {
    let set = SphereSet { spheres: vec![Sphere { center: Vec3::ZERO, radius: 1.0 }], ..SphereSet::default() };
    object(shapes::sphere(12), Some(set), pose)
}

pub(super) fn at(translation: Vec3, scale: f32) -> Pose {
    Pose { translation, scale, ..Pose::IDENTITY }
}

/// Two balls over a ground of more vertices than its neighbours have, and a camera before them.
pub(super) fn still_life() -> Scene {
    let objects = vec![
        object(shapes::plane(40), None, at(Vec3::ZERO, 3.0)),
        ball(at(Vec3::new(0.0, 0.8, 0.0), 0.5)),
        ball(Pose { rotation: Quat::from_rotation_z(0.4), ..at(Vec3::new(1.1, 0.5, 0.6), 0.3) }),
    ];
    let camera =
        Camera { eye: Vec3::new(0.0, 4.0, 5.0), target: Vec3::ZERO, vertical_fov_degrees: 45.0, resolution: [32, 24] };
    Scene { camera, ..Scene::at_rest("still life", objects, Environment::constant(Vec3::ZERO)) }
}

pub(super) fn shiny(object: &mut Object) {
    object.material.reflectance = Reflectance::ModifiedPhong { specular: Vec3::splat(0.15), exponent: 6.0 };
}

pub(super) fn lamp(center: Vec3, radius: f32, radiance: Vec3) -> (SphereLight, Motion) {
    (SphereLight { center, radius, radiance }, Motion::Still(Pose::IDENTITY))
}

fn map(strength: Vec3) -> Environment {
    let texels = (0..32 * 16).map(|i| {
        let (u, v) = ((i % 32) as f32 / 32.0, (i / 32) as f32 / 16.0);
        strength * (0.2 + (1.0 - v) * (std::f32::consts::TAU * u).sin().powi(2) + if i == 100 { 40.0 } else { 0.0 })
    });
    let map = EnvironmentMap::new(32, 16, texels.collect()).unwrap();
    Environment { base: DistantLight::Map(Arc::new(map)), sun: None }
}

/// Every kind of light on its own, `strength` times as bright.
pub(super) fn lights(strength: Vec3) -> Vec<(&'static str, Scene)> {
    let lit = |environment, lights| Scene { environment, lights, ..still_life() };
    let sun = Sun { direction: Vec3::new(-0.4, 0.8, -0.2).normalize(), angular_radius: 0.1, radiance: 30.0 * strength };
    let dark = || Environment::constant(Vec3::ZERO);
    let near = lamp(Vec3::new(-1.5, 3.0, -0.5), 0.3, 40.0 * strength);
    let far = lamp(Vec3::new(-150.0, 300.0, -50.0), 30.0, 40.0 * strength);
    vec![
        ("constant", lit(Environment::constant(strength), vec![])),
        ("map", lit(map(strength), vec![])),
        ("sun", lit(Environment { sun: Some(sun), ..dark() }, vec![])),
        ("near lamp", lit(dark(), vec![near.clone()])),
        ("far lamp", lit(dark(), vec![far.clone()])),
        ("all", lit(Environment { sun: Some(sun), ..map(strength) }, vec![near, far])),
    ]
}

/// Whether a strategy models a scene's light.
pub(super) fn models(variant: &Variant, scene: &Scene) -> bool {
    scene.lights.is_empty() || variant.models(Effect::LocalLights)
}

pub(super) fn mean(radiance: &RadianceBuffer) -> f32 {
    let channels = radiance.channels.iter().flatten();
    channels.map(|value| value.abs() / (3 * radiance.len()) as f32).sum()
}

/// Largest and root mean square difference, relative to the mean of `b`.
pub(super) fn apart(a: &RadianceBuffer, b: &RadianceBuffer) -> [f32; 2] {
    let scale = mean(b).max(f32::MIN_POSITIVE);
    let off = || a.channels.iter().flatten().zip(b.channels.iter().flatten()).map(|(a, b)| (a - b).abs() / scale);
    let worst = off().fold(0.0, |worst: f32, off| if off.is_nan() { f32::INFINITY } else { worst.max(off) });
    [worst, (off().map(|off| off * off).sum::<f32>() / (3 * a.len()) as f32).sqrt()]
}

/// Every so-manieth vertex, with its own number.
pub(super) fn some_vertices(scene: &Scene, step: usize) -> ReceiverBuffer {
    let all = ReceiverBuffer::vertices(&scene.frame(0));
    let places: Vec<u32> = (0..all.len() as u32).step_by(step).collect();
    ReceiverBuffer::gathered(all.view(), &places)
}
