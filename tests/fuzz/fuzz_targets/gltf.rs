#![no_main]
//! glTF files, whose buffers and images are data URIs or lie beside them: at rest and animated.

use halfshade_fuzz::{check_gltf, file};
use libfuzzer_sys::fuzz_target;

fuzz_target!(|bytes: &[u8]| check_gltf(&file("x.gltf", bytes)));
