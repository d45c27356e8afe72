#![no_main]
//! Scene files; meshes and light probes lie beside them.

use halfshade_fuzz::{beside, check_scene, file};
use halfshade_scene::file as scene_file;
use libfuzzer_sys::fuzz_target;

fuzz_target!(|bytes: &[u8]| {
    beside();
    if let Ok(scene) = scene_file::load(&file("x.toml", bytes)) {
        check_scene(&scene);
    }
});
