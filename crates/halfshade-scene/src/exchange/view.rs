//! The view of a file's camera.

use crate::camera::check_resolution;
use crate::mesh::LARGEST_COORDINATE;
use crate::{Camera, SceneError};
use glam::{DMat4, DQuat, DVec3, Vec3};

/// Deviation of unit vectors that is rounding.
const ROUNDING: f64 = 1e-4;

/// A pinhole camera in the file's space.
#[derive(Debug, Clone)]
pub(super) struct View {
    pub(super) eye: DVec3,
    /// A point in the middle of the picture.
    pub(super) target: DVec3,
    /// Unit vector upward in the picture.
    pub(super) up: DVec3,
    /// Unit vector to the right in the picture.
    pub(super) right: DVec3,
    pub(super) vertical_fov_degrees: f64,
    pub(super) resolution: [u32; 2],
    pub(super) line: usize,
}

impl View {
    /// A camera at the origin of a space whose axes point to the right, up, and as the camera looks.
    pub(super) fn new(world_from_camera: &DMat4, target: Option<DVec3>, line: usize) -> Self {
        let axis = |axis: glam::DVec4| axis.truncate().normalize_or(DVec3::ZERO);
        let eye = world_from_camera.w_axis.truncate();
        Self {
            eye,
            target: target.unwrap_or(eye + axis(world_from_camera.z_axis)),
            up: axis(world_from_camera.y_axis),
            right: axis(world_from_camera.x_axis),
            vertical_fov_degrees: 40.0,
            resolution: [800, 600],
            line,
        }
    }

    /// The way from the file's space to one of right hands in which +Y is up in the picture: a reflection if the picture
    /// would be mirrored otherwise, and a turn of the first axis that does to +Y.
    pub(super) fn upright(&self) -> DMat4 {
        let forward = (self.target - self.eye).normalize_or(DVec3::NEG_Z);
        let is_mirrored = self.right.dot(forward.cross(self.up)) < 0.0;
        let mirror = DMat4::from_scale(DVec3::new(if is_mirrored { -1.0 } else { 1.0 }, 1.0, 1.0));
        let up = mirror.transform_vector3(self.up);
        let axes = [DVec3::Y, DVec3::Z, DVec3::X, DVec3::NEG_Y, DVec3::NEG_Z, DVec3::NEG_X, up];
        let turns = axes.map(|axis| whole(DMat4::from_quat(DQuat::from_rotation_arc(axis, DVec3::Y))) * mirror);
        let fits = |turn: &&DMat4| {
            let camera = self.unchecked(turn);
            camera.up().as_dvec3().distance(turn.transform_vector3(self.up)) < ROUNDING
        };
        turns.iter().find(fits).copied().unwrap_or(mirror)
    }

    fn unchecked(&self, world_from_file: &DMat4) -> Camera {
        let point = |p: DVec3| world_from_file.transform_point3(p).as_vec3();
        Camera {
            eye: point(self.eye),
            target: point(self.target),
            vertical_fov_degrees: self.vertical_fov_degrees as f32,
            resolution: self.resolution,
        }
    }

    /// The camera in world space.
    pub(super) fn camera(&self, world_from_file: &DMat4) -> Result<Camera, SceneError> {
        let wrong = |problem: String| SceneError::new(problem).at_line(self.line);
        let camera = self.unchecked(world_from_file);
        let is_near = |p: Vec3| p.is_finite() && p.abs().max_element() <= LARGEST_COORDINATE;
        if !(is_near(camera.eye) && is_near(camera.target)) || camera.eye == camera.target {
            return Err(wrong(format!("the camera looks from {} to {}", camera.eye, camera.target)));
        }
        if !(camera.vertical_fov_degrees > 0.0 && camera.vertical_fov_degrees < 180.0) {
            return Err(wrong(format!(
                "the camera's field of view spans {} degrees in height",
                camera.vertical_fov_degrees
            )));
        }
        check_resolution(camera.resolution).map_err(wrong)?;
        Ok(camera)
    }
}

/// A turn that is one of quarters, without the rounding of its sines.
fn whole(turn: DMat4) -> DMat4 {
    let rounded = turn.to_cols_array().map(f64::round);
    let rounded = DMat4::from_cols_array(&rounded);
    if rounded.abs_diff_eq(turn, 1e-9) { rounded } else { turn }
}

/// The vertical angle of a field of view whose angle `degrees` spans a width of `across`, for a height of `height`.
pub(super) fn vertical_degrees(degrees: f64, across: f64, height: f64) -> f64 {
    if across == height {
        return degrees;
    }
    2.0 * ((0.5 * degrees).to_radians().tan() * height / across).atan().to_degrees()
}

#[cfg(test)]
mod tests {
    use super::*;

    fn view(forward: DVec3, up: DVec3, is_right_handed: bool) -> View {
        let right = forward.cross(up) * if is_right_handed { 1.0 } else { -1.0 };
        let matrix = DMat4::from_cols(right.extend(0.0), up.extend(0.0), forward.extend(0.0), DVec3::ONE.extend(1.0));
        View::new(&matrix, None, 1)
    }

    #[test]
    fn whichever_axis_is_up_becomes_y_and_pictures_keep_their_sides() {
        let slanted = DVec3::new(0.48, -0.6, 0.64);
        for axis in [DVec3::Y, DVec3::Z, DVec3::X, DVec3::NEG_Z] {
            for hand in [true, false] {
                let up = (axis - axis.dot(slanted) * slanted).normalize();
                let view = view(slanted, up, hand);
                let world = view.upright();
                let camera = view.camera(&world).unwrap();
                assert!(world.transform_vector3(axis).distance(DVec3::Y) < 1e-9, "{axis} {hand}: {world}");
                // A point to the right lies to the right in our picture.
                let aside = world.transform_point3(view.target + 0.1 * view.right).as_vec3();
                let [column, _] = camera.pixel_at(aside).unwrap();
                assert!(column > 400.5, "{axis} {hand}: {column}");
            }
        }
        assert_eq!(view(slanted, DVec3::new(0.36, 0.8, 0.48), true).upright(), DMat4::IDENTITY);
        // Straight down, where -Z is up in our pictures.
        assert_eq!(view(DVec3::NEG_Y, DVec3::NEG_Z, true).upright(), DMat4::IDENTITY);
    }

    #[test]
    fn fields_of_view_are_turned_upright_and_bad_cameras_refused() {
        assert_eq!(vertical_degrees(40.0, 600.0, 600.0), 40.0);
        assert!((vertical_degrees(90.0, 2.0, 1.0) - 53.130_102).abs() < 1e-5);
        let sound = view(DVec3::X, DVec3::Y, true);
        for bad in [
            View { eye: DVec3::splat(1e20), ..sound.clone() },
            View { target: sound.eye, ..sound.clone() },
            View { vertical_fov_degrees: 180.0, ..sound.clone() },
            View { vertical_fov_degrees: f64::NAN, ..sound.clone() },
            View { resolution: [0, 5], ..sound.clone() },
        ] {
            assert!(bad.camera(&bad.upright()).is_err(), "{bad:?}");
        }
    }
}
