//! Spheres of objects where they are in a frame: following a mesh that deforms, and in world space.

use glam::{DQuat, DVec3};
use halfshade_scene::{
    Deformed, Mesh, Pose, Sphere,
    spheres::{Followed, SphereBinding},
};

/// Spheres of an object in its own space, with how each has turned since rest; `binding` is how they follow a `mesh` that
/// deforms.
pub(crate) fn followed(
    spheres: &[Sphere],
    binding: Option<&SphereBinding>,
    mesh: &Mesh,
    deformed: Option<&Deformed>,
) -> Vec<Followed> {
    match (binding, deformed) {
        (Some(binding), Some(deformed)) => binding.follow(&mesh.positions, &deformed.positions),
        _ => spheres.iter().map(|&sphere| Followed { sphere, rotation: DQuat::IDENTITY }).collect(),
    }
}

/// Centre and radius in world space of a sphere of an object with this `pose`, of which `rotation` is the rotation in
/// double precision.
pub(crate) fn placed(sphere: &Sphere, pose: &Pose, rotation: DQuat) -> (DVec3, f32) {
    let center = rotation * (f64::from(pose.scale) * sphere.center.as_dvec3());
    (center + pose.translation.as_dvec3(), pose.scale * sphere.radius)
}
