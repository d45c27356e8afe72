//! Light that a sphere set hides against that which its mesh hides, ray by ray. Shares nothing with the fit but the rays' own crate and
//! the rule by which a receiver on the surface sees spheres that it lies in.

use glam::{DMat3, DVec3, Vec3};
use halfshade_rays::{MeshRays, Ray};
use halfshade_scene::{
    Mesh, Sphere,
    spheres::{AdjustRule, AdjustedSphere, adjust},
};
use rayon::prelude::*;
use std::f64::consts::TAU;

/// Receivers along each side of the ground.
const GRID: usize = 40;
/// Side of the ground, in larger horizontal extents of the mesh.
const SIDE: f64 = 2.5;
/// Distance of the lower ground below the mesh, likewise.
const BELOW: f64 = 0.1;
/// Vertices that are asked for their own light, about.
const VERTICES: usize = 1_500;
/// Directions to the discs of light, which are 30 degrees wide.
const DISCS: [DVec3; 3] = [DVec3::Y, DVec3::new(1.0, 1.0, 0.0), DVec3::new(-0.6, 1.0, 0.9)];

/// Root mean squares of errors, as fractions of the light without shadows.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct SphereErrors {
    /// Constant light on a ground a tenth of the mesh's extent below it.
    pub(crate) sky: f64,
    /// Light of a disc on that ground, over all discs.
    pub(crate) disc: f64,
    /// Constant light on a ground that the mesh stands on.
    pub(crate) touching: f64,
    /// Constant light on the mesh's own vertices.
    pub(crate) own: f64,
}

/// The errors of spheres in place of a mesh, which has normals, by so many rays for the sky and for each disc. Noise of 512 rays
/// adds about .003, in squares, to an error under the sky.
pub(crate) fn sphere_errors(mesh: &Mesh, spheres: &[Sphere], rays: usize) -> SphereErrors {
    let test = Test { rays: MeshRays::new(&mesh.positions, &mesh.triangles), spheres };
    let sky = disc(DVec3::Y, 1.0, rays);
    let discs = DISCS.map(|axis| disc(axis.normalize(), 15f64.to_radians().sin(), rays));
    let lower = ground(mesh, BELOW);
    let squares = discs.iter().map(|disc| test.on_ground(&lower, disc).powi(2));
    SphereErrors {
        sky: test.on_ground(&lower, &sky),
        disc: (squares.sum::<f64>() / DISCS.len() as f64).sqrt(),
        touching: test.on_ground(&ground(mesh, 0.0), &sky),
        own: test.on_surface(mesh, &sky),
    }
}

/// Directions to a disc about `axis` whose angular radius has this sine, each for the same part of its light on a plane across
/// the axis.
fn disc(axis: DVec3, sine: f64, rays: usize) -> Vec<DVec3> {
    let (right, up) = axis.any_orthonormal_pair();
    let direction = |k: usize| {
        let across = sine * ((k as f64 + 0.5) / rays as f64).sqrt();
        let (sin, cos) = (TAU * 0.754_877_666_246_692_7 * k as f64).sin_cos();
        (across * (cos * right + sin * up) + (1.0 - across * across).sqrt() * axis).normalize()
    };
    (0..rays).map(direction).collect()
}

/// Points of a square below the mesh.
fn ground(mesh: &Mesh, below: f64) -> Vec<DVec3> {
    let (min, max) = mesh.bounds().unwrap();
    let (min, max) = (min.as_dvec3(), max.as_dvec3());
    let extent = (max.x - min.x).max(max.z - min.z);
    let along = |n: usize| SIDE * extent * ((n as f64 + 0.5) / GRID as f64 - 0.5);
    let middle = 0.5 * (min + max);
    let point = |i: usize| DVec3::new(middle.x + along(i % GRID), min.y - below * extent, middle.z + along(i / GRID));
    (0..GRID * GRID).map(point).collect()
}

struct Test<'a> {
    rays: MeshRays,
    spheres: &'a [Sphere],
}

impl Test<'_> {
    /// Who is inside a sphere sees nothing.
    fn on_ground(&self, points: &[DVec3], light: &[DVec3]) -> f64 {
        rms(points.par_iter().map(|&point| {
            let offset = |sphere: &Sphere| (sphere.center.as_dvec3() - point, f64::from(sphere.radius));
            let spheres: Vec<(DVec3, f64)> = self.spheres.iter().map(offset).collect();
            difference(light, |ray| self.rays.any(&Ray::new(point, ray), |_| true), &spheres)
        }))
    }

    fn on_surface(&self, mesh: &Mesh, sky: &[DVec3]) -> f64 {
        let step = (mesh.positions.len() / VERTICES).max(1);
        let vertices: Vec<(Vec3, Vec3)> =
            mesh.positions.iter().zip(&mesh.normals).step_by(step).map(|(&p, &n)| (p, n)).collect();
        let lift = 1e-5 * self.rays.half_extent();
        rms(vertices.par_iter().map(|(position, normal)| {
            let (position, normal) = (position.as_dvec3(), normal.as_dvec3().normalize());
            let (right, up) = normal.any_orthonormal_pair();
            let turned: Vec<DVec3> = sky.iter().map(|ray| DMat3::from_cols(right, normal, up) * *ray).collect();
            let adjusted = |sphere: &Sphere| {
                let offset = sphere.center.as_dvec3() - position;
                adjust(AdjustRule::Continuous, offset, f64::from(sphere.radius), normal)
            };
            let spheres: Vec<(DVec3, f64)> = self
                .spheres
                .iter()
                .filter_map(adjusted)
                .map(|AdjustedSphere { offset, radius }| (offset, radius))
                .collect();
            let origin = position + lift * normal;
            difference(&turned, |ray| self.rays.any(&Ray::new(origin, ray), |_| true), &spheres)
        }))
    }
}

/// Part of the rays that the spheres hide less that which the mesh hides.
fn difference(rays: &[DVec3], mesh_hides: impl Fn(DVec3) -> bool, spheres: &[(DVec3, f64)]) -> f64 {
    let sphere_hides = |ray: DVec3| {
        spheres.iter().any(|(offset, radius)| {
            let (along, outside) = (offset.dot(ray), offset.length_squared() - radius * radius);
            outside < 0.0 || (along > 0.0 && along * along > outside)
        })
    };
    let sum: i32 = rays.iter().map(|&ray| i32::from(sphere_hides(ray)) - i32::from(mesh_hides(ray))).sum();
    f64::from(sum) / rays.len() as f64
}

fn rms(errors: impl IndexedParallelIterator<Item = f64>) -> f64 {
    let errors: Vec<f64> = errors.collect();
    (errors.iter().map(|e| e * e).sum::<f64>() / errors.len() as f64).sqrt()
}
