//! Scenes for unit tests.

use glam::Vec3;
use halfshade_scene::{Environment, Mesh, Object, Pose, Scene, Sphere, SphereSet, builtin::shapes};
use rand::{RngExt, SeedableRng};
use rand_pcg::Pcg64Mcg;
use std::sync::Arc;

/// No objects.
pub(crate) fn empty(environment: Environment) -> Scene {
    Scene::at_rest("empty", Vec::new(), environment)
}

/// Unit spheres, scaled and moved: meshes whose sphere sets are exact up to the mesh's own facets.
pub(crate) fn with_spheres(environment: Environment, spheres: &[Sphere]) -> Scene {
    let mesh: Arc<Mesh> = Arc::new(shapes::sphere(20));
    let set = SphereSet { spheres: vec![Sphere { center: Vec3::ZERO, radius: 1.0 }], ..SphereSet::default() };
    let set = Arc::new(set);
    let mut scene = empty(environment);
    scene.objects = spheres
        .iter()
        .map(|sphere| {
            Object::new("sphere", mesh.clone())
                .spheres(set.clone())
                .cluster_count(1)
                .pose(Pose { scale: sphere.radius, ..Pose::from_translation(sphere.center) })
        })
        .collect();
    scene
}

/// Numbers in [-1, 1), the same for the same seed.
pub(crate) fn random(seed: u64) -> impl FnMut() -> f32 {
    let mut rng = Pcg64Mcg::seed_from_u64(seed);
    move || rng.random_range(-1.0..1.0)
}
