#![no_main]
//! GLB files: at rest and animated.

use halfshade_fuzz::{check_gltf, file};
use libfuzzer_sys::fuzz_target;

fuzz_target!(|bytes: &[u8]| check_gltf(&file("x.glb", bytes)));
