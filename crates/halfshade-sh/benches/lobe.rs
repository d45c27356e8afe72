//! Products of cosine lobes, eight at a time, by rule; their integrals and bounds; lobes for caps.
//!
//! `elements` are pairs of lobes. Inputs change from call to call, so that lookups don't stay in one place of the table.

use criterion::{Criterion, Throughput, criterion_group, criterion_main};
use halfshade_sh::kernel::SphericalCap8;
use halfshade_sh::lobe::accuracy;
use halfshade_sh::lobe::{CapFit, CapLobeTable, Lobe8, LobeTable, ProductRule, product, product_integral};
use std::hint::black_box;
use wide::f32x8;

/// 128 batches of light and blocker lobes.
fn batches() -> Vec<(Lobe8, Lobe8)> {
    let chains = accuracy::chains(1024);
    let gather = |chains: &[accuracy::Chain], index: usize| {
        let lanes = |get: &dyn Fn(&accuracy::Chain) -> f64| {
            f32x8::from(std::array::from_fn::<f32, 8, _>(|lane| get(&chains[lane]) as f32))
        };
        Lobe8 {
            axis: std::array::from_fn(|axis| lanes(&|chain| chain[index].axis[axis])),
            exponent: lanes(&|chain| chain[index].exponent),
            scale: lanes(&|chain| chain[index].scale),
        }
    };
    chains.chunks_exact(8).map(|eight| (gather(eight, 1), gather(eight, 2))).collect()
}

fn lobes(c: &mut Criterion) {
    let mut group = c.benchmark_group("lobes");
    let batches = batches();
    group.throughput(Throughput::Elements(8 * batches.len() as u64));
    let sum = |of: &dyn Fn(&Lobe8, &Lobe8) -> f32x8| {
        batches.iter().fold(f32x8::ZERO, |sum, (a, b)| sum + of(black_box(a), black_box(b)))
    };
    for rule in ProductRule::ALL {
        let table = LobeTable::build(rule);
        let all = |lobe: Lobe8| lobe.axis[0] + lobe.axis[1] + lobe.axis[2] + lobe.exponent + lobe.scale;
        group.bench_function(format!("product, {rule:?}"), |b| b.iter(|| sum(&|a, b| all(table.product8(a, b)))));
    }
    let table = LobeTable::build(ProductRule::Moments);
    group.bench_function("integral of product", |b| b.iter(|| sum(&|a, b| table.product_integral8(a, b))));
    group.bench_function("bound of product", |b| b.iter(|| sum(&|a, b| a.product_bound(b))));
    let caps = CapLobeTable::build(CapFit::LeastSquares);
    let cap = |a: &Lobe8| SphericalCap8 { direction: a.axis, versine: f32x8::ONE / (f32x8::ONE + a.exponent) };
    group.bench_function("cap", |b| b.iter(|| sum(&|a, _| caps.lookup(&cap(a)).exponent)));
    group.finish();

    let mut group = c.benchmark_group("lobes, f64 and once");
    let (a, b) = (batches[3].0.lane(0), batches[3].1.lane(0));
    group.bench_function("product, published", |bench| {
        bench.iter(|| product(black_box(&a), black_box(&b), ProductRule::Published));
    });
    group.bench_function("integral of product", |bench| {
        bench.iter(|| product_integral(black_box(&a), black_box(&b)));
    });
    for rule in [ProductRule::Published, ProductRule::Moments] {
        group.bench_function(format!("table, {rule:?}"), |bench| bench.iter(|| LobeTable::build(rule)));
    }
    group.finish();
}

criterion_group! {
    name = benches;
    config = Criterion::default().sample_size(10).measurement_time(std::time::Duration::from_millis(600))
        .warm_up_time(std::time::Duration::from_millis(200));
    targets = lobes
}
criterion_main!(benches);
