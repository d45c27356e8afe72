//! A watertight test of a ray against a triangle.
//!
//! The method is that of \[Woop2013\]: space is sheared so that the ray becomes the third axis, and the signs of three
//! edge functions of the sheared vertices decide. A sheared vertex depends on the vertex and the ray alone, and an edge
//! function of zero counts as inside for both neighbours, so no ray slips between two triangles that share an edge or a
//! vertex. Signs that single precision leaves in doubt are found in double precision, so that the corner between
//! triangles many orders of magnitude larger than what stands in it is closed too.
//!
//! Where a ray crosses the plane of a triangle is found in double precision: the distance to a large ground close by is
//! the difference of large numbers.
//!
//! Laid out by axis instead of by vertex, the three vertices are sheared at once in one vector register.

use glam::{DVec3, Vec3A, Vec3Swizzles};

/// How far rounding may move an edge function, in units of the products that [`Triangle::is_crossed`] adds up: 14
/// halves of a unit in the last place, rounded up.
const EDGE_ROUNDING: f32 = 8.0 * f32::EPSILON;

/// How far behind its origin a ray meets what faces it, in lengths of its slack.
const REACH_BEHIND: f32 = 4.0;

/// The three vertices of a triangle by axis: `rows[axis] = (v0[axis], v1[axis], v2[axis])`.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Triangle {
    rows: [Vec3A; 3],
}

/// A ray, ready for tests against many triangles.
#[derive(Debug, Clone, Copy)]
pub(crate) struct ShearedRay {
    axes: [usize; 3],
    /// Permuted by `axes`.
    origin: [f32; 3],
    shear: [f32; 2],
    /// As given.
    start: Vec3A,
    direction: Vec3A,
    /// How far, along each axis, the origin may lie beside the surface that it stands for.
    slack: Vec3A,
    /// How far behind its origin it meets what faces it.
    reach: f64,
}

/// How surely a ray's origin lies on its surface.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Slack {
    /// How far, along each axis, the surface may lie beside where it is taken to be.
    pub(crate) along: Vec3A,
    /// Unit normal of the surface.
    pub(crate) normal: Vec3A,
}

impl Slack {
    /// In free space.
    pub(crate) const NONE: Self = Self { along: Vec3A::ZERO, normal: Vec3A::ZERO };
}

/// Hit of a ray on a triangle.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Crossing {
    /// Distance in lengths of the ray's direction, positive but for the ray's slack.
    pub(crate) distance: f64,
    /// Weights of the three vertices, not negative, of sum 1.
    pub(crate) barycentrics: DVec3,
}

impl ShearedRay {
    /// A ray from `origin` along `direction`, which is neither zero nor infinite.
    #[inline(always)]
    pub(crate) fn new(origin: Vec3A, direction: Vec3A) -> Self {
        let size = direction.abs();
        let (axes, permuted, along) = if size.x > size.y.max(size.z) {
            ([1, 2, 0], origin.yzx(), direction.yzx())
        } else if size.y > size.z {
            ([2, 0, 1], origin.zxy(), direction.zxy())
        } else {
            ([0, 1, 2], origin, direction)
        };
        let inverse = 1.0 / along.z;
        Self {
            axes,
            origin: permuted.to_array(),
            shear: [along.x * inverse, along.y * inverse],
            start: origin,
            direction,
            slack: Vec3A::ZERO,
            reach: 0.0,
        }
    }

    /// The same ray, started anywhere within `slack` (along each axis) of a triangle: it meets those that face it up to
    /// that far behind its origin, and doesn't meet those that face away until that far ahead, as measured along their
    /// normals.
    ///
    /// A receiver at the foot of a wall lies in the plane of the ground: rays that start there and go down cross the
    /// ground at distance 0 and must not escape below, while those that go up must not be blocked by it.
    ///
    /// Origins are lifted by twice their slack. Triangles farther behind than half of that, along the normal, may be
    /// below the surface on which the ray starts: at an edge it would meet the side that it has just left.
    #[inline(always)]
    pub(crate) fn with_slack(self, slack: Slack) -> Self {
        let off = slack.normal.abs().dot(slack.along);
        let leaves = self.direction.dot(slack.normal).max(f32::MIN_POSITIVE);
        let reach = (REACH_BEHIND * slack.along.max_element()).min(off / leaves);
        Self { slack: slack.along, reach: f64::from(reach), ..self }
    }
}

