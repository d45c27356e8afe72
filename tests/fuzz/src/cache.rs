//! Cache entries of every kind, and how they are read.

use crate::file;
use glam::Vec3;
use halfshade_harness::{
    ReceiverWeights, ReferenceKind,
    reference::{Accuracy, ReferenceTracer},
};
use halfshade_scene::{
    Cache, Environment, Mesh, Object, ReceiverBuffer, Scene, SphereSet, builtin::shapes, progress::Silent,
    spheres::BuildOptions,
};
use std::{
    path::{Path, PathBuf},
    sync::{Arc, LazyLock},
};

const MARK: &[u8] = b"HSCACHE1";

/// An entry with this payload and the checksum of it.
pub fn with_checksum(payload: &[u8]) -> Vec<u8> {
    [MARK, blake3::hash(payload).as_bytes(), payload].concat()
}

/// Payloads of all entries that the users of the cache write.
pub fn cache_payloads() -> Vec<Vec<u8>> {
    ENTRIES.iter().map(|(_, _, entry)| entry[MARK.len() + 32..].to_vec()).collect()
}

/// Lets one of the entries be `bytes` and asks for what it holds. What is refused is computed anew, which takes spheres
/// twenty times as long as all else: they are `which` 0 alone, the others take turns.
pub fn cache_entry(which: u8, bytes: &[u8]) {
    let others = ENTRIES.len() - 1;
    let number = if which == 0 { 0 } else { 1 + usize::from(which - 1) % others };
    let (user, path, sound) = &ENTRIES[number];
    std::fs::write(path, bytes).expect("a file can be written");
    user(path.parent().expect("a folder"));
    std::fs::write(path, sound).expect("a file can be written");
}

type User = fn(&Path);

/// The reader, the entry's path, and its content.
static ENTRIES: LazyLock<Vec<(User, PathBuf, Vec<u8>)>> = LazyLock::new(|| {
    // Spheres first, see `cache_entry`.
    let users: [User; 4] = [spheres, harmonics, wavelets, truth];
    let mut entries = Vec::new();
    for (number, user) in users.into_iter().enumerate() {
        let folder = file("mark", &[]).with_file_name(format!("cache-{number}"));
        std::fs::create_dir_all(&folder).expect("a folder");
        user(&folder);
        let mut paths: Vec<PathBuf> =
            std::fs::read_dir(&folder).expect("a folder").map(|entry| entry.expect("an entry").path()).collect();
        paths.sort();
        assert!(!paths.is_empty(), "nothing was cached");
        entries.extend(paths.into_iter().map(|path| {
            let bytes = std::fs::read(&path).expect("an entry");
            (user, path, bytes)
        }));
    }
    entries
});

fn tetrahedron() -> Mesh {
    let positions = vec![Vec3::ZERO, Vec3::X, Vec3::Y, Vec3::Z];
    let normals = positions.iter().map(|p| (*p - Vec3::splat(0.25)).normalize()).collect();
    Mesh { positions, normals, triangles: vec![[0, 2, 1], [0, 1, 3], [0, 3, 2], [1, 2, 3]], ..Mesh::default() }
}

fn scene(mesh: Mesh) -> Scene {
    Scene::at_rest("x", vec![Object::new("x", mesh)], Environment::constant(Vec3::ONE))
}

fn spheres(folder: &Path) {
    let cache = Cache::open(Some(folder.to_owned()));
    // Refused entries are built again, and there will be many.
    let options = BuildOptions { restarts: 1, teleports: 0, polish: false, ..BuildOptions::default() };
    let _ = SphereSet::build_cached(&tetrahedron(), 1, &options, &cache, &Silent);
}

fn fields(folder: &Path, settings: &str) {
    let strategies = halfshade::strategies(&Cache::open(Some(folder.to_owned())));
    let strategy = strategies.iter().find(|strategy| strategy.info().name == "shadow-field").expect("shadow fields");
    let params = strategy.info().parse(settings).expect("parameters");
    let _ = strategy.bake(&scene(tetrahedron()), &params, &Silent);
}

fn harmonics(folder: &Path) {
    fields(folder, "bands=1,shells=1,inner=0,resolution=2,map=8");
}

fn wavelets(folder: &Path) {
    fields(folder, "basis=haar,shells=1,inner=0,resolution=2,face=2");
}

fn truth(folder: &Path) {
    let cache = Cache::open(Some(folder.to_owned()));
    let scene = scene(shapes::plane(1));
    let receivers = ReceiverBuffer::vertices(&scene.frame(0));
    let tracer = ReferenceTracer {
        accuracy: Accuracy { samples: 16, relative_noise: None, seed: 1 },
        band_limit: &|environment, _| environment.clone(),
        cache: &cache,
        progress: &Silent,
    };
    let weights = Arc::new(ReceiverWeights::equal(receivers.len()));
    let _ = tracer.trace(&scene, 0, receivers.view(), ReferenceKind::Mesh, (weights, Arc::from([])));
}
