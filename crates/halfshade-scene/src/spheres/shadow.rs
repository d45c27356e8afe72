//! How much a sphere set's shadow differs from its mesh's: the geometry's share of a shadow's error, nothing else.

use super::Sphere;
use crate::Mesh;
use glam::{DVec2, DVec3};
use rayon::prelude::*;

/// Receivers along each side of the ground.
const SIDE: usize = 64;
/// The ground's side as a multiple of the mesh's largest extent across it.
const SPAN: f64 = 2.5;

/// Root mean square, over 64² receivers on a ground plane that the mesh stands on, of the difference between the
/// fractions of a constant sky's irradiance that the mesh and the spheres let through.
///
/// The ground is horizontal (+Y up) at the mesh's lowest point, 2.5 times as wide as the mesh's larger horizontal extent.
/// Since the unshadowed fraction is 1, this is also the RMSE relative to the unshadowed mean. Both shadows are cast along
/// the same `direction_count` directions, distributed by the cosine: parallel projection of every triangle, and the
/// distance of every sphere's centre from the ray. With 256 directions the result is good to about 2 %. A receiver
/// inside a sphere is in its shadow.
pub fn ground_shadow_error(mesh: &Mesh, spheres: &[Sphere], direction_count: usize) -> f64 {
    let points: Vec<DVec3> = mesh.positions.iter().map(|p| p.as_dvec3()).collect();
    let used: Vec<[DVec3; 3]> = mesh
        .triangles
        .iter()
        .filter_map(|t| Some([*points.get(t[0] as usize)?, *points.get(t[1] as usize)?, *points.get(t[2] as usize)?]))
        .collect();
    let Some(min) = used.iter().flatten().copied().reduce(DVec3::min) else { return 0.0 };
    let max = used.iter().flatten().copied().fold(min, DVec3::max);
    let center = DVec3::new(0.5 * (min.x + max.x), min.y, 0.5 * (min.z + max.z));
    let side = SPAN * (max.x - min.x).max(max.z - min.z).max(1e-3 * (max - min).max_element());
    let cell = side / SIDE as f64;
    // To the ground's own frame: receiver (i, j) stands at (i, j).
    let to_cells = |p: DVec2| (p - DVec2::new(center.x, center.z) + 0.5 * side) / cell - 0.5;
    let counts: Vec<(u32, u32)> = (0..direction_count)
        .into_par_iter()
        .map(|k| {
            let direction = cosine_direction(k, direction_count);
            let slope = DVec2::new(direction.x, direction.z) / direction.y;
            let mut of_mesh = vec![false; SIDE * SIDE];
            for triangle in &used {
                let shadow = triangle.map(|p| to_cells(DVec2::new(p.x, p.z) - (p.y - min.y) * slope));
                fill(&shadow, &mut of_mesh);
            }
            let mut of_spheres = vec![false; SIDE * SIDE];
            for sphere in spheres {
                fill_sphere(sphere, direction, &mut of_spheres, |i, j| {
                    let p = (DVec2::new(i as f64, j as f64) + 0.5) * cell - 0.5 * side;
                    DVec3::new(center.x + p.x, min.y, center.z + p.y)
                });
            }
            [of_mesh, of_spheres]
        })
        .fold(
            || vec![(0u32, 0u32); SIDE * SIDE],
            |mut sums, [of_mesh, of_spheres]| {
                for (sum, (m, s)) in sums.iter_mut().zip(of_mesh.iter().zip(&of_spheres)) {
                    *sum = (sum.0 + u32::from(*m), sum.1 + u32::from(*s));
                }
                sums
            },
        )
        // Integer sums: the same on one thread or many.
        .reduce(|| vec![(0, 0); SIDE * SIDE], |a, b| a.iter().zip(&b).map(|(x, y)| (x.0 + y.0, x.1 + y.1)).collect());
    let squares: f64 = counts.iter().map(|(m, s)| (f64::from(*m) - f64::from(*s)).powi(2)).sum();
    (squares / (SIDE * SIDE) as f64).sqrt() / direction_count.max(1) as f64
}

/// Direction `k` of `count` in the upper hemisphere (+Y), density cos / π: a Fibonacci lattice on the disc.
fn cosine_direction(k: usize, count: usize) -> DVec3 {
    let squared = (k as f64 + 0.5) / count as f64;
    let (sin, cos) = (k as f64 * std::f64::consts::PI * (3.0 - 5f64.sqrt())).sin_cos();
    DVec3::new(squared.sqrt() * cos, (1.0 - squared).sqrt(), squared.sqrt() * sin)
}

/// Marks the receivers in a triangle.
fn fill(triangle: &[DVec2; 3], marks: &mut [bool]) {
    let [a, b, c] = *triangle;
    let low = a.min(b).min(c).max(DVec2::ZERO).ceil();
    let high = a.max(b).max(c).min(DVec2::splat(SIDE as f64 - 1.0));
    let (mut j, winding) = (low.y, (b - a).perp_dot(c - a).signum());
    while j <= high.y {
        let mut i = low.x;
        while i <= high.x {
            let p = DVec2::new(i, j);
            let sides = [(a, b), (b, c), (c, a)].map(|(from, to)| winding * (to - from).perp_dot(p - from));
            marks[j as usize * SIDE + i as usize] |= sides.iter().all(|side| *side >= 0.0);
            i += 1.0;
        }
        j += 1.0;
    }
}

/// Marks the receivers from which the sphere blocks the direction.
fn fill_sphere(sphere: &Sphere, direction: DVec3, marks: &mut [bool], receiver: impl Fn(usize, usize) -> DVec3) {
    let (center, squared) = (sphere.center.as_dvec3(), f64::from(sphere.radius).powi(2));
    for j in 0..SIDE {
        for i in 0..SIDE {
            let offset = center - receiver(i, j);
            let along = offset.dot(direction);
            let beside = offset.length_squared() - along * along;
            let contains = offset.length_squared() <= squared;
            marks[j * SIDE + i] |= contains || (along > 0.0 && beside <= squared);
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use glam::Vec3;

    /// A sphere's mesh against the sphere: nothing but facets. Against nothing: the closed form sin²θ cos γ itself.
    #[test]
    fn one_sphere_in_closed_form() {
        let mesh = crate::builtin::shapes::sphere(24);
        let unit = Sphere { center: Vec3::ZERO, radius: 1.0 };
        assert!(ground_shadow_error(&mesh, &[unit], 256) < 6e-3);
        let mut squares = 0.0;
        for k in 0..SIDE * SIDE {
            let [x, z] = [k % SIDE, k / SIDE].map(|i| 5.0 * ((i as f64 + 0.5) / SIDE as f64 - 0.5));
            let squared = x * x + z * z + 1.0;
            squares += (1.0 / squared / squared.sqrt()).powi(2);
        }
        let expected = (squares / (SIDE * SIDE) as f64).sqrt();
        let found = ground_shadow_error(&mesh, &[], 256);
        assert!((found / expected - 1.0).abs() < 0.02, "{found} {expected}");
    }
}
