//! Shading by SH exponentiation: eight-lane kernels against a plain scalar form, one thread and all.
//!
//! Criterion reports receivers per second; divide by 64 spheres for receiver-sphere pairs. Only ratios within one run mean
//! something on a shared machine.

mod plain;

use criterion::{BenchmarkId, Criterion, Throughput, criterion_group, criterion_main};
use glam::Vec3;
use halfshade_scene::{
    Environment, Mesh, Object, RadianceBuffer, RadianceMut, ReceiverBuffer, Receivers, Scene, Sphere, SphereSet,
    builtin, progress::Silent,
};
use halfshade_strategies::ShExp;
use halfshade_strategy::{Baked, Prepared, Strategy};
use plain::Plain;
use std::{hint::black_box, sync::Arc};

const RECEIVERS: usize = 4096;

/// 64 spheres on a shell of radius 1 about (0, 1.2, 0), as dense as a bunny's, over receivers of a plane.
fn bunny_like() -> (Scene, ReceiverBuffer) {
    let spheres = (0..64)
        .map(|i| {
            let y = 1.0 - (2.0 * i as f32 + 1.0) / 64.0;
            let (sin, cos) = (2.399_963 * i as f32).sin_cos();
            let across = (1.0 - y * y).sqrt();
            Sphere { center: Vec3::new(across * cos, 1.2 + y, across * sin) * 0.8, radius: 0.25 }
        })
        .collect();
    let mut scene = builtin::scene("one-sphere").expect("built in");
    scene.environment = Environment::constant(Vec3::ONE);
    let Object { material, cluster_count, .. } = scene.objects[0].clone();
    scene.objects = vec![
        Object::new("shell", Mesh::default())
            .material(material)
            .spheres(SphereSet { spheres, ..SphereSet::default() })
            .cluster_count(cluster_count),
    ];
    let mut receivers = ReceiverBuffer::default();
    for i in 0..RECEIVERS {
        let place = |step: f64| ((i as f64 * step).fract() as f32 - 0.5) * 4.0;
        receivers.push(Vec3::new(place(0.754_877_7), 0.0, place(0.569_840_3)), Vec3::Y, Vec3::ONE, 0);
    }
    (scene, receivers)
}

fn baked(scene: &Scene, settings: &str) -> Box<dyn Baked> {
    let params = ShExp.info().parse(settings).expect("valid settings");
    ShExp.bake(scene, &params, &Silent).expect("bakes")
}

fn on_all_threads(prepared: &dyn Prepared, receivers: Receivers<'_>, out: RadianceMut<'_>) {
    if receivers.len() <= 256 {
        return prepared.shade(receivers, out);
    }
    let middle = receivers.len() / 2;
    let (left, right) = out.split_at(middle);
    rayon::join(
        || on_all_threads(prepared, receivers.slice(0..middle), left),
        || on_all_threads(prepared, receivers.slice(middle..receivers.len()), right),
    );
}

fn shading(criterion: &mut Criterion) {
    let (scene, receivers) = bunny_like();
    let mut out = RadianceBuffer::zeros(RECEIVERS);
    let mut group = criterion.benchmark_group("64 spheres, 4 bands");
    group.throughput(Throughput::Elements(RECEIVERS as u64)).sample_size(20);
    let plain = Plain::new(&scene, 2.0);
    group.bench_function("plain scalar hybrid", |bencher| {
        bencher.iter(|| plain.shade(black_box(receivers.view()), &mut out.channels[0]));
    });
    for variant in ["hybrid", "optimal-linear", "series", "product"] {
        let mut baked = baked(&scene, &format!("exp={variant},magnitude-limit=2"));
        let frame = scene.frame(0);
        let prepared = baked.prepare(&frame).expect("prepares");
        group.bench_function(BenchmarkId::new("one thread", variant), |bencher| {
            bencher.iter(|| prepared.shade(black_box(receivers.view()), out.view_mut()));
        });
        group.bench_function(BenchmarkId::new("all threads", variant), |bencher| {
            bencher.iter(|| on_all_threads(prepared.as_ref(), black_box(receivers.view()), out.view_mut()));
        });
    }
    group.finish();
}

/// The built-in scenes as a user runs them. Their sphere sets are replaced by spheres at vertices of the meshes, equally
/// many, because building the real ones takes longer than the benchmark and costs shading the same.
fn scenes(criterion: &mut Criterion) {
    let mut group = criterion.benchmark_group("built-in scenes, all threads");
    group.sample_size(20);
    for name in ["squirrel-and-balls", "ducks", "vases"] {
        let mut scene = builtin::scene(name).expect("built in");
        for object in scene.objects.iter_mut().filter(|object| object.sphere_count > 0) {
            let step = object.mesh.positions.len() / object.sphere_count;
            let (low, high) = object.mesh.bounds().expect("has vertices");
            let radius = 0.25 * (high - low).max_element();
            let centers = object.mesh.positions.iter().step_by(step.max(1)).take(object.sphere_count);
            let spheres = centers.map(|&center| Sphere { center, radius }).collect();
            object.spheres = Some(Arc::new(SphereSet { spheres, ..SphereSet::default() }));
        }
        let receivers = ReceiverBuffer::vertices(&scene.frame(0));
        let mut out = RadianceBuffer::zeros(receivers.len());
        let mut baked = baked(&scene, "");
        let frame = scene.frame(0);
        let prepared = baked.prepare(&frame).expect("prepares");
        group.bench_function(name, |bencher| {
            bencher.iter(|| on_all_threads(prepared.as_ref(), black_box(receivers.view()), out.view_mut()));
        });
    }
    group.finish();
}

criterion_group!(benches, shading, scenes);
criterion_main!(benches);
