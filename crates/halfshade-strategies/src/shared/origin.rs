//! Where single precision is spent.

use glam::DVec3;
use halfshade_rays::origin_between;

/// [`origin_between`] the corners of points; 0 for none.
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
    fn the_origin_of_points_lies_between_their_corners() {
        let points = [DVec3::new(1e6 + 0.25, -1.0, 3.0), DVec3::new(1e6, 0.5, 3.0), DVec3::new(1e6 - 0.5, 1.0, 3.0)];
        assert_eq!(origin_of(points), DVec3::new(999_999.875, 0.0, 3.0));
        assert_eq!(origin_of([]), DVec3::ZERO);
    }
}
