//! Scenes at the extremes.

use crate::{
    lights,
    random::Random,
    shapes::{self, Shape},
};
use glam::{Affine3A, Quat, Vec3};
use halfshade_scene::{
    Camera, Environment, Frame, Joint, LafortuneLobe, Material, Motion, Object, Pose, Reflectance, Scene, Skin, Sphere,
    SphereSet,
};
use std::sync::Arc;

/// A scene and what is known of it.
#[derive(Clone)]
pub(crate) struct Drawn {
    pub(crate) seed: u64,
    pub(crate) scene: Scene,
    /// The frame that is looked at.
    pub(crate) frame: usize,
    /// Whether things touch, coincide or contain each other exactly, so that the last digit of a coordinate decides who
    /// hides what.
    pub(crate) is_touching: bool,
    /// Smallest extent of anything, in world units.
    pub(crate) feature: f32,
    /// Extent of the scene in world units: largest distance from `middle`.
    pub(crate) extent: f32,
    /// The origin of the scene before it was moved.
    pub(crate) middle: Vec3,
}

impl Drawn {
    pub(crate) fn new(seed: u64) -> Self {
        let random = &mut Random::new(seed);
        let mut drawn = arranged(random);
        drawn.seed = seed;
        lights::draw(&mut drawn.scene, random);
        if random.chance(0.3) {
            drawn.scene.bounces = random.below(5);
        }
        drawn.scene.camera = Camera {
            eye: random.between(0.5, 6.0) * random.direction(),
            target: Vec3::ZERO,
            vertical_fov_degrees: 45.0,
            resolution: [32, 24],
        };
        let scale = if random.chance(0.5) { random.log_between(1e-6, 1e6) } else { 1.0 };
        let far = if random.chance(0.3) { random.log_between(1.0, 1e3) } else { 0.0 };
        let translation = scale * far * random.direction();
        drawn.moved(&Pose { scale, rotation: Quat::IDENTITY, translation })
    }

    /// The same scene with objects, lamps and camera moved by `pose`; its environment stays, see [`Self::frame`].
    pub(crate) fn moved(&self, pose: &Pose) -> Self {
        let mut moved = self.clone();
        // A rotation is normalized, which rounds it anew.
        let one_then = |inner: &Pose| match pose.rotation == Quat::IDENTITY {
            true => Pose { rotation: inner.rotation, ..inner.then(pose) },
            false => inner.then(pose),
        };
        let then = |motion: &Motion| match motion {
            Motion::Still(inner) => Motion::Still(one_then(inner)),
            Motion::Keyframes(keys) => {
                Motion::Keyframes(keys.iter().map(|(time, inner)| (*time, one_then(inner))).collect())
            }
        };
        moved.scene.objects.iter_mut().for_each(|object| object.motion = then(&object.motion));
        moved.scene.lights.iter_mut().for_each(|(_, motion)| *motion = then(motion));
        let camera = &mut moved.scene.camera;
        (camera.eye, camera.target) = (pose.transform_point(camera.eye), pose.transform_point(camera.target));
        moved.middle = pose.transform_point(self.middle);
        (moved.feature, moved.extent) = (pose.scale * self.feature, pose.scale * self.extent);
        moved
    }

    /// Whether nothing moves.
    pub(crate) fn is_still(&self) -> bool {
        let mut motions =
            self.scene.objects.iter().map(|object| &object.motion).chain(self.scene.lights.iter().map(|(_, m)| m));
        motions.all(|motion| matches!(motion, Motion::Still(_)))
    }

