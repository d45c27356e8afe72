//! The ends of what may be asked: finite and bounded numbers; and work that goes on where it was interrupted.

use crate::prt::scenes::{in_batches, torus_over_ground, vertices};
use glam::Vec3;
use halfshade_scene::{
    Cache, Environment, Mesh, Object, Progress, RadianceBuffer, ReceiverBuffer, Scene, SurfacePoint,
    light::EnvironmentMap, progress::Silent,
};
use halfshade_strategies::Prt;
use halfshade_strategy::Strategy;
use std::sync::atomic::{AtomicU64, Ordering::Relaxed};

fn one_bright_texel() -> Environment {
    let texels = (0..64 * 32).map(|i| if i == 700 { Vec3::splat(1e6) } else { Vec3::ZERO });
    Environment::map(EnvironmentMap::new(64, 32, texels.collect()).unwrap())
}

#[test]
fn ends_are_finite_and_bounded() {
    for albedo in [Vec3::ZERO, Vec3::ONE, Vec3::new(1.0, 0.0, 1.0)] {
        for (environment, settings) in [
            (Environment::constant(Vec3::ONE), "bands=1,directions=16"),
            (Environment::constant(Vec3::ONE), "bands=8,directions=64"),
            (one_bright_texel(), "bands=8,directions=64"),
            (one_bright_texel(), "bands=5,directions=100"),
        ] {
            let is_sky = environment.base.is_same_as(&Environment::constant(Vec3::ONE).base);
            let scene = Scene { bounces: 4, ..torus_over_ground(environment, [albedo; 2]) };
            let (receivers, found) = vertices(&scene, settings);
            for i in 0..receivers.len() {
                let radiance = found.at(i);
                assert!(radiance.is_finite(), "{settings} {albedo}: {radiance}");
                // Under a sky, no more than the sky; with noise of few rays about 0.
                assert!(
                    !is_sky || (radiance.min_element() > -0.02 && radiance.max_element() < 1.02),
                    "{settings}: {radiance}"
                );
            }
        }
    }
}

/// Triangles without area, vertices in one place, normals of no length, one vertex, none.
#[test]
fn degenerate_meshes_are_no_trouble() {
    let flat = Mesh {
        positions: vec![Vec3::ZERO, Vec3::X, 2.0 * Vec3::X, Vec3::ZERO, Vec3::Y],
        normals: vec![Vec3::Y, Vec3::ZERO, Vec3::NEG_Z, Vec3::Y, Vec3::Y],
        triangles: vec![[0, 1, 2], [0, 0, 0], [0, 3, 1], [0, 1, 4]],
        ..Mesh::default()
    };
    let point = Mesh { positions: vec![Vec3::ONE], normals: vec![Vec3::Y], ..Mesh::default() };
    for meshes in [vec![flat], vec![point], vec![Mesh::default()], vec![]] {
        let objects = meshes.into_iter().map(|mesh| Object::new("end", mesh)).collect();
        let scene = Scene { bounces: 2, ..Scene::at_rest("ends", objects, one_bright_texel()) };
        let frame = scene.frame(0);
        let mut receivers = ReceiverBuffer::vertices(&frame);
        if let Some(first) = (receivers.len() > 1).then(|| receivers.view().at(0)) {
            for from_behind in [false, true] {
                let surface = SurfacePoint::Triangle { triangle: 1, barycentric: [0.2, 0.3, 0.5], from_behind };
                receivers.add(&halfshade_scene::ReceiverPoint { surface, ..first });
            }
        }
        let found = crate::common::shaded(&Prt::default(), &scene, &frame, &receivers, "directions=64");
        assert!((0..receivers.len()).all(|i| found.at(i).is_finite()));
    }
}

/// A listener that counts.
#[derive(Default)]
struct Count([AtomicU64; 2]);

impl Progress for Count {
    fn start(&self, _: &str, total: u64) {
        self.0[0].store(total, Relaxed);
    }

    fn advance(&self, steps: u64) {
        self.0[1].fetch_add(steps, Relaxed);
    }
}

fn baked_by(strategy: &Prt, scene: &Scene, progress: &dyn Progress) -> Vec<f32> {
    let params = strategy.info().parse("directions=32,bands=2").unwrap();
    strategy.bake_scene(scene, &params, progress).unwrap().scene_arrays().rows.to_vec()
}

#[test]
fn what_was_finished_is_not_traced_again() {
    let folder = tempfile::tempdir().unwrap();
    let strategy = Prt::new(Cache::open(Some(folder.path().into())));
    let scene = Scene { bounces: 1, ..torus_over_ground(one_bright_texel(), [Vec3::new(0.5, 0.4, 0.3), Vec3::ONE]) };
    let entries = || std::fs::read_dir(folder.path()).unwrap().map(|entry| entry.unwrap().path()).collect::<Vec<_>>();
    let count = Count::default();
    let first = baked_by(&strategy, &scene, &count);
    assert_eq!(count.0[0].load(Relaxed), count.0[1].load(Relaxed));
    assert_eq!(first, baked_by(&Prt::default(), &scene, &Silent));
    let known = entries();
    assert_eq!(known.len(), 2, "direct light and one bounce, a chunk each");
    // As if it had been interrupted in the midst of writing one.
    std::fs::remove_file(&known[0]).unwrap();
    assert_eq!(baked_by(&strategy, &scene, &Silent), first);
    assert_eq!(entries().len(), 2);
    // Another colour changes what is reflected alone, light nothing.
    let mut other = scene.clone();
    other.objects[0].material.albedo = Vec3::splat(0.1);
    assert_ne!(baked_by(&strategy, &other, &Silent), first);
    assert_eq!(entries().len(), 3);
    other.environment = Environment::constant(Vec3::ONE);
    baked_by(&strategy, &other, &Silent);
    assert_eq!(entries().len(), 3);
    // Nor does another number of bands change what is in the way.
    let params = strategy.info().parse("directions=32,bands=3,transfer=shadowed").unwrap();
    let kept = strategy.bake_scene(&other, &params, &Silent).unwrap().scene_arrays().rows.to_vec();
    assert_eq!(entries().len(), 3);
    assert_eq!(kept, Prt::default().bake_scene(&other, &params, &Silent).unwrap().scene_arrays().rows);
}

#[test]
fn threads_and_batches_change_no_bit() {
    let scene = Scene { bounces: 1, ..torus_over_ground(one_bright_texel(), [Vec3::new(0.5, 0.4, 0.3), Vec3::ONE]) };
    let one = rayon::ThreadPoolBuilder::new().num_threads(1).build().unwrap();
    let alone = one.install(|| baked_by(&Prt::default(), &scene, &Silent));
    assert_eq!(alone, baked_by(&Prt::default(), &scene, &Silent));
    let frame = scene.frame(0);
    let receivers = ReceiverBuffer::vertices(&frame);
    for settings in ["bands=3,directions=32", "bands=4,directions=32", "bands=7,directions=32"] {
        let mut baked = crate::common::baked(&Prt::default(), &scene, settings);
        let prepared = baked.prepare(&frame).unwrap();
        let shade = |size: usize| in_batches(&*prepared, &receivers, size);
        let whole = shade(receivers.len());
        for size in [1, 3, 8, 13] {
            let bits = |out: &RadianceBuffer| out.channels.iter().flatten().map(|x| x.to_bits()).collect::<Vec<_>>();
            assert_eq!(bits(&shade(size)), bits(&whole), "{settings} {size}");
        }
    }
}
