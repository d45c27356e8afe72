//! Sphere sets of meshes: they bound, their figures are true, and threads change no bit.

use super::*;
use crate::builtin::shapes::{box_mesh, plane, torus};
use crate::progress::Silent;
use glam::Vec3;
use rand::RngExt;

const QUICK: BuildOptions =
    BuildOptions { fit: SphereFit::Bounding, seed: 1, restarts: 2, teleports: 1, polish: true, jumps: 1 };

fn build(mesh: &Mesh, count: usize) -> SphereSet {
    SphereSet::build(mesh, count, &QUICK, &Silent).unwrap()
}

/// Random points of the triangles, none of which may lie outside every sphere.
fn assert_bounds(mesh: &Mesh, set: &SphereSet) {
    assert_eq!(set.bounding_violation, 0.0);
    let mut rng = Pcg64Mcg::seed_from_u64(7);
    for triangle in &mesh.triangles {
        let [a, b, c] = triangle.map(|k| mesh.positions[k as usize].as_dvec3());
        for _ in 0..40 {
            let (u, v): (f64, f64) = (rng.random(), rng.random());
            let (u, v) = if u + v > 1.0 { (1.0 - u, 1.0 - v) } else { (u, v) };
            let p = a + u * (b - a) + v * (c - a);
            let missing = |s: &Sphere| s.center.as_dvec3().distance(p) - f64::from(s.radius);
            let least = set.spheres.iter().map(missing).fold(f64::INFINITY, f64::min);
            assert!(least <= 1e-12 * p.length(), "{least}");
        }
    }
}

/// Against a volume estimate that shares nothing with the builder's: random points and the torus's equation.
#[test]
fn a_torus_is_bounded_and_its_outside_volume_is_true() {
    let mesh = torus(1.0, 0.4, 96, 48);
    let set = build(&mesh, 12);
    assert_bounds(&mesh, &set);
    assert!(set.notes.is_empty() && set.spheres.len() == 12);
    let mut rng = Pcg64Mcg::seed_from_u64(3);
    let (mut outside, count) = (0u32, 2_000_000);
    for _ in 0..count {
        let p = Vec3::new(1.6, 0.6, 1.6) * Vec3::from_array(std::array::from_fn(|_| rng.random_range(-1.0..1.0f32)));
        let in_torus = (p.x.hypot(p.z) - 1.0).hypot(p.y) < 0.4;
        let in_spheres = set.spheres.iter().any(|s| s.center.distance(p) < s.radius);
        outside += u32::from(in_spheres && !in_torus);
    }
    let volume = 2.0 * std::f64::consts::PI.powi(2) * 0.4 * 0.4;
    let outside_torus = f64::from(outside) / f64::from(count) * (3.2 * 3.2 * 1.2);
    let tetrahedron = |t: &[u32; 3]| {
        let [a, b, c] = t.map(|k| mesh.positions[k as usize].as_dvec3());
        a.dot(b.cross(c)) / 6.0
    };
    let mesh_volume: f64 = mesh.triangles.iter().map(tetrahedron).sum();
    // The mesh is inscribed in the torus: what it lacks is outside of it too.
    let fraction = (outside_torus + volume - mesh_volume) / mesh_volume;
    assert!((fraction / set.outside_volume_fraction - 1.0).abs() < 0.01, "{fraction} {set:?}");
    // Twelve spheres around a ring, each through the tube's rim at its ends.
    assert!(set.outside_volume_fraction < 0.6, "{}", set.outside_volume_fraction);
}

#[test]
fn the_polish_pays() {
    let mut slab = box_mesh(2);
    slab.positions.iter_mut().for_each(|p| *p *= Vec3::new(1.0, 0.6, 0.3));
    // Sharp corners, which samples miss, and few spheres for much: there it once lost.
    let cases = [(torus(1.0, 0.6, 48, 24), 10), (box_mesh(2), 10), (slab, 5)];
    let ratios = cases.map(|(mesh, count)| {
        let published = SphereSet::build(&mesh, count, &BuildOptions { polish: false, ..QUICK }, &Silent).unwrap();
        assert_bounds(&mesh, &published);
        build(&mesh, count).outside_volume_fraction / published.outside_volume_fraction
    });
    assert!(ratios[0] < 1.0 && ratios[1] < 1.0 && ratios[2] <= 1.0, "{ratios:?}");
}

#[test]
fn threads_do_not_change_a_bit() {
    let mesh = box_mesh(2);
    let with_threads = |n| rayon::ThreadPoolBuilder::new().num_threads(n).build().unwrap().install(|| build(&mesh, 5));
    let one = with_threads(1);
    assert_eq!(one, with_threads(3));
    let other = SphereSet::build(&mesh, 5, &BuildOptions { seed: 2, ..QUICK }, &Silent).unwrap();
    assert_ne!(one, other);
}

