//! Scenes for unit tests.

use glam::Vec3;
use halfshade_scene::{Environment, Material, Mesh, Motion, Object, Pose, Scene, Sphere, SphereSet, builtin::shapes};
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
        .map(|sphere| Object {
            name: "sphere".into(),
            mesh: mesh.clone(),
            material: Material::default(),
            sphere_count: 1,
            spheres: Some(set.clone()),
            cluster_count: 1,
            motion: Motion::Still(Pose { scale: sphere.radius, ..Pose::from_translation(sphere.center) }),
            skin: None,
        })
        .collect();
    scene
}
