//! A camera that sees all of something.

use crate::{Camera, Object, mesh::bounds};
use glam::Vec3;

/// A camera, from above the front right, that sees the sphere around a box.
pub(super) fn camera_on(min: Vec3, max: Vec3) -> Camera {
    let center = 0.5 * (min + max);
    let vertical_fov_degrees = 40.0_f32;
    let radius = (0.5 * (max - min).length()).max(f32::MIN_POSITIVE);
    let distance = 1.05 * radius / (0.5 * vertical_fov_degrees.to_radians()).sin();
    let eye = center + distance * Vec3::new(0.45, 0.4, 1.0).normalize();
    Camera { eye, target: center, vertical_fov_degrees, resolution: [800, 600] }
}

/// The bounding box in world space, at time 0, of the objects that block; of all, if none does.
pub(super) fn bounds_of(objects: &[Object]) -> (Vec3, Vec3) {
    let of = |object: &Object| {
        let pose = object.motion.at(0.0);
        let (min, max) = match object.deformed(0.0) {
            Some(deformed) => bounds(&deformed.positions)?,
            None => bounds(&object.mesh.positions)?,
        };
        let corner = |i: usize| {
            let pick = Vec3::new((i & 1) as f32, ((i >> 1) & 1) as f32, ((i >> 2) & 1) as f32);
            pose.transform_point(min + pick * (max - min))
        };
        Some((0..8).map(corner).fold((corner(0), corner(0)), |(min, max), p| (min.min(p), max.max(p))))
    };
    let union = |a: (Vec3, Vec3), b: (Vec3, Vec3)| (a.0.min(b.0), a.1.max(b.1));
    let blockers = objects.iter().filter(|object| object.sphere_count > 0).filter_map(of).reduce(union);
    blockers.or_else(|| objects.iter().filter_map(of).reduce(union)).unwrap_or((Vec3::NEG_ONE, Vec3::ONE))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_corner_of_the_box_is_in_the_picture() {
        let (min, max) = (Vec3::new(-3.0, 1.0, 2.0), Vec3::new(5.0, 2.0, 4.0));
        let camera = camera_on(min, max);
        let forward = (camera.target - camera.eye).normalize();
        for i in 0..8 {
            let pick = Vec3::new((i & 1) as f32, ((i >> 1) & 1) as f32, ((i >> 2) & 1) as f32);
            let toward = (min + pick * (max - min) - camera.eye).normalize();
            assert!(forward.angle_between(toward).to_degrees() < 20.0);
        }
    }
}
