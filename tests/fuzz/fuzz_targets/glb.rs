#![no_main]
//! GLB files: at rest and animated.

use halfshade_fuzz::{check_mesh, file};
use halfshade_scene::mesh::{self, Animation};
use libfuzzer_sys::fuzz_target;

fuzz_target!(|bytes: &[u8]| {
    let path = file("x.glb", bytes);
    if let Ok((mesh, _)) = mesh::load_with_notes(&path) {
        check_mesh(&mesh);
    }
    if let Ok((mesh, skin)) = mesh::load_animated(&path, &Animation::Number(0)) {
        check_mesh(&mesh);
        for time in [0.0, 0.3, 1e3] {
            let Some(skin) = &skin else { break };
            let deformed = skin.deform(&mesh, time);
            assert!(deformed.positions.iter().chain(&deformed.normals).all(|v| v.is_finite()));
        }
    }
});
