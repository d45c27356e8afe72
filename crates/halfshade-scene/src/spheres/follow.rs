//! Spheres that follow a deforming mesh.
//!
//! Every sphere is bound to the part of the surface that it holds at rest: triangles, cut until each piece lies within
//! one sphere. When the surface deforms,
//! - the sphere moves with the similarity that carries its part there best in the sense of least squares, the rotation of
//!   \[Horn1987\] (an eigenvector of a symmetric 4×4 matrix: always a rotation, also of a flat part);
//! - its radius grows or shrinks, in a set that bounds, with the distance of the part's farthest point, so that it goes on
//!   bounding the surface: a piece moves as its triangle does and stays within the hull of its corners. In a set that was
//!   fitted to shadows, which leaves parts bare, with the root mean square of the distances from the part's middle.
//!
//! A sphere in which no piece lies deepest follows the vertices nearest to its centre, and its radius their scale.
//!
//! At rest the sphere is what it was, to the bit. [Guerrero2007, 4.3.4] leaves deforming objects open.

use super::{Sphere, SphereFit};
use crate::Mesh;
use glam::{DMat3, DQuat, DVec3, Vec3};
use nalgebra::{Matrix4, SymmetricEigen};
use rayon::prelude::*;
use std::collections::HashSet;

/// Most halvings of a triangle; what then still lies in no single sphere goes to the nearest.
const MOST_CUTS: u32 = 12;

/// Edges up to which triangles are cut that no sphere of a set holds that needn't bound, in radii of the nearest.
const COARSE: f64 = 0.5;

/// Vertices that a sphere follows which holds no part of the surface.
const NEAREST: usize = 32;

/// A point of a mesh's surface: weights, of sum 1, of three vertices.
type BarycentricPoint = ([u32; 3], Vec3);

/// Spheres bound to a mesh.
#[derive(Debug, Clone)]
pub struct SphereBinding {
    fit: SphereFit,
    bound: Vec<BoundSphere>,
}

/// A sphere and its part of the surface.
#[derive(Debug, Clone)]
struct BoundSphere {
    sphere: Sphere,
    corners: Vec<BarycentricPoint>,
    /// Mean of the corners at rest, and the largest distance of one that has to be held from the sphere's centre.
    mean: DVec3,
    reach: f64,
}

/// A bound sphere at a moment.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Followed {
    /// The sphere, in the object's space.
    pub sphere: Sphere,
    /// Rotation of its part of the surface since rest.
    pub rotation: DQuat,
}

impl SphereBinding {
    /// Binds `spheres`, which were fitted to `mesh` at rest.
    pub fn new(mesh: &Mesh, spheres: &[Sphere], fit: SphereFit) -> Self {
        let mut corners: Vec<Vec<BarycentricPoint>> = vec![Vec::new(); spheres.len()];
        let mut whole: HashSet<(usize, u32)> = HashSet::new();
        if !spheres.is_empty() {
            for triangle in &mesh.triangles {
                divide(mesh, (spheres, fit), *triangle, [Vec3::X, Vec3::Y, Vec3::Z], 0, &mut |sphere, weights| {
                    // A vertex of many triangles counts once.
                    let vertex = weights.to_array().iter().position(|&weight| weight == 1.0);
                    if vertex.is_none_or(|vertex| whole.insert((sphere, triangle[vertex]))) {
                        corners[sphere].push((*triangle, weights));
                    }
                });
            }
        }
        let bound = (spheres.iter().zip(corners))
            .map(|(&sphere, corners)| {
                let center = sphere.center.as_dvec3();
                let places = |corners: &[BarycentricPoint]| -> Vec<DVec3> {
                    corners.iter().map(|place| point_at(&mesh.positions, place)).collect()
                };
                let reach = places(&corners).iter().map(|place| place.distance(center)).fold(0.0, f64::max);
                let corners = if corners.is_empty() { nearest(mesh, sphere.center) } else { corners };
                let mean = mean(&places(&corners));
                BoundSphere { sphere, corners, mean, reach }
            })
            .collect();
        Self { fit, bound }
    }

    /// The spheres when the mesh's vertices are at `positions` instead of `rest`.
    pub fn follow(&self, rest: &[Vec3], positions: &[Vec3]) -> Vec<Followed> {
        self.bound.par_iter().map(|bound| bound.follow(self.fit, rest, positions)).collect()
    }

