//! Light that meshes hide from themselves and from each other, against the truth.

use crate::common::shaded;
use glam::Vec3;
use halfshade_scene::{
    Environment, Mesh, Motion, Object, Pose, ReceiverBuffer, Scene, Sphere, SphereLight, SphereSet, builtin::shapes,
    progress::Silent,
};
use halfshade_strategies::Mask;
use halfshade_truth::{Options, Tracer, estimate};

/// Error relative to the mean of the truth.
fn error(scene: &Scene, receivers: &ReceiverBuffer, settings: &str) -> f32 {
    let frame = scene.frame(0);
    let found = shaded(&Mask, scene, &frame, receivers, settings);
    let options = Options { samples: 512, ..Options::default() };
    let truth = estimate(&Tracer::new(&frame), receivers.view(), &options, &Silent).radiance;
    let (mut squares, mut sum) = (0.0, 0.0);
    for i in 0..receivers.len() {
        squares += (found.at(i).x - truth.at(i).x).powi(2);
        sum += truth.at(i).x;
    }
    (squares / receivers.len() as f32).sqrt() / (sum / receivers.len() as f32)
}

fn with_sphere(mesh: Mesh, radius: f32) -> Object {
    let spheres = vec![Sphere { center: Vec3::ZERO, radius }];
    Object::new("object", mesh).spheres(SphereSet { spheres, ..SphereSet::default() })
}

/// A ring whose inner half sees itself: its mesh knows, its bounding sphere doesn't.
#[test]
fn a_mesh_hides_light_from_itself() {
    let ring = with_sphere(shapes::torus(1.0, 0.4, 40, 24), 1.4);
    let scene = Scene::at_rest("ring", vec![ring], Environment::constant(Vec3::ONE));
    let receivers = ReceiverBuffer::vertices(&scene.frame(0));
    let (baked, spheres) = (error(&scene, &receivers, "directions=256"), error(&scene, &receivers, "own=spheres"));
    assert!(baked < 0.03 && spheres > 2.0 * baked, "{baked} {spheres}");
}

/// A ball over a slab: the slab darkens the ball from below, the ball the slab from above; under a sky and a lamp.
#[test]
fn a_ground_and_a_ball_hide_light_from_each_other() {
    let ground = Object::new("ground", shapes::slab(Vec3::new(2.0, 0.1, 2.0), [12, 12]))
        .pose(Pose::from_translation(Vec3::new(0.0, -0.1, 0.0)));
    let ball = with_sphere(shapes::sphere(16), 1.0).pose(Pose { scale: 0.5, ..Pose::from_translation(0.7 * Vec3::Y) });
    let mut scene = Scene::at_rest("ball", vec![ground, ball], Environment::constant(Vec3::ONE));
    for bound in [0.04, 0.05] {
        let receivers = ReceiverBuffer::vertices(&scene.frame(0));
        let found = error(&scene, &receivers, "directions=256");
        assert!(found < bound, "{found}");
        let lamp = SphereLight { center: Vec3::new(1.0, 3.0, 0.5), radius: 0.5, radiance: Vec3::splat(30.0) };
        scene.environment = Environment::constant(Vec3::ZERO);
        scene.lights = vec![(lamp, Motion::Still(Pose::IDENTITY))];
    }
}
