//! Polygons cut into triangles.

use super::doubled_area_vector;
use earcut::Earcut;
use glam::{DVec3, Vec3};

/// Change of a polygon's area by cutting that is allowed, as a fraction of it: coordinates in f32 aren't quite in a
/// plane.
const AREA_TOLERANCE: f64 = 1e-6;

/// More corners than the ear cutter can count; such a polygon is cut as a fan.
const MOST_CORNERS: usize = 20_000_000;

/// Cuts polygons into triangles.
///
/// A polygon all of which its first corner sees, as every convex one, becomes a fan around that corner. Any other is cut
/// by ears on the coordinate plane that its normal (the sum of the fan's area vectors, which is Newell's) is steepest to.
/// A polygon that crosses itself has no right triangles: it gets some, and is counted.
#[derive(Default)]
pub(super) struct Cutter {
    ears: Earcut<f64>,
    places: Vec<[f64; 2]>,
    found: Vec<u32>,
    /// Number of polygons that had another area than their triangles.
    crossing: usize,
}

impl Cutter {
    /// Appends the triangles of a polygon of at least three corners: numbers of corners, wound as the polygon is.
    pub(super) fn cut(&mut self, corners: &[Vec3], triangles: &mut Vec<[u32; 3]>) {
        let fan = (1..corners.len().saturating_sub(1) as u32).map(|i| [0, i, i + 1]);
        let corner = |i: u32| corners[i as usize];
        let area_vectors = || fan.clone().map(|triangle| doubled_area_vector(triangle.map(corner)));
        if corners.len() == 3 {
            triangles.extend(fan);
            return;
        }
        let normal: DVec3 = area_vectors().sum();
        let area = normal.length();
        let turned_away: f64 = area_vectors().map(|vector| -vector.dot(normal).min(0.0)).sum();
        // Not finite: the mesh is refused later.
        if turned_away <= AREA_TOLERANCE * area * area || !turned_away.is_finite() {
            // Triangles that cancel leave no normal: a polygon like an eight.
            self.crossing += usize::from(area == 0.0 && area_vectors().any(|vector| vector != DVec3::ZERO));
            triangles.extend(fan);
            return;
        }
        if corners.len() > MOST_CORNERS {
            self.crossing += 1;
            triangles.extend(fan);
            return;
        }
        // Leaving one coordinate out keeps the others exact, as a projection along the normal would not.
        let dropped = normal.abs().max_position();
        let [u, v] = [(dropped + 1) % 3, (dropped + 2) % 3];
        self.places.clear();
        self.places.extend(corners.iter().map(|corner| [f64::from(corner[u]), f64::from(corner[v])]));
        self.ears.earcut(self.places.iter().copied(), &[], &mut self.found);
        let places = &self.places;
        let doubled_area = |triangle: &[u32]| {
            let [a, b, c] = [triangle[0], triangle[1], triangle[2]].map(|i| places[i as usize]);
            (b[0] - a[0]) * (c[1] - a[1]) - (b[1] - a[1]) * (c[0] - a[0])
        };
        let expected = normal[dropped].abs();
        let sum: f64 = self.found.chunks_exact(3).map(|triangle| doubled_area(triangle).abs()).sum();
        self.crossing += usize::from((sum - expected).abs() > 4.0 * AREA_TOLERANCE * expected);
        if self.found.is_empty() {
            triangles.extend(fan);
            return;
        }
        // The cutter turns all triangles one way, whichever way the polygon runs.
        triangles.extend(self.found.chunks_exact(3).map(|triangle| {
            let turned = doubled_area(triangle).is_sign_positive() != normal[dropped].is_sign_positive();
            if turned { [triangle[0], triangle[2], triangle[1]] } else { [triangle[0], triangle[1], triangle[2]] }
        }));
    }

