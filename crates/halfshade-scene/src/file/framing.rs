//! A camera that sees all of something.

use crate::mesh::bounds;
use crate::{Camera, Object, Pose, SceneError};
use glam::{DVec3, Vec3};

/// Degrees that the picture's height spans.
const VERTICAL_FOV_DEGREES: f32 = 40.0;

/// Steps of single precision that the half of a thing must measure to be more than a few points.
const FEWEST_STEPS: f64 = 4.0;

/// A camera, from above the front right, that sees the sphere around a box.
///
/// # Errors
/// Where coordinates in single precision, the camera's or those of what it looks at, are too coarse for that.
pub(super) fn camera_on(min: DVec3, max: DVec3) -> Result<Camera, SceneError> {
    let center = min.midpoint(max);
    let radius = (0.5 * (max - min).length()).max(f64::from(f32::MIN_POSITIVE));
    let half_fov = 0.5 * f64::from(VERTICAL_FOV_DEGREES).to_radians();
    let distance = 1.05 * radius / half_fov.sin();
    let eye = center + distance * DVec3::new(0.45, 0.4, 1.0).normalize();
    let camera = Camera {
        eye: eye.as_vec3(),
        target: center.as_vec3(),
        vertical_fov_degrees: VERTICAL_FOV_DEGREES,
        resolution: [800, 600],
    };
    let step = f64::from(f32::EPSILON) * min.abs().max(max.abs()).max_element();
    if radius >= FEWEST_STEPS * step && corners(min, max).iter().all(|corner| sees(&camera, *corner)) {
        return Ok(camera);
    }
    let (size, far) = ((max - min).max_element(), center.abs().max_element());
    Err(SceneError::new(format!(
        "no camera in single precision frames what is {size:.2e} in size {far:.2e} from the origin"
    ))
    .with_remedy("move it nearer, scale it, or give a camera"))
}

/// The bounding box, in the outer space, of the bounding box of points; `None` where there are none.
pub(super) fn box_of(points: &[Vec3], pose: &Pose) -> Option<(DVec3, DVec3)> {
    let (min, max) = bounds(points)?;
    // In double precision, where what is far from the origin keeps its size.
    let placed = corners(min.as_dvec3(), max.as_dvec3())
        .map(|corner| pose.rotation.as_dquat() * (f64::from(pose.scale) * corner) + pose.translation.as_dvec3());
    Some(placed.iter().fold((placed[0], placed[0]), |(min, max), p| (min.min(*p), max.max(*p))))
}

/// A camera that sees all objects that block; all of them, if none does.
pub(crate) fn camera_that_sees(objects: &[Object]) -> Result<Camera, SceneError> {
    let (min, max) = bounds_of(objects);
    camera_on(min, max)
}

/// Whether a point is in the picture, whatever the picture's width.
fn sees(camera: &Camera, point: DVec3) -> bool {
    let eye = camera.eye.as_dvec3();
    let forward = camera.target.as_dvec3() - eye;
    // Written so that what isn't finite is not seen.
    forward.angle_between(point - eye).to_degrees() < 0.5 * f64::from(camera.vertical_fov_degrees)
}

/// The eight corners of a box.
fn corners(min: DVec3, max: DVec3) -> [DVec3; 8] {
    std::array::from_fn(|i| {
        let pick = |axis: usize| if i >> axis & 1 == 1 { max[axis] } else { min[axis] };
        DVec3::new(pick(0), pick(1), pick(2))
    })
}

/// The bounding box of an object in world space at time 0.
fn placed_bounds(object: &Object) -> Option<(DVec3, DVec3)> {
    let pose = object.motion.at(0.0);
    match object.deformed(0.0) {
        Some(deformed) => box_of(&deformed.positions, &pose),
        None => box_of(&object.mesh.positions, &pose),
    }
}

/// Longest side of an object in world space at time 0.
pub(super) fn size_of(object: &Object) -> f64 {
    placed_bounds(object).map_or(0.0, |(min, max)| (max - min).max_element())
}

/// The bounding box in world space, at time 0, of the objects that block; of all, if none does.
pub(super) fn bounds_of(objects: &[Object]) -> (DVec3, DVec3) {
    let union = |a: (DVec3, DVec3), b: (DVec3, DVec3)| (a.0.min(b.0), a.1.max(b.1));
    let blockers = objects.iter().filter(|object| object.sphere_count > 0).filter_map(placed_bounds).reduce(union);
    let all = || objects.iter().filter_map(placed_bounds).reduce(union);
    blockers.or_else(all).unwrap_or((Vec3::NEG_ONE.as_dvec3(), DVec3::ONE))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::{Environment, Pose, Scene, builtin::shapes::box_mesh};

    #[test]
    fn every_corner_of_the_box_is_in_the_picture() {
        // Near and far, small and large; the last as large as single precision allows.
        let (min, max) = (DVec3::new(-3.0, 1.0, 2.0), DVec3::new(5.0, 2.0, 4.0));
        for (scale, place) in [(1.0, 0.0), (1e-3, 100.0), (1e-30, 0.0), (1.0, 1e5), (1e36, 0.0), (1e-2, 1e3)] {
            let place = DVec3::new(place, -place, 0.5 * place);
            let camera = camera_on(scale * min + place, scale * max + place).unwrap();
            let (eye, forward) = (camera.eye.as_dvec3(), (camera.target - camera.eye).as_dvec3().normalize());
            for i in 0..8 {
                let pick = DVec3::new((i & 1) as f64, ((i >> 1) & 1) as f64, ((i >> 2) & 1) as f64);
                let toward = scale * (min + pick * (max - min)) + place - eye;
                assert!(forward.dot(toward.normalize()) > 20f64.to_radians().cos(), "{scale} {place}");
            }
        }
    }

    #[test]
    fn what_single_precision_cannot_frame_is_said() {
        let frame = |scale: f64, place: DVec3| camera_on(place - scale, place + scale);
        let far = DVec3::new(1000.0, 500.0, -1000.0);
        assert!(frame(1e-2, far).is_ok());
        let error = frame(1e-5, far).unwrap_err().to_string();
        for word in ["2.00e-5", "1.00e3", "single precision", "move it nearer"] {
            assert!(error.contains(word), "{error}");
        }
        assert!(frame(3e38, DVec3::ZERO).is_err());
        assert!(frame(0.0, far).is_err());
    }

    #[test]
    fn bounds_far_away_keep_their_size() {
        let place = Pose { scale: 1e-5, ..Pose::from_translation(Vec3::new(1000.0, 500.0, -1000.0)) };
        let mut scene = Scene::at_rest("far", Vec::new(), Environment::constant(Vec3::ONE));
        scene.objects.push(Object::new("box", box_mesh(1)).albedo(Vec3::ONE).pose(place));
        let (min, max) = bounds_of(&scene.objects);
        assert!((max - min).abs_diff_eq(DVec3::splat(2e-5), 1e-11), "{min} {max}");
    }
}
