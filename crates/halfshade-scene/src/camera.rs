//! The pinhole camera of pictures.

use glam::{DVec3, Vec3};
use serde::Serialize;

/// A pinhole camera.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
pub struct Camera {
    /// Eye in world space.
    pub eye: Vec3,
    /// The point looked at, in world space.
    pub target: Vec3,
    /// Angle spanned by the picture's height, in degrees, in (0, 180).
    pub vertical_fov_degrees: f32,
    /// Width and height in pixels.
    pub resolution: [u32; 2],
}

/// Largest width or height of a picture, and most pixels: those of 8K UHD.
pub const MAX_SIDE: u32 = 16_384;
const MAX_PIXELS: u64 = 7680 * 4320;

/// Refuses pictures without pixels, and those that fill the memory.
pub fn check_resolution([width, height]: [u32; 2]) -> Result<(), String> {
    let sides = 1..=MAX_SIDE;
    if sides.contains(&width) && sides.contains(&height) && u64::from(width) * u64::from(height) <= MAX_PIXELS {
        return Ok(());
    }
    Err(format!(
        "a picture of {width}x{height}: each side must be from 1 to {MAX_SIDE}, and at most {MAX_PIXELS} pixels in all"
    ))
}

impl Camera {
    /// Unit direction toward the target.
    fn forward(&self) -> Vec3 {
        let toward = self.target - self.eye;
        // Squares of lengths beyond these lose digits in single precision.
        if (1e-30..1e30).contains(&toward.length_squared()) {
            return toward.normalize();
        }
        (self.target.as_dvec3() - self.eye.as_dvec3()).normalize_or(DVec3::NEG_Z).as_vec3()
    }

    /// Unit vectors to the right, up and forward.
    fn axes(&self) -> [Vec3; 3] {
        let forward = self.forward();
        let right =
            forward.cross(Vec3::Y).try_normalize().unwrap_or_else(|| forward.cross(Vec3::NEG_Z).normalize_or(Vec3::X));
        [right, right.cross(forward), forward]
    }

    /// Unit vector in world space that points up in the picture.
    pub fn up(&self) -> Vec3 {
        self.axes()[1]
    }

    /// Pixel coordinates of a point before the eye: those whose [`Self::ray_direction`] leads there.
    pub fn pixel_at(&self, point: Vec3) -> Option<[f64; 2]> {
        let offset = point.as_dvec3() - self.eye.as_dvec3();
        let [x, y, depth] = self.axes().map(|axis| axis.as_dvec3().dot(offset));
        let [width, height] = self.resolution.map(f64::from);
        let half_height = (0.5 * f64::from(self.vertical_fov_degrees).to_radians()).tan() * depth;
        let place = [0.5 * (width + x / half_height * height), 0.5 * height * (1.0 - y / half_height)];
        (depth > 0.0 && place.iter().all(|place| place.is_finite())).then_some(place)
    }

    /// Unit direction in world space through pixel coordinates; pixel (0, 0) is top left and its centre lies at
    /// (0.5, 0.5). +Y is up unless the camera looks along it; then -Z is.
    pub fn ray_direction(&self, column: f32, row: f32) -> Vec3 {
        let [right, up, forward] = self.axes();
        let [width, height] = self.resolution.map(|n| n as f32);
        let half_height = (0.5 * self.vertical_fov_degrees.to_radians()).tan();
        let x = (2.0 * column - width) / height * half_height;
        let y = (1.0 - 2.0 * row / height) * half_height;
        (forward + x * right + y * up).normalize()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_height_spans_the_field_of_view() {
        let camera =
            Camera { eye: Vec3::ZERO, target: Vec3::NEG_Z, vertical_fov_degrees: 60.0, resolution: [200, 100] };
        assert!(camera.ray_direction(100.0, 50.0).distance(Vec3::NEG_Z) < 1e-6);
        let (top, bottom) = (camera.ray_direction(100.0, 0.0), camera.ray_direction(100.0, 100.0));
        assert!((top.angle_between(bottom).to_degrees() - 60.0).abs() < 1e-3);
        assert!(top.y > 0.0 && camera.ray_direction(200.0, 50.0).x > 0.0);
        for (column, row) in [(0.5, 0.5), (30.0, 80.0), (199.5, 12.5)] {
            let [x, y] = camera.pixel_at(7.0 * camera.ray_direction(column, row)).unwrap();
            assert!((x - f64::from(column)).abs() < 1e-4 && (y - f64::from(row)).abs() < 1e-4, "{x} {y}");
        }
        assert_eq!(camera.pixel_at(Vec3::Z), None);
        // At any scale.
        for scale in [1e-30, 1e-21, 1e-10, 1e10, 1e30] {
            let scaled = Camera { target: scale * Vec3::new(3.0, 0.0, -4.0), ..camera };
            assert!(scaled.ray_direction(100.0, 50.0).distance(Vec3::new(0.6, 0.0, -0.8)) < 1e-6, "{scale}");
        }
    }
}
