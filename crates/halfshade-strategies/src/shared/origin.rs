//! Where single precision is spent.

use glam::{DVec3, Vec3};

/// An origin for what lies between two corners: along each axis the middle if the middle is at least twice as far from 0
/// as from either end, else 0.
///
/// Coordinates about it are nowhere larger than before, and differences of it and of single-precision coordinates within
/// the corners are exact. So nothing is lost, however far apart things are: one that is far away doesn't take the digits
/// of those that are near, and a scene that was moved as a whole gets its own back.
pub fn origin_between(low: DVec3, high: DVec3) -> DVec3 {
    let (middle, half) = (0.5 * (low + high), 0.5 * (high - low));
    let along = |axis: usize| if middle[axis].abs() >= 2.0 * half[axis] { middle[axis] as f32 } else { 0.0 };
    let origin = Vec3::from_array(std::array::from_fn(along));
    if origin.is_finite() { origin.as_dvec3() } else { DVec3::ZERO }
}

/// The same for points; 0 for none.
pub(crate) fn origin_of(points: impl IntoIterator<Item = DVec3>) -> DVec3 {
    let corners = points.into_iter().fold(None, |corners: Option<(DVec3, DVec3)>, point| {
        Some(corners.map_or((point, point), |(low, high)| (low.min(point), high.max(point))))
    });
    corners.map_or(DVec3::ZERO, |(low, high)| origin_between(low, high))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn nothing_gets_larger_coordinates() {
        let near = [DVec3::new(1e6 + 0.25, -1.0, 3.0), DVec3::new(1e6 - 0.5, 1.0, 3.0)];
        assert_eq!(origin_of(near), DVec3::new(999_999.875, 0.0, 3.0));
        let far = DVec3::new(1e8, 0.0, 3.0);
        assert_eq!(origin_of([near[0] - DVec3::X * 1e6, far]), DVec3::new(0.0, 0.0, 3.0));
        assert_eq!(origin_of([far]), far);
        assert_eq!(origin_of([]), DVec3::ZERO);
        assert_eq!(origin_of([DVec3::splat(1e300), DVec3::splat(1.1e300)]), DVec3::ZERO);
    }
}
