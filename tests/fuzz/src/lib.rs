//! Common parts of the fuzz targets.
//!
//! Targets go through the same doors as the program: a file at a path, and what lies beside it. A target fails when
//! something panics, hangs, takes more memory than it is given, or when what was read breaks a promise of its type.

mod cache;
mod journal;
pub mod seeds;

pub use cache::{cache_entry, cache_payloads, with_checksum};
pub use journal::{journal_header, with_checksums};

use halfshade_scene::{Environment, Scene, file as scene_file};
use halfshade_scene::light::{DistantLight, EnvironmentMap};
use halfshade_scene::mesh::{self, Animation, Mesh};
use std::{
    path::{Path, PathBuf},
    sync::{LazyLock, Once},
};
use tempfile::TempDir;

/// One folder per process, in TMPDIR.
static FOLDER: LazyLock<TempDir> = LazyLock::new(|| tempfile::tempdir().expect("a temporary folder"));

/// Writes `bytes` to a file of this name and gives its path.
pub fn file(name: &str, bytes: &[u8]) -> PathBuf {
    let path = FOLDER.path().join(name);
    std::fs::write(&path, bytes).expect("a file can be written");
    path
}

/// Writes small files that others may name: `a.obj`, `a.bin`, `a.hdr`, `a.png`, `a.toml`.
pub fn beside() {
    static ONCE: Once = Once::new();
    ONCE.call_once(|| {
        for (name, bytes) in seeds::companions() {
            file(name, &bytes);
        }
    });
}

/// Checks the promises of [`Mesh`].
pub fn check_mesh(mesh: &Mesh) {
    let count = mesh.positions.len();
    assert!(mesh.triangles.iter().flatten().all(|v| (*v as usize) < count), "an index out of range");
    assert!(mesh.positions.iter().all(|p| p.is_finite()), "a position that isn't finite");
    assert_eq!(mesh.normals.len(), count, "a normal per vertex");
    assert!(mesh.normals.iter().all(|n| (n.length() - 1.0).abs() < 1e-3), "a normal that isn't a unit vector");
    assert!(mesh.colors.is_empty() || mesh.colors.len() == count, "a colour per vertex");
    let in_unit = |c: &glam::Vec3| c.is_finite() && c.min_element() >= 0.0 && c.max_element() <= 1.0;
    assert!(mesh.colors.iter().all(in_unit), "a colour outside [0, 1]");
    let coordinates = &mesh.texture_coordinates;
    assert!(coordinates.is_empty() || coordinates.len() == count, "coordinates per vertex");
    for place in coordinates {
        assert!(place.is_finite() && (place.z as usize) < mesh.textures.len().max(1), "a texture that isn't there");
    }
    for texture in &mesh.textures {
        assert!(coordinates.iter().all(|place| texture.at(place.truncate().as_dvec2()).is_finite()));
    }
    assert!(mesh.coverage.is_empty() || mesh.coverage.len() == count, "coverage per vertex");
    assert!(mesh.coverage.iter().all(|it| (0.0..=1.0).contains(&it.x) && it.y >= 0.0), "alpha outside [0, 1]");
    for triangle in 0..mesh.triangles.len() {
        mesh.is_cut_out(triangle, glam::DVec3::splat(1.0 / 3.0));
    }
}

/// Checks that all of a scene is finite at its first and its last frame.
pub fn check_scene(scene: &Scene) {
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
}

/// glTF and GLB files, at rest and animated.
pub fn check_gltf(path: &Path) {
    if let Ok((mesh, _)) = mesh::load_with_notes(path) {
        check_mesh(&mesh);
    }
    if let Ok(scene) = scene_file::from_mesh(path, Some(Environment::constant(glam::Vec3::ONE))) {
        check_scene(&scene);
    }
    if let Ok((mesh, skin)) = mesh::load_animated(path, &Animation::Number(0)) {
        check_mesh(&mesh);
        for time in [0.0, 0.3, 1e3] {
            let Some(skin) = &skin else { break };
            let deformed = skin.deform(&mesh, time);
            assert!(deformed.positions.iter().chain(&deformed.normals).all(|v| v.is_finite()));
        }
    }
}

/// Checks the promises of [`EnvironmentMap`] and its loader.
pub fn check_map(map: &EnvironmentMap) {
    assert_eq!(map.texels().len(), map.width() * map.height());
    assert!(map.texels().iter().all(|l| l.is_finite() && l.min_element() >= 0.0), "radiance that isn't light");
}
