#![no_main]
//! Scene files of Mitsuba; meshes and light probes lie beside them.

use halfshade_fuzz::{beside, check_scene, file};
use halfshade_scene::exchange::mitsuba;
use libfuzzer_sys::fuzz_target;

fuzz_target!(|bytes: &[u8]| {
    beside();
    if let Ok(scene) = mitsuba::load(&file("x.xml", bytes)) {
        check_scene(&scene);
    }
});
