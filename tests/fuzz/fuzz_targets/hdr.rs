#![no_main]
//! Radiance HDR files as light probes: as they are, and turned, with a largest radiance.

use halfshade_fuzz::{check_map, file};
use halfshade_scene::light::{ProbeOptions, load_probe};
use libfuzzer_sys::fuzz_target;

fuzz_target!(|bytes: &[u8]| {
    let path = file("x.hdr", bytes);
    let turned = ProbeOptions { forward_degrees: 100.0, clamp: Some(1e6), ..ProbeOptions::default() };
    for options in [ProbeOptions::default(), turned] {
        if let Ok((map, _)) = load_probe(&path, &options) {
            check_map(&map);
        }
    }
});
