//! SH products at 4 bands against a plain loop over the sparse tensor, and the exponentials, per vector.
//!
//! Read the figures as ratios within one run: `one` over `plain` and, since a batch holds eight products,
//! `batch`/8 over `plain`.

use criterion::{Criterion, Throughput, criterion_group, criterion_main};
use halfshade_sh::exponential::{Exponential, Method};
use halfshade_sh::kernel::{self, BatchExponential, ShBatch};
use halfshade_sh::logarithm::DEFAULT_CLIP;
use halfshade_sh::{tripling, zonal, zonal_algebra};
use std::hint::black_box;
use wide::f32x8;

/// The plain form: every entry of the full tensor in turn.
struct Plain {
    entries: Vec<(usize, usize, usize, f32)>,
}

impl Plain {
    fn new() -> Self {
        let entry = |t: &tripling::Triple, [i, j, k]: [usize; 3]| (i, j, k, t.value as f32);
        let mut entries: Vec<_> = tripling::distinct(4)
            .iter()
            .flat_map(|t| t.permutations().map(|p| entry(t, p)).collect::<Vec<_>>())
            .collect();
        entries.sort_by_key(|&(i, j, k, _)| (i, j, k));
        Self { entries }
    }

    fn product(&self, f: &[f32; 16], g: &[f32; 16]) -> [f32; 16] {
        let mut h = [0.0; 16];
        for &(i, j, k, value) in &self.entries {
            h[i] += value * f[j] * g[k];
        }
        h
    }
}

fn products(c: &mut Criterion) {
    let mut group = c.benchmark_group("product, 4 bands");
    let f: [f32; 16] = std::array::from_fn(|i| (i as f32 * 0.7).sin());
    let g: [f32; 16] = std::array::from_fn(|i| (i as f32 * 1.3).cos());
    let (batch_f, batch_g): (ShBatch<16>, ShBatch<16>) = (f.map(f32x8::splat), g.map(f32x8::splat));
    let plain = Plain::new();
    group.bench_function("plain", |b| b.iter(|| plain.product(black_box(&f), black_box(&g))));
    group.bench_function("one", |b| b.iter(|| kernel::product_one(black_box(&f), black_box(&g))));
    group.bench_function("square, one", |b| b.iter(|| kernel::square_one(black_box(&f))));
    group.throughput(Throughput::Elements(8));
    group.bench_function("batch", |b| b.iter(|| kernel::product(black_box(&batch_f), black_box(&batch_g))));
    group.bench_function("square, batch", |b| b.iter(|| kernel::square(black_box(&batch_f))));
    group.finish();
}

fn exponentials(c: &mut Criterion) {
    let mut group = c.benchmark_group("exponential, batch, 4 bands, magnitude 9");
    group.throughput(Throughput::Elements(8));
    let log = zonal_algebra::logarithm(&zonal::blocker(4, 0.95f64.cos()), DEFAULT_CLIP);
    let sum: ShBatch<16> =
        std::array::from_fn(|i| f32x8::splat(zonal::rotate_to_axis(&log, [0.36, -0.48, 0.8])[i] as f32));
    for (name, method) in [
        ("series 9", Method::Series { terms: 9, magnitude_limit: None }),
        ("series 3, limit 1", Method::Series { terms: 3, magnitude_limit: Some(1.0) }),
        ("optimal-linear", Method::OptimalLinear),
        ("quadratic, limit 1", Method::Quadratic { magnitude_limit: 1.0 }),
        ("hybrid, limit 4.8", Method::Hybrid { magnitude_limit: 4.8 }),
        ("hybrid, limit 2", Method::Hybrid { magnitude_limit: 2.0 }),
        ("hybrid, limit 0.25", Method::Hybrid { magnitude_limit: 0.25 }),
    ] {
        let exponential = BatchExponential::new(&Exponential::new(4, method, DEFAULT_CLIP)).expect("4 bands");
        group.bench_function(name, |b| b.iter(|| exponential.evaluate(black_box(&sum))));
    }
    group.finish();
}

criterion_group! {
    name = benches;
    config = Criterion::default().sample_size(30).measurement_time(std::time::Duration::from_millis(600))
        .warm_up_time(std::time::Duration::from_millis(200));
    targets = products, exponentials
}
criterion_main!(benches);
