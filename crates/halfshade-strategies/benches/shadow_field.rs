//! Shading by shadow fields on one thread, all vertices of the built-in `statues`: six objects, an environment and its lights.
//!
//! Fields are baked from coarse maps, which takes seconds and not a minute; what shading reads is as large.

use criterion::{BenchmarkId, Criterion, Throughput, criterion_group, criterion_main};
use halfshade_scene::{RadianceBuffer, ReceiverBuffer, builtin, progress::Silent};
use halfshade_strategies::ShadowField;
use halfshade_strategy::Strategy;
use std::hint::black_box;

fn shading(criterion: &mut Criterion) {
    let scene = builtin::scene("statues").expect("built in");
    let frame = scene.frame(60);
    let all = ReceiverBuffer::vertices(&frame);
    let mut group = criterion.benchmark_group("statues");
    // Wavelets take a hundred times as long.
    for (settings, every) in
        [("map=8,inside=blocked", 1), ("map=8,inside=blocked,bands=6", 1), ("basis=haar,shells=8,resolution=16", 64)]
    {
        let receivers = ReceiverBuffer::gathered(all.view(), &(0..all.len() as u32).step_by(every).collect::<Vec<_>>());
        group.throughput(Throughput::Elements(receivers.len() as u64)).sample_size(10);
        let mut baked = None;
        group.bench_function(BenchmarkId::new("shade", settings), |bencher| {
            // Once and not for every sample, and only if it is asked for: wavelets take a minute.
            let baked = baked.get_or_insert_with(|| {
                let strategy = ShadowField::default();
                let params = strategy.info().parse(settings).expect("valid settings");
                strategy.bake(&scene, &params, &Silent).expect("bakes")
            });
            let prepared = baked.prepare(&frame).expect("prepares");
            let mut out = RadianceBuffer::zeros(receivers.len());
            bencher.iter(|| prepared.shade(black_box(receivers.view()), out.view_mut()));
        });
    }
    group.finish();
}

criterion_group!(benches, shading);
criterion_main!(benches);
