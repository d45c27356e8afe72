#![no_main]
//! Scene files of pbrt; meshes and light probes lie beside them.

use halfshade_fuzz::{beside, check_scene, file};
use halfshade_scene::exchange::pbrt;
use libfuzzer_sys::fuzz_target;

fuzz_target!(|bytes: &[u8]| {
    beside();
    if let Ok(scene) = pbrt::load(&file("x.pbrt", bytes)) {
        check_scene(&scene);
    }
});
