//! Scenes held still look as the moving ones do at that frame.

use halfshade_scene::{RadianceBuffer, ReceiverBuffer, Scene, builtin, progress::Silent};
use halfshade_truth::{Options, Tracer, estimate};

/// The picture of a frame, and its receivers.
fn picture(scene: &Scene, frame: usize) -> (ReceiverBuffer, RadianceBuffer) {
    let frame = scene.frame(frame);
    let tracer = Tracer::new(&frame);
    let width = scene.camera.resolution[0] as usize;
    let mut receivers = ReceiverBuffer::default();
    for (pixel, hit) in tracer.primary_hits(&scene.camera).iter().enumerate() {
        let [column, row] = [pixel % width, pixel / width].map(|place| place as f32 + 0.5);
        if let Some(hit) = hit {
            receivers.add(&tracer.receiver_at(hit, scene.camera.ray_direction(column, row)));
        }
    }
    let options = Options { samples: 16, bounces: 1, ..Options::default() };
    let radiance = estimate(&tracer, receivers.view(), &options, &Silent).radiance;
    (receivers, radiance)
}

#[test]
fn built_in_scenes_held_still_look_the_same() {
    for (name, _) in builtin::SCENES {
        let mut scene = builtin::scene(name).unwrap();
        scene.camera.resolution = [16, 12];
        scene.environment_turn_per_sec = 0.5;
        let frame = scene.frame_count / 2;
        let still = picture(&scene.still_at(frame), 0);
        assert!(still.0.len() > 20, "{name}");
        assert_eq!(still, picture(&scene, frame), "{name}");
    }
}