    /// Memory that it takes.
    pub fn bytes(&self) -> usize {
        self.bound.iter().map(|bound| size_of_val(bound.corners.as_slice()) + size_of::<BoundSphere>()).sum()
    }
}

impl BoundSphere {
    fn follow(&self, fit: SphereFit, rest: &[Vec3], positions: &[Vec3]) -> Followed {
        let places: Vec<DVec3> = self.corners.iter().map(|place| point_at(positions, place)).collect();
        let unmoved = |corner: &BarycentricPoint| corner.0.iter().all(|&v| rest[v as usize] == positions[v as usize]);
        if self.corners.iter().all(unmoved) {
            return Followed { sphere: self.sphere, rotation: DQuat::IDENTITY };
        }
        let mean = mean(&places);
        // Σ (rest - mean) ⊗ (place - mean).
        let (mut correlation, mut spread, mut spread_now) = (DMat3::ZERO, 0.0, 0.0);
        for (corner, place) in self.corners.iter().zip(&places) {
            let (from, to) = (point_at(rest, corner) - self.mean, *place - mean);
            correlation += DMat3::from_cols(from * to.x, from * to.y, from * to.z);
            spread += from.length_squared();
            spread_now += to.length_squared();
        }
        let rotation = best_rotation(&correlation);
        let turned = DMat3::from_quat(rotation);
        // Trace of rotation · correlation: the part of the motion that is a scale.
        let along = (0..3).map(|row| turned.row(row).dot(correlation.col(row))).sum::<f64>();
        let scale = if spread > 0.0 { (along / spread).max(0.0) } else { 1.0 };
        let center = mean + scale * (turned * (self.sphere.center.as_dvec3() - self.mean));
        // From the rounded centre, so that what is returned bounds.
        let center = center.as_vec3();
        let reach = places.iter().map(|place| place.distance(center.as_dvec3())).fold(0.0, f64::max);
        let growth = match fit {
            SphereFit::Bounding if self.reach > 0.0 => reach / self.reach,
            SphereFit::Shadow if spread > 0.0 => (spread_now / spread).sqrt(),
            _ => scale,
        };
        let radius = (f64::from(self.sphere.radius) * growth) as f32;
        Followed { sphere: Sphere { center, radius: radius.max(f32::MIN_POSITIVE) }, rotation }
    }
}

fn point_at(positions: &[Vec3], (vertices, weights): &BarycentricPoint) -> DVec3 {
    let [a, b, c] = vertices.map(|vertex| positions[vertex as usize].as_dvec3());
    f64::from(weights.x) * a + f64::from(weights.y) * b + f64::from(weights.z) * c
}

fn mean(points: &[DVec3]) -> DVec3 {
    points.iter().sum::<DVec3>() / points.len().max(1) as f64
}

/// The vertices nearest to a point.
fn nearest(mesh: &Mesh, point: Vec3) -> Vec<BarycentricPoint> {
    let mut vertices: Vec<u32> = (0..mesh.positions.len() as u32).collect();
    let distance = |&vertex: &u32| mesh.positions[vertex as usize].distance_squared(point);
    vertices.sort_by(|a, b| distance(a).total_cmp(&distance(b)));
    vertices.truncate(NEAREST);
    vertices.into_iter().map(|vertex| ([vertex; 3], Vec3::X)).collect()
}

