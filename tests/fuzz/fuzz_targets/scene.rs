#![no_main]
//! Scene files; meshes and light probes lie beside them.

use halfshade_fuzz::{beside, check_map, file};
use halfshade_scene::{file as scene_file, light::DistantLight};
use libfuzzer_sys::fuzz_target;

fuzz_target!(|bytes: &[u8]| {
    beside();
    let Ok(scene) = scene_file::load(&file("x.toml", bytes)) else { return };
    for index in [0, scene.frame_count - 1] {
        let frame = scene.frame(index);
        assert_eq!(frame.world_from_object.len(), scene.objects.len());
        for (number, pose) in frame.world_from_object.iter().enumerate() {
            let placed = frame.positions(number).iter().map(|position| pose.transform_point(*position));
            assert!(placed.into_iter().all(|position| position.is_finite()));
        }
        assert!(frame.lights.iter().all(|light| light.center.is_finite() && light.radius > 0.0));
    }
    if let DistantLight::Map(map) = &scene.environment.base {
        check_map(map);
    }
});