    /// A note on polygons that cross themselves.
    pub(super) fn note(&self) -> Option<String> {
        (self.crossing > 0)
            .then(|| format!("polygons that cross themselves, cut into triangles somehow: {}", self.crossing))
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use glam::{DMat3, DQuat};
    use proptest::prelude::*;
    use rand::{RngExt, SeedableRng};
    use rand_pcg::Pcg64Mcg;
    use std::f64::consts::TAU;

    fn cut(corners: &[Vec3]) -> (Vec<[u32; 3]>, bool) {
        let (mut cutter, mut triangles) = (Cutter::default(), Vec::new());
        cutter.cut(corners, &mut triangles);
        (triangles, cutter.note().is_some())
    }

    fn area_of(corners: &[Vec3], triangles: &[[u32; 3]]) -> f64 {
        triangles.iter().map(|t| 0.5 * doubled_area_vector(t.map(|i| corners[i as usize])).length()).sum()
    }

    /// Area by Newell's formula, from the edges; no triangle takes part.
    fn newell_area(corners: &[Vec3]) -> f64 {
        let centre = corners[0].as_dvec3();
        let next = corners.iter().cycle().skip(1);
        let sum: DVec3 =
            corners.iter().zip(next).map(|(a, b)| (a.as_dvec3() - centre).cross(b.as_dvec3() - centre)).sum();
        0.5 * sum.length()
    }

    /// Corners in the plane z = 0.
    fn flat(places: &[[f64; 2]]) -> Vec<Vec3> {
        places.iter().map(|p| Vec3::new(p[0] as f32, p[1] as f32, 0.0)).collect()
    }

    fn check_simple(corners: &[Vec3]) {
        let (triangles, crossing) = cut(corners);
        let (area, expected) = (area_of(corners, &triangles), newell_area(corners));
        assert!(!crossing && (area - expected).abs() <= 1e-5 * expected, "{area} {expected} {corners:?}");
        let normal: DVec3 = triangles.iter().map(|t| doubled_area_vector(t.map(|i| corners[i as usize]))).sum();
        for triangle in &triangles {
            let vector = doubled_area_vector(triangle.map(|i| corners[i as usize]));
            assert!(vector.dot(normal) >= -1e-6 * normal.length_squared(), "{triangle:?} {corners:?}");
        }
    }

    #[test]
    fn an_arrowhead_has_its_area_whichever_corner_comes_first_and_whichever_way_it_runs() {
        let mut places = [[0.0, 0.0], [2.0, 1.0], [0.0, 2.0], [1.0, 1.0]];
        for _ in 0..4 {
            places.rotate_left(1);
            for mirrored in [false, true] {
                if mirrored {
                    places.reverse();
                }
                let corners = flat(&places);
                let (triangles, crossing) = cut(&corners);
                assert!(triangles.len() == 2 && !crossing);
                assert!((area_of(&corners, &triangles) - 1.0).abs() < 1e-12);
                check_simple(&corners);
            }
            places.reverse();
        }
    }

    #[test]
    fn what_the_first_corner_sees_stays_a_fan() {
        let regular: Vec<_> = (0..9).map(|i| (f64::from(i) / 9.0 * TAU).sin_cos()).map(|(s, c)| [c, s]).collect();
        for places in [&regular[..], &[[1.0, 1.0], [0.0, 0.0], [2.0, 1.0], [0.0, 2.0]]] {
            let (triangles, _) = cut(&flat(places));
            assert_eq!(triangles, (1..places.len() as u32 - 1).map(|i| [0, i, i + 1]).collect::<Vec<_>>());
        }
        // A warped quad too.
        let warped = [Vec3::ZERO, Vec3::X, Vec3::new(1.0, 1.0, 0.7), Vec3::Y];
        assert_eq!(cut(&warped).0, [[0, 1, 2], [0, 2, 3]]);
    }

    #[test]
    fn polygons_without_right_triangles_are_counted_and_finite() {
        for (places, crosses) in [
            (&[[0.0, 0.0], [1.0, 1.0], [1.0, 0.0], [0.0, 1.0]][..], true),
            (&[[0.0, 0.0], [3.0, 3.0], [3.0, 0.0], [0.0, 2.0]], true),
            (&[[0.0, 0.0], [1.0, 0.0], [2.0, 0.0], [3.0, 0.0]], false),
            (&[[0.0, 0.0]; 5], false),
            // A corner twice, and a corner that two parts share.
            (&[[0.0, 0.0], [2.0, 1.0], [2.0, 1.0], [0.0, 2.0], [1.0, 1.0]], false),
            (&[[0.0, 0.0], [2.0, -1.0], [2.0, 1.0], [0.0, 0.0], [-2.0, 1.0], [-2.0, -1.0]], false),
        ] {
            let corners = flat(places);
            let (triangles, crossing) = cut(&corners);
            assert!(
                crossing == crosses && triangles.iter().flatten().all(|&i| (i as usize) < corners.len()),
                "{places:?}"
            );
            if !crosses {
                assert!((area_of(&corners, &triangles) - newell_area(&corners)).abs() < 1e-12, "{places:?}");
            }
        }
        for bad in [f32::NAN, f32::INFINITY, f32::MAX] {
            let mut corners = flat(&[[0.0, 0.0], [2.0, 1.0], [0.0, 2.0], [1.0, 1.0], [0.5, 1.0]]);
            corners[1].y = bad;
            cut(&corners);
        }
    }

    /// Outlines of many corners that are hard for cutters of ears: a comb, a star, a spiral corridor, a saw in a circle.
    fn outlines(count: usize) -> Vec<Vec<Vec3>> {
        let half = count / 2;
        let comb = (0..half)
            .map(|i| [i as f64, if i % 2 == 0 { 0.0 } else { 1e4 }])
            .chain((0..half).rev().map(|i| [i as f64, -1.0]));
        let polar = |radius: f64, turns: f64| [radius * (TAU * turns).cos(), radius * (TAU * turns).sin()];
        let star = (0..count).map(|i| polar(if i % 2 == 0 { 1.0 } else { 0.5 }, i as f64 / count as f64));
        let spiral =
            |i: usize, width: f64| polar(1.0 + 20.0 * i as f64 / half as f64 + width, 20.0 * i as f64 / half as f64);
        let corridor = (0..half).map(|i| spiral(i, 0.4)).chain((0..half).rev().map(|i| spiral(i, 0.0)));
        let mut random = Pcg64Mcg::seed_from_u64(1);
        let rough = (0..count).map(|i| polar(random.random_range(0.5..1.0), i as f64 / count as f64));
        [comb.collect::<Vec<_>>(), star.collect(), corridor.collect(), rough.collect()]
            .iter()
            .map(|p| flat(p))
            .collect()
    }

    #[test]
    fn outlines_of_many_corners_keep_their_area() {
        for outline in outlines(3000) {
            check_simple(&outline);
        }
    }

    proptest! {
        #![proptest_config(ProptestConfig { cases: 400, failure_persistence: None, ..ProptestConfig::default() })]

        /// A star-shaped polygon seen from a point inside that is no corner: simple by construction.
        #[test]
        fn simple_polygons_in_any_plane_at_any_scale_keep_their_area(
            radii in prop::collection::vec(0.05..1.0_f64, 4..60),
            axis in prop::array::uniform3(-1.0..1.0_f64),
            angle in 0.0..TAU,
            exponent in -6.0..6.0_f64,
            shift in prop::array::uniform3(-3.0..3.0_f64),
        ) {
            let turn = DQuat::from_axis_angle(DVec3::from(axis).try_normalize().unwrap_or(DVec3::X), angle);
            let scale = 10.0_f64.powf(exponent);
            let frame = DMat3::from_quat(turn) * scale;
            let count = radii.len() as f64;
            let corners: Vec<Vec3> = radii.iter().enumerate().map(|(i, radius)| {
                let (sin, cos) = (TAU * i as f64 / count).sin_cos();
                (frame * (DVec3::new(radius * cos, radius * sin, 0.0) + DVec3::from(shift))).as_vec3()
            }).collect();
            check_simple(&corners);
        }

        /// Walks along the edges of a grid's cells: right angles and corners on straight lines.
        #[test]
        fn skylines_keep_their_area_and_every_corner(heights in prop::collection::vec(1..5_i32, 2..30), axis in 0..3_usize) {
            let mut places: Vec<[i32; 2]> = (0..=heights.len() as i32).map(|x| [x, 0]).collect();
            for (x, height) in heights.iter().enumerate().rev() {
                let x = x as i32;
                let column = [[x + 1, *height], [x, *height]];
                places.extend(column.into_iter().filter(|place| !places.contains(place)).collect::<Vec<_>>());
            }
            let corners: Vec<Vec3> = places.iter().map(|[x, y]| {
                let mut corner = Vec3::ZERO;
                corner[(axis + 1) % 3] = *x as f32;
                corner[(axis + 2) % 3] = *y as f32;
                corner
            }).collect();
            check_simple(&corners);
            let expected: i32 = heights.iter().sum();
            prop_assert!((area_of(&corners, &cut(&corners).0) - f64::from(expected)).abs() < 1e-9);
        }
    }
}
