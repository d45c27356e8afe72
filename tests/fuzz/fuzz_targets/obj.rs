#![no_main]
//! OBJ files.

use halfshade_fuzz::{check_mesh, file};
use halfshade_scene::mesh;
use libfuzzer_sys::fuzz_target;

fuzz_target!(|bytes: &[u8]| {
    if let Ok((mesh, _)) = mesh::load_with_notes(&file("x.obj", bytes)) {
        check_mesh(&mesh);
    }
});