    /// The frame that is looked at, its environment turned by `turn`.
    pub(crate) fn frame(&self, turn: Quat) -> Frame<'_> {
        let mut frame = self.scene.frame(self.frame);
        frame.world_from_environment = (turn * frame.world_from_environment).normalize();
        frame
    }

    /// How far rounding of coordinates moves things, as a fraction of the smallest of them.
    pub(crate) fn rounding(&self) -> f32 {
        let far = self.scene.lights.iter().map(|(light, motion)| light.moved(&motion.at(0.0)));
        let lamps = far.map(|light| light.center.length().min(10.0 * self.extent)).fold(0.0, f32::max);
        f32::EPSILON * (self.middle.length() + self.extent + lamps) / self.feature
    }

    /// The scene with one blocker more, after all others.
    pub(crate) fn with_blocker(&self, random: &mut Random) -> Self {
        let mut more = self.clone();
        let place = self.middle + self.extent * random.between(0.0, 1.0) * random.direction();
        let radius = self.extent * random.log_between(0.01, 0.5);
        let pose = Pose { scale: radius, ..Pose::from_translation(place) };
        more.scene.objects.push(object("blocker", &Arc::new(shapes::ball(2).mesh), &[UNIT], Motion::Still(pose)));
        more
    }

    /// All light multiplied.
    pub(crate) fn brighter(&self, factor: f32) -> Self {
        let mut brighter = self.clone();
        brighter.scene.environment = self.scene.environment.scaled(factor);
        brighter.scene.lights.iter_mut().for_each(|(light, _)| light.radiance *= factor);
        brighter
    }

    /// The scene without blockers; objects stay, so that receivers still have theirs.
    pub(crate) fn open(&self) -> Self {
        let mut open = self.clone();
        for object in &mut open.scene.objects {
            (object.mesh, object.skin) = (Arc::default(), None);
            (object.sphere_count, object.spheres) = (0, None);
        }
        open.scene.bounces = 0;
        open
    }
}

const UNIT: Sphere = Sphere { center: Vec3::ZERO, radius: 1.0 };

fn object(name: &str, mesh: &Arc<halfshade_scene::Mesh>, spheres: &[Sphere], motion: Motion) -> Object {
    let object = Object::new(name, mesh.clone()).motion(motion);
    if spheres.is_empty() {
        return object;
    }
    object.spheres(SphereSet { spheres: spheres.to_vec(), ..SphereSet::default() })
}

fn still(scale: f32, translation: Vec3) -> Motion {
    Motion::Still(Pose { scale, ..Pose::from_translation(translation) })
}