/// Gives the corners of every piece of a triangle to the sphere that holds it.
fn divide(
    mesh: &Mesh,
    (spheres, fit): (&[Sphere], SphereFit),
    triangle: [u32; 3],
    corners: [Vec3; 3],
    cuts: u32,
    give: &mut impl FnMut(usize, Vec3),
) {
    let places = corners.map(|weights| point_at(&mesh.positions, &(triangle, weights)));
    // By the farthest corner in units of the radius: the sphere that the piece lies deepest in.
    let depth = |sphere: &Sphere| {
        let farthest = places.iter().map(|place| place.distance(sphere.center.as_dvec3())).fold(0.0, f64::max);
        farthest / f64::from(sphere.radius)
    };
    let depths: Vec<f64> = spheres.iter().map(depth).collect();
    let Some(deepest) = (0..depths.len()).min_by(|&a, &b| depths[a].total_cmp(&depths[b])) else { return };
    let length = |edge: usize| places[edge].distance_squared(places[(edge + 1) % 3]);
    let longest = (0..3).max_by(|&a, &b| length(a).total_cmp(&length(b))).unwrap_or(0);
    let small = COARSE * f64::from(spheres[deepest].radius);
    let is_small = fit == SphereFit::Shadow && length(longest) <= small * small;
    if depths[deepest] <= 1.0 || is_small || cuts == MOST_CUTS {
        corners.into_iter().for_each(|corner| give(deepest, corner));
        return;
    }
    let [a, b, c] = [0, 1, 2].map(|k| corners[(longest + k) % 3]);
    let middle = 0.5 * (a + b);
    divide(mesh, (spheres, fit), triangle, [a, middle, c], cuts + 1, give);
    divide(mesh, (spheres, fit), triangle, [middle, b, c], cuts + 1, give);
}