#[test]
fn any_scale_and_place() {
    let mesh = torus(1.0, 0.5, 24, 12);
    let unit = build(&mesh, 6);
    for (scale, place) in [(1e-3, Vec3::ZERO), (1e3, Vec3::ZERO), (1.0, Vec3::new(500.0, -300.0, 0.0))] {
        let mut moved = mesh.clone();
        moved.positions.iter_mut().for_each(|p| *p = scale * *p + place);
        let set = build(&moved, 6);
        assert_bounds(&moved, &set);
        let ratio = set.outside_volume_fraction / unit.outside_volume_fraction;
        assert!((0.9..1.1).contains(&ratio), "scale {scale}: {ratio}");
    }
}

#[test]
fn bad_meshes_are_bounded_too() {
    let sound = torus(1.0, 0.4, 24, 12);
    let mut flipped = sound.clone();
    flipped.triangles.iter_mut().for_each(|t| t.swap(0, 1));
    let mut open = sound.clone();
    open.triangles.truncate(sound.triangles.len() - 12);
    let mut split = Mesh::default();
    for t in &sound.triangles {
        split.triangles.push([0, 1, 2].map(|k| k + split.positions.len() as u32));
        split.positions.extend(t.map(|k| sound.positions[k as usize]));
    }
    let mut two = sound.clone();
    two.triangles.extend(sound.triangles.iter().map(|t| t.map(|k| k + sound.positions.len() as u32)));
    two.positions.extend(sound.positions.iter().map(|p| 0.7 * *p + Vec3::new(3.0, 0.2, 0.1)));
    for mesh in [&flipped, &open, &split, &two] {
        let set = build(mesh, 6);
        assert_bounds(mesh, &set);
        assert_eq!(set.notes.is_empty(), !std::ptr::eq(mesh, &open), "{:?}", set.notes);
        // Six for two tori are few; one sphere around a torus would be 5.
        assert!(set.outside_volume_fraction < 4.0, "{}", set.outside_volume_fraction);
    }
    // Nothing inside: a shell, and said so.
    let flat = build(&plane(3), 7);
    assert_bounds(&plane(3), &flat);
    assert!(flat.notes[0].contains("no volume") && flat.outside_volume_fraction.is_finite());
    // More spheres than there is to cover, and one for all.
    let triangle = Mesh {
        positions: vec![Vec3::ZERO, Vec3::X, Vec3::Y],
        triangles: vec![[0, 1, 2], [0, 0, 0]],
        ..Mesh::default()
    };
    for count in [1, 30] {
        assert_bounds(&triangle, &build(&triangle, count));
    }
    let one = build(&box_mesh(1), 1);
    assert_bounds(&box_mesh(1), &one);
    assert!((f64::from(one.spheres[0].radius) - 3f64.sqrt()).abs() < 0.02, "{one:?}");
}

#[test]
fn what_cannot_be_bounded_is_said() {
    let problem = |mesh: &Mesh, count| SphereSet::build(mesh, count, &QUICK, &Silent).unwrap_err().to_string();
    assert!(problem(&box_mesh(1), 0).contains("0 spheres"));
    assert!(problem(&box_mesh(1), MAX_SPHERES + 1).contains("at most 2000"));
    assert!(problem(&Mesh::default(), 3).contains("without triangles"));
    let mut broken = box_mesh(1);
    broken.positions[2].y = f32::NAN;
    assert!(problem(&broken, 3).contains("vertex 2 is not finite"));
    broken.positions.truncate(2);
    assert!(problem(&broken, 3).contains("a triangle uses vertex"));
    broken.positions = vec![Vec3::ONE; 100];
    assert!(problem(&broken, 3).contains("one place"));
}

#[test]
fn the_cache_gives_the_same_set() {
    let folder = tempfile::tempdir().unwrap();
    let cache = Cache::open(Some(folder.path().into()));
    let ask = |count| SphereSet::build_cached(&box_mesh(1), count, &QUICK, &cache, &Silent).unwrap();
    let (first, second, other) = (ask(3), ask(3), ask(2));
    assert_eq!(first.0, second.0);
    use crate::cache::CacheSource::{Computed, Read};
    assert_eq!([first.1.source, second.1.source, other.1.source], [Computed, Read, Computed]);
}

#[test]
fn the_built_in_scenes_get_all_their_spheres() {
    let folder = tempfile::tempdir().unwrap();
    let cache = Cache::open(Some(folder.path().into()));
    for (name, count) in [("vases", 20), ("squirrel-and-balls", 14)] {
        let mut scene = crate::builtin::scene(name).unwrap();
        let notes = scene.build_spheres(&cache, &Silent).unwrap();
        assert_eq!(scene.built_sphere_count(), count, "{name}: {notes:?}");
    }
}
