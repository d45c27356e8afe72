//! Shading by cosine lobes in the setting of [Meunier2009, figure 18], one thread: two bodies of 512 spheres each in a box, two
//! lobes of reflectance, one spherical light, masks of depth 5. The paper takes 13 µs per receiver on a processor of its time.
//!
//! Criterion reports receivers per second; only ratios within one run mean something on a shared machine.

use criterion::{BenchmarkId, Criterion, Throughput, criterion_group, criterion_main};
use glam::{DVec3, Vec3};
use halfshade_scene::{
    Environment, Material, Mesh, Motion, Object, Pose, RadianceBuffer, ReceiverBuffer, Reflectance, Scene, Sphere,
    SphereLight, SphereSet, progress::Silent,
};
use halfshade_sh::quadrature::golden_spiral;
use halfshade_strategies::CosineLobe;
use halfshade_strategy::Strategy;
use std::hint::black_box;

/// Receivers along a side of the floor, and on each body.
const SIDE: usize = 64;

/// Even directions.
fn spiral(count: usize) -> impl Iterator<Item = Vec3> {
    golden_spiral(count).map(|direction| DVec3::from(direction).as_vec3())
}

fn body(name: &str, center: Vec3, spheres: usize, material: &Material) -> Object {
    let radius = 0.55;
    let spheres: Vec<Sphere> =
        spiral(spheres).map(|direction| Sphere { center: center + radius * direction, radius: 0.07 }).collect();
    Object::new(name, Mesh::default()).material(material.clone()).spheres(SphereSet { spheres, ..SphereSet::default() })
}

fn scene(spheres: usize, reflectance: Reflectance) -> (Scene, ReceiverBuffer) {
    let material = Material { reflectance, ..Material::new(Vec3::new(0.4, 0.3, 0.2)) };
    let centers = [Vec3::new(-0.8, 0.75, 0.2), Vec3::new(0.8, 0.75, -0.3)];
    let floor = Object { sphere_count: 0, spheres: None, ..body("floor", Vec3::ZERO, 0, &material) };
    let objects =
        vec![floor, body("left", centers[0], spheres, &material), body("right", centers[1], spheres, &material)];
    let light = SphereLight { center: Vec3::new(0.3, 3.2, 0.8), radius: 0.4, radiance: Vec3::splat(20.0) };
    let mut scene = Scene::at_rest("box", objects, Environment::constant(Vec3::ZERO));
    scene.lights = vec![(light, Motion::Still(Pose::IDENTITY))];
    scene.camera.eye = Vec3::new(0.0, 2.0, 5.0);
    let mut receivers = ReceiverBuffer::default();
    for i in 0..SIDE * SIDE {
        let at = |i: usize| 4.0 * (i as f32 + 0.5) / SIDE as f32 - 2.0;
        receivers.push(Vec3::new(at(i % SIDE), 0.0, at(i / SIDE)), Vec3::Y, Vec3::ONE, 0);
    }
    for (object, center) in centers.into_iter().enumerate() {
        for direction in spiral(SIDE * SIDE) {
            receivers.push(center + 0.6 * direction, direction, Vec3::ONE, object as u32 + 1);
        }
    }
    (scene, receivers)
}

fn shading(criterion: &mut Criterion) {
    let glossy = Reflectance::ModifiedPhong { specular: Vec3::splat(0.3), exponent: 40.0 };
    for (name, spheres, reflectance) in
        [("diffuse, 1024 spheres", 512, Reflectance::Lambert), ("glossy, 1024 spheres", 512, glossy)]
    {
        let (scene, receivers) = scene(spheres, reflectance);
        let mut out = RadianceBuffer::zeros(receivers.len());
        let mut group = criterion.benchmark_group(name);
        group.throughput(Throughput::Elements(receivers.len() as u64)).sample_size(10);
        for settings in [
            "",
            "depth=4",
            "leaves=aggressive",
            "order=published,leaves=aggressive,fit=least-squares,product=published",
        ] {
            let params = CosineLobe.info().parse(settings).expect("valid settings");
            let mut baked = CosineLobe.bake(&scene, &params, &Silent).expect("bakes");
            let frame = scene.frame(0);
            let prepared = baked.prepare(&frame).expect("prepares");
            group.bench_function(BenchmarkId::new("one thread", settings), |bencher| {
                bencher.iter(|| prepared.shade(black_box(receivers.view()), out.view_mut()));
            });
        }
        group.finish();
    }
}

criterion_group!(benches, shading);
criterion_main!(benches);
