//! Profiles for the lathe, drawn by a few control points.

use super::lathe::ProfilePoint;
use glam::DVec2;

/// Points of a profile are so spread that a turn by one radian counts like this length, in metres: rims stay round.
const TURN_LENGTH: f64 = 0.10;

/// `count` points along the uniform cubic B-spline of `controls` from axis to axis, closer together where it bends.
///
/// A B-spline stays within its control points' hull, so radii stay positive. At both ends the control polygon is
/// continued by its mirror image: the curve starts on the axis, perpendicular to it.
pub(super) fn spline_profile(controls: &[[f64; 2]], count: usize) -> Vec<ProfilePoint> {
    let mirrored = |[radius, height]: [f64; 2]| DVec2::new(-radius, height);
    let last = controls.len() - 1;
    let mut points = vec![mirrored(controls[1])];
    points.extend(controls.iter().map(|&c| DVec2::from(c)));
    points.push(mirrored(controls[last - 1]));
    const STEPS: usize = 64;
    let mut fine: Vec<DVec2> = points
        .windows(4)
        .flat_map(|p| {
            (0..STEPS).map(move |step| {
                let t = step as f64 / STEPS as f64;
                let (t2, t3) = (t * t, t * t * t);
                (p[0] * (1.0 - 3.0 * t + 3.0 * t2 - t3)
                    + p[1] * (4.0 - 6.0 * t2 + 3.0 * t3)
                    + p[2] * (1.0 + 3.0 * t + 3.0 * t2 - 3.0 * t3)
                    + p[3] * t3)
                    / 6.0
            })
        })
        .collect();
    let end = points.len() - 3;
    fine.push((points[end] + 4.0 * points[end + 1] + points[end + 2]) / 6.0);

    let mut passed = vec![0.0];
    for (i, pair) in fine.windows(2).enumerate() {
        let edge = pair[1] - pair[0];
        let turned = fine.get(i + 2).map_or(0.0, |after| edge.angle_to(after - pair[1]).abs());
        passed.push(passed[i] + edge.length() + TURN_LENGTH * turned);
    }
    let total = passed[passed.len() - 1];
    (0..count)
        .map(|i| {
            let goal = total * i as f64 / (count - 1) as f64;
            let after = passed.partition_point(|&length| length < goal).clamp(1, fine.len() - 1);
            let (before, span) = (after - 1, passed[after] - passed[after - 1]);
            let point = fine[before].lerp(fine[after], (goal - passed[before]) / span);
            let on_axis = i == 0 || i == count - 1;
            ProfilePoint::smooth(if on_axis { 0.0 } else { point.x as f32 }, point.y as f32)
        })
        .collect()
}
