//! Scenes that move as a whole, and light that turns.

use crate::{
    common::{baked, shade},
    prt::scenes::{limited_light, torus_over_ground},
};
use glam::{Quat, Vec3};
use halfshade_scene::{Motion, Pose, RadianceBuffer, ReceiverBuffer, progress::Silent};
use halfshade_strategies::Prt;
use halfshade_strategy::{Strategy, StrategyError};

fn assert_same(found: &RadianceBuffer, expected: &RadianceBuffer, tolerance: f32) {
    for i in 0..found.channels[0].len() {
        let error = (found.at(i) - expected.at(i)).abs().max_element();
        assert!(error < tolerance * expected.at(i).max_element().max(0.1), "{i}: {} {}", found.at(i), expected.at(i));
    }
}

#[test]
fn everything_moved_together_looks_the_same() {
    let scene = torus_over_ground(limited_light(4, 11), [Vec3::new(0.8, 0.4, 0.3), Vec3::ONE]);
    let frame = scene.frame(0);
    let mut baked = baked(&Prt::default(), &scene, "directions=64");
    let before = shade(baked.as_mut(), &frame, &ReceiverBuffer::vertices(&frame));
    for (scale, turn) in
        [(1.0, Quat::from_rotation_y(2.0)), (3.0, Quat::from_axis_angle(Vec3::new(0.6, 0.0, 0.8), 1.1))]
    {
        let outer = Pose { scale, rotation: turn, translation: Vec3::new(3.0, -2.0, 5.0) };
        let mut moved = frame.clone();
        moved.world_from_object.iter_mut().for_each(|pose| *pose = pose.then(&outer));
        moved.world_from_environment = turn;
        let after = shade(baked.as_mut(), &moved, &ReceiverBuffer::vertices(&moved));
        assert_same(&after, &before, 1e-5);
        // The scene alone: as if the light were turned the other way.
        moved.world_from_environment = Quat::IDENTITY;
        let scene_turned = shade(baked.as_mut(), &moved, &ReceiverBuffer::vertices(&moved));
        let mut light_turned = frame.clone();
        light_turned.world_from_environment = turn.conjugate();
        let expected = shade(baked.as_mut(), &light_turned, &ReceiverBuffer::vertices(&light_turned));
        assert_same(&scene_turned, &expected, 1e-5);
        assert_ne!(scene_turned, after);
    }
}

/// A map turned by whole texels is another map, and must look as the first one turned.
#[test]
fn turned_light_is_the_light_turned() {
    let environment = limited_light(4, 12);
    let scene = torus_over_ground(environment.clone(), [Vec3::ONE; 2]);
    let halfshade_scene::light::DistantLight::Map(map) = &environment.base else { panic!("a map") };
    let (width, height) = (map.width(), map.height());
    // A turn about +Y by a quarter moves -Z to -X, which is a quarter of the columns to the left.
    let texels = (0..width * height).map(|i| map.texels()[i / width * width + (i + width / 4) % width]).collect();
    let turned_map = halfshade_scene::light::EnvironmentMap::new(width, height, texels).unwrap();
    let other = torus_over_ground(halfshade_scene::Environment::map(turned_map), [Vec3::ONE; 2]);
    let mut baked = baked(&Prt::default(), &scene, "directions=64");
    let mut frame = scene.frame(0);
    let receivers = ReceiverBuffer::vertices(&frame);
    frame.world_from_environment = Quat::from_rotation_y(std::f32::consts::FRAC_PI_2);
    let turned = shade(baked.as_mut(), &frame, &receivers);
    let expected = shade(baked.as_mut(), &other.frame(0), &receivers);
    assert_same(&turned, &expected, 1e-4);
}

#[test]
fn what_moves_against_the_rest_is_refused() {
    let mut scene = torus_over_ground(limited_light(2, 1), [Vec3::ONE; 2]);
    let Motion::Still(pose) = scene.objects[1].motion.clone() else { panic!("still") };
    scene.frame_count = 10;
    let moved = Pose { translation: pose.translation + 0.1 * Vec3::Y, ..pose };
    scene.objects[1].motion = Motion::Keyframes(vec![(0.1, pose), (0.2, moved)]);
    let strategy = Prt::default();
    let error = strategy.bake(&scene, &strategy.info().defaults(), &Silent).err().expect("refused");
    let StrategyError::Unsupported(reason) = error else { panic!("{error}") };
    assert!(reason.contains("`torus` moves against `ground` by frame 4") && reason.contains("ray-traced"), "{reason}");
    // Baked at rest, a frame that isn't is refused as well.
    scene.objects[1].motion = Motion::Still(pose);
    let mut baked = baked(&strategy, &scene, "directions=16");
    let mut frame = scene.frame(0);
    frame.world_from_object[1] = moved;
    assert!(matches!(baked.prepare(&frame), Err(StrategyError::Unsupported(_))));
    frame.world_from_object.pop();
    assert!(matches!(baked.prepare(&frame), Err(StrategyError::Failed(_))));
}
