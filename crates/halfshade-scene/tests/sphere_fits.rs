//! Sphere sets fitted to shadows, against rays.

use crate::sphere_errors::sphere_errors;
use glam::Vec3;
use halfshade_scene::{Mesh, Sphere, SphereFit, SphereSet, builtin, progress::Silent, spheres::BuildOptions};

const RAYS: usize = 512;

fn built(mesh: &Mesh, count: usize, fit: SphereFit) -> SphereSet {
    let options = BuildOptions { fit, seed: 1, restarts: 1, teleports: 1, polish: true, jumps: 2 };
    SphereSet::build(mesh, count, &options, &Silent).unwrap()
}

/// The measure itself, on what is known: a sphere in place of itself, a smaller one, and none.
#[test]
fn a_sphere_hides_what_it_hides() {
    let mesh = builtin::shape("sphere").unwrap();
    let errors = |radius| sphere_errors(&mesh, &[Sphere { center: Vec3::ZERO, radius }], RAYS);
    let exact = errors(1.0);
    assert!(exact.sky < 2e-3 && exact.disc < 5e-3 && exact.touching < 2e-3 && exact.own < 1e-3, "{exact:?}");
    // A sphere of radius r at height h over its receiver's plane hides r² h / d³ of the sky.
    let square: f64 = (0..1600)
        .map(|i| {
            let along = |n: usize| 5.0 * ((n as f64 + 0.5) / 40.0 - 0.5);
            (0.36 * 1.2 / (1.44 + along(i % 40).powi(2) + along(i / 40).powi(2)).powf(1.5)).powi(2)
        })
        .sum();
    let (found, expected) = (errors(0.8).sky, (square / 1600.0).sqrt());
    assert!((found / expected - 1.0).abs() < 0.02, "{found} {expected}");
}

#[test]
fn shadows_and_own_light_are_nearer_to_the_mesh_than_those_of_bounding_sets() {
    for (name, count, gains) in [("torus", 12, [0.5, 0.7, 1.0]), ("box", 10, [0.5, 0.7, 1.0])] {
        let mesh = builtin::shape(name).unwrap();
        let bounding = built(&mesh, count, SphereFit::Bounding);
        let shadow = built(&mesh, count, SphereFit::Shadow);
        let mut shrunk = bounding.clone();
        shrunk.spheres.iter_mut().for_each(|sphere| sphere.radius *= 0.88);
        let [before, after, middle] = [&bounding, &shadow, &shrunk].map(|set| sphere_errors(&mesh, &set.spheres, RAYS));
        assert!(after.sky < gains[0] * before.sky, "{name}: {before:?} {after:?}");
        assert!(after.disc < gains[1] * before.disc, "{name}: {before:?} {after:?}");
        assert!(after.own < gains[2] * before.own, "{name}: {before:?} {after:?}");
        // The start of the fit is a strong rival.
        assert!(after.sky < middle.sky && after.disc < middle.disc, "{name}: {middle:?} {after:?}");
        // Both kinds of error are told.
        assert!(bounding.missing_volume_fraction < 1e-12 && bounding.bounding_violation == 0.0);
        assert!(shadow.missing_volume_fraction > 0.0 && shadow.missing_volume_fraction < 0.3);
        assert!(shadow.bounding_violation > 0.0 && shadow.outside_volume_fraction < bounding.outside_volume_fraction);
    }
}

#[test]
fn any_mesh_count_scale_and_place() {
    let torus = builtin::shape("torus").unwrap();
    let mut open = torus.clone();
    open.triangles.truncate(torus.triangles.len() / 2);
    let mut flipped = torus.clone();
    flipped.triangles.iter_mut().for_each(|triangle| triangle.swap(0, 1));
    let triangle =
        Mesh { positions: vec![Vec3::ZERO, Vec3::X, Vec3::Y], triangles: vec![[0, 1, 2]], ..Mesh::default() };
    let mut line = triangle.clone();
    line.positions[2] = 2.0 * Vec3::X;
    let plane = builtin::shape("plane").unwrap();
    for (name, mesh, counts) in [
        ("open", &open, vec![9]),
        ("flipped", &flipped, vec![6]),
        ("triangle", &triangle, vec![1, 30]),
        ("line", &line, vec![5]),
        ("plane", &plane, vec![9]),
    ] {
        for count in counts {
            let set = built(mesh, count, SphereFit::Shadow);
            assert!(set.bounding_violation.is_finite(), "{name}: {set:?}");
            assert!((1..=count).contains(&set.spheres.len()), "{name}: {set:?}");
            assert!(
                set.spheres.iter().all(|s| s.center.is_finite() && s.radius > 0.0 && s.radius < 4.0),
                "{name}: {set:?}"
            );
            assert!(
                set.outside_volume_fraction.is_finite() && set.missing_volume_fraction.is_finite(),
                "{name}: {set:?}"
            );
        }
    }
    let unit = sphere_errors(&torus, &built(&torus, 5, SphereFit::Shadow).spheres, RAYS);
    for (scale, place) in [(1e-12, Vec3::ZERO), (1e12, Vec3::ZERO), (1.0, Vec3::new(500.0, -300.0, 0.0))] {
        let mut moved = torus.clone();
        moved.positions.iter_mut().for_each(|p| *p = scale * *p + place);
        let errors = sphere_errors(&moved, &built(&moved, 5, SphereFit::Shadow).spheres, RAYS);
        assert!(errors.sky < 1.5 * unit.sky && errors.own < 1.5 * unit.own, "{scale}: {errors:?} {unit:?}");
    }
}

#[test]
fn threads_change_no_bit() {
    let mesh = builtin::shape("box").unwrap();
    let with_threads = |n| {
        let pool = rayon::ThreadPoolBuilder::new().num_threads(n).build().unwrap();
        pool.install(|| built(&mesh, 5, SphereFit::Shadow))
    };
    assert_eq!(with_threads(1), with_threads(3));
}
