//! Colours that light and surfaces can have.

use glam::Vec3;

/// A radiance, or what is wrong with it.
pub(super) fn radiance(color: Vec3) -> Result<Vec3, String> {
    match color.is_finite() && color.min_element() >= 0.0 {
        true => Ok(color),
        false => Err(format!("radiance {color} must be finite and not negative")),
    }
}

/// A reflected fraction of light, or what is wrong with it.
pub(super) fn albedo(color: Vec3) -> Result<Vec3, String> {
    match color.to_array().iter().all(|fraction| (0.0..=1.0).contains(fraction)) {
        true => Ok(color),
        false => Err(format!("reflectance {color} must be within [0, 1]")),
    }
}