impl Triangle {
    /// The triangle of three vertices.
    pub(crate) fn new(vertices: [Vec3A; 3]) -> Self {
        let [a, b, c] = vertices;
        Self { rows: std::array::from_fn(|axis| Vec3A::new(a[axis], b[axis], c[axis])) }
    }

    /// The distance at which the ray crosses the triangle, in lengths of its direction; infinite if it doesn't. Positive,
    /// but for the ray's slack.
    #[inline(always)]
    pub(crate) fn distance(&self, ray: &ShearedRay) -> f32 {
        if !self.is_crossed(ray) {
            return f32::INFINITY;
        }
        self.plane_crossing(ray).map_or(f32::INFINITY, |(distance, _)| distance as f32)
    }

    /// The crossing with its barycentric coordinates.
    pub(crate) fn crossing(&self, ray: &ShearedRay) -> Option<Crossing> {
        let (distance, normal) = self.is_crossed(ray).then(|| self.plane_crossing(ray))??;
        let [a, b, c] = self.vertices();
        let point = ray.start.as_dvec3() + distance * ray.direction.as_dvec3() - a;
        let squared = normal.length_squared();
        let (v, w) = (normal.dot(point.cross(c - a)) / squared, normal.dot((b - a).cross(point)) / squared);
        let weights = DVec3::new(1.0 - v - w, v, w).max(DVec3::ZERO);
        Some(Crossing { distance, barycentrics: weights / weights.element_sum() })
    }

    fn vertices(&self) -> [DVec3; 3] {
        [0, 1, 2].map(|vertex| DVec3::from_array(self.rows.map(|row| f64::from(row[vertex]))))
    }

    /// Whether the line of the ray passes through the triangle.
    #[inline(always)]
    fn is_crossed(&self, ray: &ShearedRay) -> bool {
        let [kx, ky, kz] = ray.axes;
        let z = self.rows[kz] - Vec3A::splat(ray.origin[2]);
        let x = (self.rows[kx] - Vec3A::splat(ray.origin[0])) - ray.shear[0] * z;
        let y = (self.rows[ky] - Vec3A::splat(ray.origin[1])) - ray.shear[1] * z;
        let edges = x.zxy() * y.yzx() - y.zxy() * x.yzx();
        // Sheared coordinates err by six halves of a unit in the last place of `reach`.
        let across = x.abs().max(y.abs());
        let reach = across + z.abs();
        let doubt = EDGE_ROUNDING * (across.zxy() * reach.yzx() + across.yzx() * reach.zxy());
        let (negative, positive) = (edges.cmplt(-doubt).bitmask(), edges.cmpgt(doubt).bitmask());
        if negative != 0 && positive != 0 {
            return false;
        }
        negative | positive == 0b111 || self.is_crossed_exactly(ray)
    }

    /// [`Self::is_crossed`] in double precision.
    #[cold]
    fn is_crossed_exactly(&self, ray: &ShearedRay) -> bool {
        let [kx, ky, kz] = ray.axes;
        let (start, direction) = (ray.start.as_dvec3(), ray.direction.as_dvec3());
        let row = |axis: usize| self.rows[axis].as_dvec3() - DVec3::splat(start[axis]);
        let z = row(kz);
        let x = row(kx) - direction[kx] / direction[kz] * z;
        let y = row(ky) - direction[ky] / direction[kz] * z;
        // No fused multiply-add here: rounding both products alike makes the function of an edge exactly the negative
        // of its neighbour's.
        let edge = |i: usize, k: usize| x[i] * y[k] - y[i] * x[k];
        let edges = [edge(2, 1), edge(0, 2), edge(1, 0)];
        edges.iter().all(|&edge| edge >= 0.0) || edges.iter().all(|&edge| edge <= 0.0)
    }

