//! Rays per second of halfshade-rays, and of the whole estimator, beside obvhs's own bare traversal of the same rays, on one
//! thread.
//!
//! The bare form traces rays that lie ready in memory with obvhs's own triangle test, which is not watertight, and sums
//! nothing. The estimator also draws every direction, weighs its light, and keeps sums per replicate.
//! Run with `cargo bench -p halfshade-truth`.

use criterion::{BatchSize, Criterion, Throughput, criterion_group, criterion_main};
use glam::{Vec3, Vec3A};
use halfshade_rays::MeshRays;
use halfshade_scene::{
    Environment, Frame, ReceiverBuffer, Scene, builtin, light::EnvironmentMap, progress::Silent, spheres::AdjustRule,
};
use halfshade_truth::{Geometry, Options, ShadowRay, Tracer, estimate, shadow_rays};
use obvhs::{
    BvhBuildParams,
    cwbvh::{CwBvh, builder::build_cwbvh_from_tris},
    ray::Ray,
    rt_triangle::RtTriangle,
    triangle::Triangle,
};
use std::time::Duration;

/// obvhs as it comes: its builder, its triangle test, triangles in the order of the leaves.
struct Bare {
    bvh: CwBvh,
    triangles: Vec<RtTriangle>,
    rays: Vec<Ray>,
}

impl Bare {
    fn new(frame: &Frame<'_>, rays: &[ShadowRay]) -> Self {
        let vertices = ReceiverBuffer::vertices(frame);
        let (mut first, mut triangles) = (0, Vec::new());
        for object in &frame.scene.objects {
            let at = |v: u32| Vec3A::from(vertices.view().position_at(first + v as usize));
            triangles.extend(object.mesh.triangles.iter().map(|t| Triangle {
                v0: at(t[0]),
                v1: at(t[1]),
                v2: at(t[2]),
            }));
            first += object.mesh.positions.len();
        }
        let bvh = build_cwbvh_from_tris(&triangles, BvhBuildParams::medium_build(), &mut Duration::default());
        let triangles = bvh.primitive_indices.iter().map(|&i| RtTriangle::from(&triangles[i as usize])).collect();
        let rays = rays
            .iter()
            .map(|ray| {
                let direction = Vec3A::from(ray.direction) + Vec3A::ZERO;
                Ray::new(ray.origin.as_vec3a(), direction, 1e-5, ray.distance)
            })
            .collect();
        Self { bvh, triangles, rays }
    }

    fn count_misses(&self) -> usize {
        let miss = |ray: &&Ray| self.bvh.ray_traverse_miss(**ray, |ray, slot| self.triangles[slot].intersect(ray));
        self.rays.iter().filter(miss).count()
    }
}

/// The same rays and triangles in halfshade-rays, whose test is watertight.
struct Watertight {
    mesh: MeshRays,
    rays: Vec<halfshade_rays::Ray>,
}

impl Watertight {
    fn new(frame: &Frame<'_>, rays: &[ShadowRay]) -> Self {
        let vertices = ReceiverBuffer::vertices(frame);
        let positions: Vec<Vec3> = (0..vertices.len()).map(|vertex| vertices.view().position_at(vertex)).collect();
        let (mut first, mut triangles) = (0, Vec::new());
        for object in &frame.scene.objects {
            triangles.extend(object.mesh.triangles.iter().map(|triangle| triangle.map(|vertex| first + vertex)));
            first += object.mesh.positions.len() as u32;
        }
        let ray = |ray: &ShadowRay| {
            let direction = ray.direction.as_dvec3().normalize();
            halfshade_rays::Ray::new(ray.origin + 1e-5 * direction, direction).until(f64::from(ray.distance))
        };
        Self { mesh: MeshRays::new(&positions, &triangles), rays: rays.iter().map(ray).collect() }
    }

    fn count_misses(&self) -> usize {
        self.rays.iter().filter(|ray| !self.mesh.any(ray, |_| true)).count()
    }
}

fn compare(criterion: &mut Criterion, name: &str, scene: &Scene) {
    let frame = scene.frame(0);
    let all = ReceiverBuffer::vertices(&frame);
    let mut receivers = ReceiverBuffer::default();
    for i in (0..all.len()).step_by(all.len() / 200) {
        let view = all.view();
        receivers.push(view.position_at(i), view.normal_at(i), view.albedo_at(i), view.object[i]);
    }
    let tracer = Tracer::new(&frame);
    let options = Options { samples: 1024, ..Options::default() };
    let rays = shadow_rays(&tracer, receivers.view(), &options);
    let bare = Bare::new(&frame, &rays);
    let watertight = Watertight::new(&frame, &rays);
    // obvhs meets what lies behind by rounding, and may lose a ray at an edge.
    let (passing, of_bare) = (watertight.count_misses(), bare.count_misses());
    assert!(passing.abs_diff(of_bare) * 1000 < rays.len(), "{passing} {of_bare}");
    let one_thread = rayon::ThreadPoolBuilder::new().num_threads(1).build().expect("one thread");

    let mut group = criterion.benchmark_group(name);
    group.throughput(Throughput::Elements(rays.len() as u64)).sample_size(20);
    group.bench_function("obvhs, bare", |bencher| bencher.iter(|| bare.count_misses()));
    group.bench_function("halfshade-rays", |bencher| bencher.iter(|| watertight.count_misses()));
    group.bench_function("truth", |bencher| {
        bencher.iter_batched(
            || (),
            |()| one_thread.install(|| estimate(&tracer, receivers.view(), &options, &Silent)),
            BatchSize::PerIteration,
        );
    });
    if tracer.sphere_count() > 0 {
        let options = Options { geometry: Geometry::Spheres(AdjustRule::Continuous), ..options };
        group.bench_function("truth on spheres", |bencher| {
            bencher.iter(|| one_thread.install(|| estimate(&tracer, receivers.view(), &options, &Silent)));
        });
    }
    group.finish();
}

fn rays(criterion: &mut Criterion) {
    let mut scene = builtin::scene("vases").expect("a built-in scene");
    scene.lights.clear();
    scene.environment = Environment::constant(Vec3::ONE);
    compare(criterion, "vases, constant sky", &scene);
    let texels = (0..512 * 256).map(|i| Vec3::splat(1.0 + (i % 97) as f32)).collect();
    scene.environment = Environment::map(EnvironmentMap::new(512, 256, texels).expect("texels fit"));
    compare(criterion, "vases, map", &scene);
}

criterion_group!(benches, rays);
criterion_main!(benches);
