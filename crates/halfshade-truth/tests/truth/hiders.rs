//! Hiders of the light, where they are plain to see.

use crate::scenes::{ball, object, on_the_ground, scene, square};
use glam::Vec3;
use halfshade_scene::{Environment, Pose, ReceiverBuffer, Scene, SphereLight, progress::Silent};
use halfshade_truth::{Hider, Tracer, hiders};

/// The ground, object 0, and a ball of radius 1 whose middle is 1.5 above it, object 1.
fn ball_over_ground(lights: Vec<SphereLight>, environment: Environment) -> Scene {
    let ground = object(square(8), Pose { scale: 30.0, ..Pose::IDENTITY });
    scene(vec![ground, ball(Vec3::new(0.0, 1.5, 0.0), 1.0)], environment, lights)
}

fn found(scene: &Scene, receivers: &ReceiverBuffer) -> Vec<Hider> {
    hiders(&Tracer::new(&scene.frame(0)), receivers.view(), &Silent)
}

fn at(position: Vec3, normal: Vec3, object: u32) -> ReceiverBuffer {
    let mut receivers = ReceiverBuffer::default();
    receivers.push(position, normal, Vec3::ONE, object);
    receivers
}

#[test]
fn under_a_sky_each_class_is_where_it_must_be() {
    let scene = ball_over_ground(Vec::new(), Environment::constant(Vec3::ONE));
    // A ball at distance d blocks (r/d)² of the irradiance of who faces it: all over 1/2.25 below it, below 2 % past 10.
    assert_eq!(
        found(&scene, &on_the_ground([(0.0, 0.0), (1.0, 0.0), (12.0, 0.0)])),
        [Hider::Other, Hider::Other, Hider::Nothing]
    );
    let on_ball = |normal: Vec3, object| found(&scene, &at(Vec3::new(0.0, 1.5, 0.0) + normal, normal, object))[0];
    assert_eq!(on_ball(Vec3::Y, 1), Hider::Nothing);
    assert_eq!(on_ball(Vec3::NEG_Y, 1), Hider::Ground);
    assert_eq!(on_ball(Vec3::X, 1), Hider::Ground);
    // The same ground, but the receiver's own.
    assert_eq!(on_ball(Vec3::NEG_Y, 0), Hider::Own);
    // Inside the ball nothing but itself is seen first.
    assert_eq!(found(&scene, &at(Vec3::new(0.0, 1.5, 0.0), Vec3::Y, 1)), [Hider::Own]);
}

#[test]
fn only_what_lies_before_a_lamp_hides_it() {
    let lamp = |y: f32| SphereLight { center: Vec3::new(0.0, y, 0.0), radius: 0.2, radiance: Vec3::ONE };
    let under = on_the_ground([(0.0, 0.0)]);
    let dark = Environment::constant(Vec3::ZERO);
    assert_eq!(found(&ball_over_ground(vec![lamp(4.0)], dark.clone()), &under), [Hider::Other]);
    assert_eq!(found(&ball_over_ground(vec![lamp(0.3)], dark.clone()), &under), [Hider::Nothing]);
    // Two lamps, of which the hidden one brings more light.
    let bright = SphereLight { radiance: Vec3::splat(1000.0), ..lamp(4.0) };
    assert_eq!(found(&ball_over_ground(vec![lamp(0.3), bright], dark.clone()), &under), [Hider::Other]);
    assert_eq!(found(&ball_over_ground(Vec::new(), dark), &under), [Hider::Nothing]);
}

#[test]
fn classes_are_the_same_on_one_thread_and_for_parts() {
    let scene = ball_over_ground(Vec::new(), Environment::constant(Vec3::ONE));
    let receivers = on_the_ground((0..200).map(|i| (0.1 * (i % 20) as f32, 0.3 * (i / 20) as f32)));
    let all = found(&scene, &receivers);
    let tracer = Tracer::new(&scene.frame(0));
    let parts: Vec<Hider> =
        [0..77, 77..200].into_iter().flat_map(|part| hiders(&tracer, receivers.view().slice(part), &Silent)).collect();
    assert_eq!(all, parts);
    let pool = rayon::ThreadPoolBuilder::new().num_threads(1).build().unwrap();
    assert_eq!(all, pool.install(|| found(&scene, &receivers)));
    let mut broken = ReceiverBuffer::default();
    broken.push(Vec3::NAN, Vec3::Y, Vec3::ONE, 0);
    assert_eq!(found(&scene, &broken), [Hider::Nothing]);
}