/// The rotation R that makes `Σ (R from)·to` largest, given `Σ from ⊗ to` \[Horn1987\].
fn best_rotation(correlation: &DMat3) -> DQuat {
    let s = |row: usize, column: usize| correlation.col(column)[row];
    let (xx, yy, zz) = (s(0, 0), s(1, 1), s(2, 2));
    let (wx, wy, wz) = (s(1, 2) - s(2, 1), s(2, 0) - s(0, 2), s(0, 1) - s(1, 0));
    let (xy, xz, yz) = (s(0, 1) + s(1, 0), s(0, 2) + s(2, 0), s(1, 2) + s(2, 1));
    #[rustfmt::skip]
    let matrix = Matrix4::new(
        xx + yy + zz, wx,           wy,           wz,
        wx,           xx - yy - zz, xy,           xz,
        wy,           xy,           yy - xx - zz, yz,
        wz,           xz,           yz,           zz - xx - yy,
    );
    let Some(eigen) = SymmetricEigen::try_new(matrix, 1e-14, 1000) else { return DQuat::IDENTITY };
    let vector = eigen.eigenvectors.column(eigen.eigenvalues.imax());
    let rotation = DQuat::from_xyzw(vector[1], vector[2], vector[3], vector[0]);
    if rotation.is_finite() && rotation.length_squared() > 0.0 { rotation.normalize() } else { DQuat::IDENTITY }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::{Pose, builtin::shapes};
    use glam::Quat;

    /// A torus in eight spheres.
    fn ring() -> (Mesh, Vec<Sphere>) {
        let mesh = shapes::torus(0.8, 0.25, 48, 24);
        let spheres = (0..8)
            .map(|i| {
                let (sin, cos) = (std::f32::consts::TAU * i as f32 / 8.0).sin_cos();
                Sphere { center: 0.8 * Vec3::new(cos, 0.0, sin), radius: 0.46 }
            })
            .collect();
        (mesh, spheres)
    }

    #[test]
    fn a_similarity_carries_spheres_along_exactly() {
        let (mesh, spheres) = ring();
        let binding = SphereBinding::new(&mesh, &spheres, SphereFit::Bounding);
        let pose = Pose {
            scale: 1.7,
            rotation: Quat::from_axis_angle(Vec3::new(1.0, 2.0, -0.5).normalize(), 2.2),
            translation: Vec3::new(0.3, -4.0, 1.0),
        };
        let moved: Vec<Vec3> = mesh.positions.iter().map(|&p| pose.transform_point(p)).collect();
        for (followed, sphere) in binding.follow(&mesh.positions, &moved).iter().zip(&spheres) {
            assert!(followed.sphere.center.distance(pose.transform_point(sphere.center)) < 1e-5);
            assert!((followed.sphere.radius - 1.7 * sphere.radius).abs() < 1e-5);
            assert!(followed.rotation.as_quat().angle_between(pose.rotation) < 1e-3);
        }
        for (followed, sphere) in binding.follow(&mesh.positions, &mesh.positions).iter().zip(&spheres) {
            assert_eq!((followed.sphere, followed.rotation), (*sphere, DQuat::IDENTITY));
        }
        assert!(binding.bytes() > 0);
    }

    #[test]
    fn a_bent_and_twisted_surface_stays_bounded_to_the_last_point() {
        let (mesh, spheres) = ring();
        let binding = SphereBinding::new(&mesh, &spheres, SphereFit::Bounding);
        let moved: Vec<Vec3> = (mesh.positions.iter())
            .map(|p| Quat::from_rotation_x(0.9 * p.x) * (*p * Vec3::new(1.3, 1.0, 0.8)) + 0.3 * p.z * Vec3::Y)
            .collect();
        let followed = binding.follow(&mesh.positions, &moved);
        for triangle in &mesh.triangles {
            for (u, v) in [(1, 1), (10, 0), (0, 10), (0, 0), (3, 5), (5, 5), (7, 1)] {
                let weights = Vec3::new(0.1 * u as f32, 0.1 * v as f32, 1.0 - 0.1 * (u + v) as f32);
                let point = point_at(&moved, &(*triangle, weights));
                let outside = |s: &Followed| point.distance(s.sphere.center.as_dvec3()) - f64::from(s.sphere.radius);
                let nearest = followed.iter().map(outside).fold(f64::INFINITY, f64::min);
                assert!(nearest < 1e-6, "{nearest}");
            }
        }
        // And not by growing without need: the twist stretches by 1.5 at most.
        assert!(followed.iter().zip(&spheres).all(|(f, s)| f.sphere.radius < 1.8 * s.radius));
    }

    /// Spheres that leave most of the surface bare go with it, and grow as it is stretched in the mean.
    #[test]
    fn spheres_that_do_not_bound_follow_too() {
        let (mesh, mut spheres) = ring();
        spheres.iter_mut().for_each(|sphere| sphere.radius = 0.2);
        let binding = SphereBinding::new(&mesh, &spheres, SphereFit::Shadow);
        // One sphere per piece suffices: nothing is cut down to the borders of spheres.
        assert!(binding.bytes() < 400_000, "{}", binding.bytes());
        let bend = |p: Vec3| Quat::from_rotation_x(0.3 * p.x) * (1.4 * p) + Vec3::Y;
        let moved: Vec<Vec3> = mesh.positions.iter().map(|&p| bend(p)).collect();
        for (followed, sphere) in binding.follow(&mesh.positions, &moved).iter().zip(&spheres) {
            assert!(followed.sphere.center.distance(bend(sphere.center)) < 0.05, "{followed:?}");
            assert!((followed.sphere.radius / (1.4 * sphere.radius) - 1.0).abs() < 0.03, "{followed:?}");
        }
        for (followed, sphere) in binding.follow(&mesh.positions, &mesh.positions).iter().zip(&spheres) {
            assert_eq!(followed.sphere, *sphere);
        }
    }

    #[test]
    fn one_triangle_one_point_and_nothing() {
        let flat = Mesh {
            positions: vec![Vec3::ZERO, Vec3::X, Vec3::Z],
            normals: vec![Vec3::Y; 3],
            triangles: vec![[0, 1, 2]],
            ..Mesh::default()
        };
        let spheres =
            [Sphere { center: Vec3::new(0.4, 0.0, 0.4), radius: 0.8 }, Sphere { center: Vec3::Y, radius: 0.1 }];
        let binding = SphereBinding::new(&flat, &spheres, SphereFit::Bounding);
        // The second holds nothing: it goes where its neighbours go.
        let aside = [Vec3::ZERO, Vec3::X, Vec3::Z].map(|place| 2.0 * place + Vec3::X);
        let followed = binding.follow(&flat.positions, &aside)[1].sphere;
        assert!(followed.center.distance(Vec3::new(1.0, 2.0, 0.0)) < 1e-5 && (followed.radius - 0.2).abs() < 1e-5);
        let collapsed = binding.follow(&flat.positions, &[Vec3::ONE; 3]);
        assert!(
            collapsed.iter().all(|f| f.sphere.center.is_finite() && f.sphere.radius > 0.0 && f.rotation.is_finite())
        );
        assert!(
            SphereBinding::new(&flat, &[], SphereFit::Bounding).follow(&flat.positions, &flat.positions).is_empty()
        );
        let none = SphereBinding::new(&Mesh::default(), &spheres, SphereFit::Bounding).follow(&[], &[]);
        assert_eq!(none[0].sphere, spheres[0]);
    }
}
