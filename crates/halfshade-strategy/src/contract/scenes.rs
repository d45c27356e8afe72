//! The scenes that strategies are held to their contract on.

use glam::{Quat, Vec3};
use halfshade_scene::{
    Environment, Frame, Motion, Object, Pose, ReceiverBuffer, Scene, Sphere, SphereLight, SphereSet,
    builtin::shapes,
    light::{DistantLight, EnvironmentMap, Sun},
};
use std::sync::Arc;

/// A speck far below everything, which belongs to every receiver and blocks nothing.
fn speck() -> Object {
    Object::new("speck", shapes::plane(1))
        .pose(Pose { scale: 1e-3, ..Pose::from_translation(Vec3::new(0.0, -40.0, 0.0)) })
}

/// A speck and unit spheres, moved and scaled; mesh and sphere set are the same but for the mesh's facets.
pub(super) fn spheres(environment: Environment, spheres: &[Sphere]) -> Scene {
    let mesh = Arc::new(shapes::sphere(12));
    let unit = SphereSet { spheres: vec![Sphere { center: Vec3::ZERO, radius: 1.0 }], ..SphereSet::default() };
    let set = Arc::new(unit);
    let mut objects = vec![speck()];
    objects.extend(spheres.iter().enumerate().map(|(number, sphere)| {
        Object::new(format!("sphere {number}"), mesh.clone())
            .spheres(set.clone())
            .pose(Pose { scale: sphere.radius, ..Pose::from_translation(sphere.center) })
    }));
    Scene::at_rest("contract", objects, environment)
}

/// A grey map of 16 by 8 texels that differ by a factor of six.
pub(super) fn map() -> Environment {
    let texels = (0..16 * 8).map(|i| Vec3::splat(0.5 + (i * 37 % 11) as f32 * 0.25));
    EnvironmentMap::new(16, 8, texels.collect()).map_or(Environment::constant(Vec3::ONE), Environment::map)
}

/// [`map`] in colours.
pub(super) fn coloured_map() -> Environment {
    let texels = (0..16 * 8).map(|i| Vec3::new(0.5 + (i % 5) as f32, 1.0, 0.3 + (i * 7 % 4) as f32));
    EnvironmentMap::new(16, 8, texels.collect()).map_or(Environment::constant(Vec3::ONE), Environment::map)
}

/// Constant light and a sun that gives as much again.
pub(super) fn sun() -> Environment {
    let angular_radius = 0.0465f32;
    let radiance = Vec3::splat(1.0 / angular_radius.sin().powi(2));
    let direction = Vec3::new(0.3, 0.8, -0.4).normalize();
    Environment { sun: Some(Sun { direction, angular_radius, radiance }), ..Environment::constant(Vec3::ONE) }
}

/// A lamp to one side.
pub(super) fn lamp() -> SphereLight {
    SphereLight { center: Vec3::new(2.0, 3.0, 1.0), radius: 0.7, radiance: Vec3::splat(8.0) }
}

/// The scene with three lamps around in the place of light from infinitely far; for an environment of constant radiance
/// x, lamps x times as bright.
pub(super) fn by_lamps(mut scene: Scene) -> Scene {
    let strength = match &scene.environment.base {
        DistantLight::Constant(radiance) => *radiance,
        DistantLight::Map(_) => Vec3::ONE,
    };
    scene.environment = Environment::constant(Vec3::ZERO);
    let large = SphereLight { center: Vec3::new(-3.0, 2.0, -2.0), radius: 1.8, radiance: Vec3::splat(2.0) };
    let small = SphereLight { center: Vec3::new(0.5, -4.0, 3.0), radius: 0.1, radiance: Vec3::splat(90.0) };
    let lamps = [lamp(), large, small].map(|lamp| SphereLight { radiance: lamp.radiance * strength, ..lamp });
    scene.lights.extend(lamps.map(|lamp| (lamp, Motion::Still(Pose::IDENTITY))));
    scene
}

/// Small numbers in [0, 1), evenly spread: multiples of an irrational number.
pub(super) fn spread(i: usize, step: f64) -> f32 {
    (i as f64 * step).fract() as f32
}

/// Receivers around the origin with normals all over the sphere; belonging to object 0.
pub(super) fn receivers(count: usize) -> ReceiverBuffer {
    let mut buffer = ReceiverBuffer::default();
    for i in 0..count {
        let y = 1.0 - (2.0 * i as f32 + 1.0) / count as f32;
        let (sin, cos) = (2.399_963 * i as f32).sin_cos();
        let across = (1.0 - y * y).sqrt();
        let place = [spread(i, 0.754_877_7), spread(i, 0.569_840_3), spread(i, 0.430_159_7)];
        let albedo = Vec3::new(0.9, 0.5 + 0.4 * spread(i, 0.3), 0.2);
        buffer.push(Vec3::from(place) - 0.5, Vec3::new(across * cos, y, across * sin).normalize(), albedo, 0);
    }
    buffer
}

/// Spheres around the receivers of [`receivers`], some of which they contain.
pub(super) fn crowd(count: usize) -> Vec<Sphere> {
    (0..count)
        .map(|i| {
            let place = Vec3::new(spread(i, 0.618_034), spread(i, 0.414_213_6), spread(i, 0.732_050_8));
            Sphere { center: (place - 0.5) * 3.5, radius: 0.15 + 0.4 * spread(i, 0.236_068) }
        })
        .collect()
}

/// The frame and its receivers, all turned about the origin.
pub(super) fn turned<'a>(frame: &Frame<'a>, receivers: &ReceiverBuffer, turn: Quat) -> (Frame<'a>, ReceiverBuffer) {
    let outer = Pose { rotation: turn, ..Pose::IDENTITY };
    let mut turned = frame.clone();
    turned.world_from_object.iter_mut().for_each(|pose| *pose = pose.then(&outer));
    turned.world_from_environment = (turn * frame.world_from_environment).normalize();
    turned.lights.iter_mut().for_each(|light| light.center = turn * light.center);
    let mut moved = receivers.clone();
    for i in 0..receivers.len() {
        let view = receivers.view();
        let (position, normal) = (turn * view.position_at(i), (turn * view.normal_at(i)).normalize());
        for axis in 0..3 {
            moved.position[axis][i] = position[axis];
            moved.normal[axis][i] = normal[axis];
        }
    }
    (turned, moved)
}
