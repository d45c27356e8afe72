//! A watertight test of a ray against a triangle.
//!
//! The method is that of \[Woop2013\]: space is sheared so that the ray becomes the third axis, and the signs of three
//! edge functions of the sheared vertices decide. A sheared vertex depends on the vertex and the ray alone, rounding is
//! monotone, and an edge function of zero counts as inside for both neighbours, so no ray slips between two triangles that
//! share an edge or a vertex.
//!
//! Laid out by axis instead of by vertex, the three vertices are sheared at once in one vector register.

use glam::{Vec3, Vec3A, Vec3Swizzles};

/// The three vertices of a triangle by axis: `rows[axis] = (v0[axis], v1[axis], v2[axis])`.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Triangle {
    rows: [Vec3A; 3],
}

/// A ray, ready for tests against many triangles.
#[derive(Debug, Clone, Copy)]
pub(crate) struct ShearedRay {
    axes: [usize; 3],
    origin: [f32; 3],
    shear: [f32; 3],
    /// How far behind its origin the ray still meets triangles that face it, and how far ahead it doesn't yet meet
    /// those that face away.
    slack: f32,
}

/// Where a ray meets a triangle.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Crossing {
    /// Distance in lengths of the ray's direction, positive.
    pub(crate) distance: f32,
    /// Weights of the three vertices, not negative, of sum 1.
    pub(crate) barycentrics: Vec3,
}

impl ShearedRay {
    /// A ray from `origin` along `direction`, which is neither zero nor infinite.
    #[inline(always)]
    pub(crate) fn new(origin: Vec3A, direction: Vec3A) -> Self {
        let size = direction.abs();
        let (axes, origin, direction) = if size.x > size.y.max(size.z) {
            ([1, 2, 0], origin.yzx(), direction.yzx())
        } else if size.y > size.z {
            ([2, 0, 1], origin.zxy(), direction.zxy())
        } else {
            ([0, 1, 2], origin, direction)
        };
        let inverse = 1.0 / direction.z;
        Self {
            axes,
            origin: origin.to_array(),
            shear: [direction.x * inverse, direction.y * inverse, inverse],
            slack: 0.0,
        }
    }

    /// The same ray, started anywhere within `slack` of a triangle: it meets those that face it up to that far behind its
    /// origin, and doesn't meet those that face away until that far ahead.
    ///
    /// A receiver at the foot of a wall lies in the plane of the ground: rays that start there and go down cross the
    /// ground at distance 0 and must not escape below, while those that go up must not be blocked by it.
    #[inline(always)]
    pub(crate) fn with_slack(self, slack: f32) -> Self {
        Self { slack, ..self }
    }
}

impl Triangle {
    /// The triangle of three vertices.
    pub(crate) fn new(vertices: [Vec3A; 3]) -> Self {
        let [a, b, c] = vertices;
        Self { rows: std::array::from_fn(|axis| Vec3A::new(a[axis], b[axis], c[axis])) }
    }

    /// Edge functions and sheared depths, if the line of the ray passes through the triangle.
    #[inline(always)]
    fn edges_and_depths(&self, ray: &ShearedRay) -> Option<(Vec3A, Vec3A)> {
        let [kx, ky, kz] = ray.axes;
        let z = self.rows[kz] - Vec3A::splat(ray.origin[2]);
        let x = (self.rows[kx] - Vec3A::splat(ray.origin[0])) - ray.shear[0] * z;
        let y = (self.rows[ky] - Vec3A::splat(ray.origin[1])) - ray.shear[1] * z;
        // No fused multiply-add here: rounding both products alike makes the function of an edge exactly the negative
        // of its neighbour's.
        let edges = x.zxy() * y.yzx() - y.zxy() * x.yzx();
        let (negative, positive) = (edges.cmplt(Vec3A::ZERO).bitmask(), edges.cmpgt(Vec3A::ZERO).bitmask());
        (negative == 0 || positive == 0).then_some((edges, z))
    }

    /// The distance at which the ray crosses the triangle, in lengths of its direction; infinite if it doesn't. Positive,
    /// but for the ray's slack.
    #[inline(always)]
    pub(crate) fn distance(&self, ray: &ShearedRay) -> f32 {
        let Some((edges, depths)) = self.edges_and_depths(ray) else { return f32::INFINITY };
        let determinant = edges.element_sum();
        let distance = edges.dot(depths) * ray.shear[2] / determinant;
        // The axes were permuted cyclically, so that the determinant's sign tells the faces apart.
        let nearest = if determinant * ray.shear[2] > 0.0 { -ray.slack } else { ray.slack };
        // A determinant of 0 gives NaN or an infinity, which this comparison refuses too.
        if distance > nearest && distance.is_finite() { distance } else { f32::INFINITY }
    }

    /// The crossing with its barycentric coordinates.
    pub(crate) fn crossing(&self, ray: &ShearedRay) -> Option<Crossing> {
        let (edges, _) = self.edges_and_depths(ray)?;
        let distance = self.distance(ray);
        let barycentrics = Vec3::from(edges / edges.element_sum());
        (distance.is_finite() && barycentrics.is_finite()).then_some(Crossing { distance, barycentrics })
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
            let on_triangle = b.x * vertices[0] + b.y * vertices[1] + b.z * vertices[2];
            assert!((origin + crossing.distance * direction).distance(on_triangle) < 1e-4);
            assert!(b.min_element() >= 0.0 && (b.element_sum() - 1.0).abs() < 1e-5);
        }
        assert!(hits > 100);
    }

    #[test]
    fn a_ray_with_slack_meets_only_the_face_that_it_starts_on() {
        let up = Triangle::new([Vec3A::ZERO, Vec3A::Z * 4.0, Vec3A::X * 4.0]);
        let mut rng = Pcg64Mcg::seed_from_u64(2);
        for _ in 0..1000 {
            let direction = random_point(&mut rng).normalize();
            let ray = ShearedRay::new(Vec3A::new(1.0, 0.0, 1.0), direction).with_slack(1e-3);
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