    /// Where the ray crosses the plane, and the plane's normal, as long as twice the triangle's area. `None` if that is
    /// behind its origin, or the plane holds the ray.
    #[inline(always)]
    fn plane_crossing(&self, ray: &ShearedRay) -> Option<(f64, DVec3)> {
        let [a, b, c] = self.vertices();
        let normal = (b - a).cross(c - a);
        let [a, b, c] = [a, b, c].map(|vertex| vertex - ray.start.as_dvec3());
        let (ahead, facing) = (normal.dot(a), normal.dot(ray.direction.as_dvec3()));
        let slack = normal.abs().dot(ray.slack.as_dvec3());
        let is_met = if facing > 0.0 {
            // Leaving through the back.
            ahead > slack
        } else {
            // Entering through the front: but what a ray along a curved surface entered farther back it may have left.
            facing < 0.0 && ahead < slack && ahead < -facing * ray.reach
        };
        if !is_met {
            return None;
        }
        // The plane of a triangle seen edge-on may be crossed elsewhere, but no farther away than its vertices.
        let along = ray.axes[2];
        let depths = DVec3::new(a[along], b[along], c[along]) / f64::from(ray.direction[along]);
        let distance = (ahead / facing).clamp(depths.min_element(), depths.max_element());
        Some((distance, normal))
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use rand::{RngExt, SeedableRng};
    use rand_pcg::Pcg64Mcg;

    fn random_point(rng: &mut Pcg64Mcg) -> Vec3A {
        Vec3A::from_array(std::array::from_fn(|_| rng.random_range(-1.0_f32..1.0)))
    }

    #[test]
    fn a_crossing_lies_on_the_ray_and_on_the_triangle() {
        let mut rng = Pcg64Mcg::seed_from_u64(1);
        let mut hits = 0;
        for _ in 0..20_000 {
            let vertices = [(); 3].map(|()| random_point(&mut rng));
            let (origin, direction) = (3.0 * random_point(&mut rng), random_point(&mut rng).normalize());
            let Some(crossing) = Triangle::new(vertices).crossing(&ShearedRay::new(origin, direction)) else {
                continue;
            };
            let normal = (vertices[1] - vertices[0]).cross(vertices[2] - vertices[0]).normalize();
            if normal.dot(direction).abs() < 1e-2 {
                continue;
            }
            hits += 1;
            let b = crossing.barycentrics;
            let [v0, v1, v2] = vertices.map(|vertex| vertex.as_dvec3());
            let on_triangle = b.x * v0 + b.y * v1 + b.z * v2;
            let on_ray = origin.as_dvec3() + crossing.distance * direction.as_dvec3();
            assert!(on_ray.distance(on_triangle) < 1e-6);
            assert!(b.min_element() >= 0.0 && (b.element_sum() - 1.0).abs() < 1e-12);
        }
        assert!(hits > 100);
    }

    #[test]
    fn a_ray_with_slack_meets_only_the_face_that_it_starts_on() {
        let up = Triangle::new([Vec3A::ZERO, Vec3A::Z * 4.0, Vec3A::X * 4.0]);
        let mut rng = Pcg64Mcg::seed_from_u64(2);
        for _ in 0..1000 {
            let direction = random_point(&mut rng).normalize();
            let slack = Slack { along: Vec3A::splat(1e-3), normal: Vec3A::X };
            let ray = ShearedRay::new(Vec3A::new(1.0, 0.0, 1.0), direction).with_slack(slack);
            assert_eq!(up.distance(&ray).is_finite(), direction.y < 0.0, "{direction}");
        }
    }

    #[test]
    fn what_lies_behind_or_has_no_area_is_missed() {
        let triangle = Triangle::new([Vec3A::X, Vec3A::Y, Vec3A::NEG_ONE.with_z(0.0)]);
        let ray = |z: f32, d: f32| ShearedRay::new(Vec3A::new(0.0, 0.0, z), Vec3A::new(0.0, 0.0, d));
        assert_eq!(triangle.distance(&ray(-2.0, 1.0)), 2.0);
        assert_eq!(triangle.distance(&ray(2.0, -1.0)), 2.0);
        assert_eq!(triangle.distance(&ray(2.0, 1.0)), f32::INFINITY);
        let sliver = Triangle::new([Vec3A::X, Vec3A::NEG_X, Vec3A::ZERO]);
        assert_eq!(sliver.distance(&ray(-2.0, 1.0)), f32::INFINITY);
        let point = Triangle::new([Vec3A::ZERO; 3]);
        assert_eq!(point.distance(&ray(-2.0, 1.0)), f32::INFINITY);
    }
}