/// Objects within about a unit of the origin, without light.
fn arranged(random: &mut Random) -> Drawn {
    let mut objects = Vec::new();
    let (mut is_touching, mut feature, mut extent) = (false, 1.0_f32, 1.0_f32);
    if random.chance(0.6) {
        let ground = Arc::new(halfshade_scene::builtin::shapes::plane(3));
        let size = if random.chance(0.3) { random.log_between(10.0, 1e5) } else { random.between(1.0, 4.0) };
        let spheres = if random.chance(0.1) { vec![Sphere { radius: 1.5, ..UNIT }] } else { Vec::new() };
        objects.push(object("ground", &ground, &spheres, still(size, -Vec3::Y)));
        extent = extent.max(1.5 * size);
    }
    match random.below(8) {
        0 => {}
        // The same thing in the same place, many times.
        1 => {
            let shape = shapes::draw(random);
            let (mesh, motion) = (Arc::new(shape.mesh), still(random.between(0.2, 0.9), Vec3::ZERO));
            let count = random.pick(&[2, 8, 64]);
            let count = if mesh.positions.len() > 30 { count.min(8) } else { count };
            objects.extend((0..count).map(|_| object(shape.kind, &mesh, &shape.spheres, motion.clone())));
            feature = feature.min(shape.feature);
            is_touching = true;
        }
        // One on top of the other, and on the ground.
        2 => {
            let mut height = -1.0;
            for _ in 0..2 + random.below(3) {
                let (shape, scale) = (shapes::draw(random), random.pick(&[0.25, 0.5, 0.125]));
                let lowest = shape.mesh.bounds().map_or(0.0, |(low, _)| low.y);
                let highest = shape.mesh.bounds().map_or(0.0, |(_, high)| high.y);
                objects.push(placed(&shape, still(scale, Vec3::new(0.0, height - scale * lowest, 0.0))));
                height += scale * (highest - lowest);
                feature = feature.min(scale * shape.feature);
            }
            is_touching = true;
        }
        // One within the other.
        3 => {
            let shape = shapes::draw(random);
            let middle = 0.2 * random.direction();
            for scale in [1.0, 0.5, 0.25] {
                objects.push(placed(&shape, still(0.8 * scale, middle)));
            }
            feature = feature.min(0.2 * shape.feature);
            is_touching = true;
        }
        // Anything anywhere, of any size.
        kind => {
            let smallest = if kind == 4 { 1e-4 } else { 0.1 };
            for _ in 0..=random.below(5) {
                let (shape, scale) = (shapes::draw(random), random.log_between(smallest, 0.7));
                let place = random.between(0.0, 1.0) * random.direction();
                let rotation = random.rotation();
                let pose = Pose { scale, rotation, ..Pose::from_translation(place) };
                let mut object = placed(&shape, Motion::Still(pose));
                feature = feature.min(scale * shape.feature);
                if random.chance(0.2) {
                    let end = Pose { rotation: random.rotation(), ..Pose::from_translation(0.5 * random.direction()) };
                    object.motion = Motion::Keyframes(vec![(0.0, pose), (1.0, Pose { scale, ..end })]);
                }
                if random.chance(0.1) {
                    object.skin = Some(Arc::new(bent(&shape, random)));
                }
                objects.push(object);
            }
        }
    }
    for object in &mut objects {
        object.material = material(random);
        object.cluster_count = random.pick(&[0, 1, 3]);
    }
    let mut scene = Scene::at_rest("extreme", objects, Environment::constant(Vec3::ZERO));
    (scene.frames_per_sec, scene.frame_count) = (4.0, 5);
    Drawn { seed: 0, scene, frame: random.below(5), is_touching, feature, extent, middle: Vec3::ZERO }
}

fn placed(shape: &Shape, motion: Motion) -> Object {
    object(shape.kind, &Arc::new(shape.mesh.clone()), &shape.spheres, motion)
}

fn material(random: &mut Random) -> Material {
    let mut material = Material::new(random.color());
    let exponent = if random.chance(0.3) { 1e5 } else { random.log_between(1.0, 1e5) };
    let specular = (Vec3::ONE - material.albedo) * random.between(0.0, 1.0);
    material.reflectance = match random.below(12) {
        0 => Reflectance::Phong { specular: random.color(), exponent },
        1 => Reflectance::ModifiedPhong { specular, exponent },
        2 => {
            let axis = Vec3::new(-random.between(0.5, 1.0), -random.between(0.5, 1.0), random.between(0.5, 1.0));
            Reflectance::Lafortune { lobes: vec![LafortuneLobe { scale: specular, axis, exponent }] }
        }
        _ => Reflectance::Lambert,
    };
    material
}

/// Two joints about the middle, the upper of which turns and grows.
fn bent(shape: &Shape, random: &mut Random) -> Skin {
    let joint = |motion| Joint { parent: None, motion, joint_from_rest: Affine3A::IDENTITY };
    let end = Pose { rotation: random.rotation(), scale: random.between(0.3, 2.0), ..Pose::IDENTITY };
    let influences = (shape.mesh.positions.iter())
        .map(|p| {
            let upper = (0.5 + p.y).clamp(0.0, 1.0);
            [(0, 1.0 - upper), (1, upper), (0, 0.0), (0, 0.0)]
        })
        .collect();
    let turning = Motion::Keyframes(vec![(0.0, Pose::IDENTITY), (1.0, end)]);
    Skin { joints: vec![joint(Motion::Still(Pose::IDENTITY)), joint(turning)], influences, ..Skin::default() }
}
