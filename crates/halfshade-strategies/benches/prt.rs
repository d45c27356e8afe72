//! Shading by precomputed transfer on one thread, beside a plain copy of as many bytes as the vectors have: more than caches hold.

use criterion::{BenchmarkId, Criterion, Throughput, criterion_group, criterion_main};
use glam::Vec3;
use halfshade_scene::{
    Environment, Material, Object, RadianceBuffer, ReceiverBuffer, Reflectance, Scene, builtin::shapes,
    progress::Silent,
};
use halfshade_strategies::Prt;
use halfshade_strategy::{Baked, Strategy};
use std::hint::black_box;

/// Vertices along the side of a plane: a million.
const SIDE: usize = 1000;

fn shading(criterion: &mut Criterion) {
    let plane = Object::new("plane", shapes::plane(SIDE)).albedo(Vec3::new(0.8, 0.5, 0.2));
    let scene = Scene::at_rest("plane", vec![plane], Environment::constant(Vec3::new(1.0, 0.8, 0.6)));
    let frame = scene.frame(0);
    let receivers = ReceiverBuffer::vertices(&frame);
    let mut out = RadianceBuffer::zeros(receivers.len());
    for bands in [4, 6, 8] {
        let strategy = Prt::default();
        let params = strategy.info().parse(&format!("transfer=unshadowed,bands={bands}")).expect("valid settings");
        let mut baked = strategy.bake_scene(&scene, &params, &Silent).expect("bakes");
        let rows = baked.scene_arrays().rows.to_vec();
        let mut group = criterion.benchmark_group("a million vertices");
        group.throughput(Throughput::Bytes(size_of_val(rows.as_slice()) as u64)).sample_size(20);
        let mut copy = vec![0.0_f32; rows.len()];
        group.bench_function(BenchmarkId::new("copy", bands), |bencher| {
            bencher.iter(|| black_box(&mut copy).copy_from_slice(black_box(&rows)));
        });
        let prepared = baked.prepare(&frame).expect("prepares");
        group.bench_function(BenchmarkId::new("shade", bands), |bencher| {
            bencher.iter(|| prepared.shade(black_box(receivers.view()), out.view_mut()));
        });
        group.finish();
    }
}

/// A matrix per vertex, more than caches hold of them.
fn gloss(criterion: &mut Criterion) {
    let reflectance = Reflectance::ModifiedPhong { specular: Vec3::splat(0.5), exponent: 8.0 };
    let material = Material { reflectance, ..Material::new(Vec3::new(0.4, 0.3, 0.2)) };
    let plane = Object::new("plane", shapes::plane(150)).material(material);
    let mut scene = Scene::at_rest("plane", vec![plane], Environment::constant(Vec3::new(1.0, 0.8, 0.6)));
    scene.camera.eye = Vec3::new(0.0, 2.0, 2.0);
    let frame = scene.frame(0);
    let receivers = ReceiverBuffer::vertices(&frame);
    let mut out = RadianceBuffer::zeros(receivers.len());
    let mut group = criterion.benchmark_group("23 thousand glossy vertices");
    for bands in [4, 6, 8] {
        let strategy = Prt::default();
        let params = strategy.info().parse(&format!("transfer=unshadowed,bands={bands}")).expect("valid settings");
        let mut baked = strategy.bake_scene(&scene, &params, &Silent).expect("bakes");
        let bytes = baked.gloss_arrays().map_or(0, |arrays| size_of_val(arrays.matrices));
        group.throughput(Throughput::Bytes(bytes as u64)).sample_size(20);
        let prepared = baked.prepare(&frame).expect("prepares");
        group.bench_function(BenchmarkId::new("shade", bands), |bencher| {
            bencher.iter(|| prepared.shade(black_box(receivers.view()), out.view_mut()));
        });
    }
    group.finish();
}

criterion_group!(benches, shading, gloss);
criterion_main!(benches);
