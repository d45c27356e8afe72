//! An object occlusion field: shells of sample points, thinned out and stored in few bits.

use super::{
    adaptive::{AbsoluteMean, thinned},
    occlusion::Directions,
};
use crate::triangle_rays::TriangleRays;
use glam::{DVec3, Vec3};
use halfshade_scene::{Mesh, Progress, clusters::bounding_sphere};
use rayon::prelude::*;
use serde::{Deserialize, Serialize};
use std::f32::consts::{PI, TAU};
use wide::f32x8;

/// Distance between shells, and the radius of the first, in radii of the object's bounding sphere [Tamura2006, 6].
const SPACING: f32 = 0.2;

/// How coefficients are stored.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Storage {
    /// As a number of steps above the shell's smallest value, coefficient by coefficient.
    U8,
    F16,
    F32,
}

/// Vectors on a grid over longitude and latitude, row by row from the +Y pole.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub(super) struct Grid {
    /// A power of two.
    pub(super) resolution: usize,
    pub(super) count: usize,
    pub(super) values: Vec<f32>,
}

/// What one object hides, around it.
#[derive(Debug)]
pub(super) struct Field {
    /// Of the shells, in the object's space.
    pub(super) center: Vec3,
    /// Distance between shells.
    pub(super) spacing: f32,
    /// Coefficients per sample in memory: whole vector registers.
    stride: usize,
    /// What is visible from the centre.
    core: Vec<f32>,
    shells: Vec<Shell>,
}

/// One shell.
#[derive(Debug)]
struct Shell {
    resolution: usize,
    values: Values,
    /// Per coefficient the smallest value and the step; 0 and 1 unless in 8 bits.
    least: Vec<f32>,
    step: Vec<f32>,
}

#[derive(Debug)]
enum Values {
    U8(Vec<u8>),
    F16(Vec<half::f16>),
    F32(Vec<f32>),
}

/// Most coefficients of a sample: 8 bands.
pub(super) const MOST: usize = 64;

/// A field as it is projected: every shell at the full resolution, in full precision.
#[derive(Debug, Clone, Serialize, Deserialize)]
pub(super) struct Projected {
    center: Vec3,
    radius: f32,
    /// What is visible from the centre.
    core: Vec<f32>,
    shells: Vec<Grid>,
}

impl Projected {
    /// Of a mesh; `None` if it has no triangles, or no extent.
    pub(super) fn new(
        mesh: &Mesh,
        rays: &TriangleRays,
        directions: &Directions,
        (shells, resolution): (usize, usize),
        progress: &dyn Progress,
    ) -> Option<Self> {
        let used = mesh.triangles.iter().flatten().map(|&vertex| mesh.positions[vertex as usize].as_dvec3());
        let points: Vec<DVec3> = used.filter(|point| point.is_finite()).collect();
        let (center, radius) = bounding_sphere(&points);
        let (center, radius) = (center.as_vec3(), radius as f32);
        if points.is_empty() || !(radius > 0.0 && radius.is_finite()) {
            progress.advance(shells as u64);
            return None;
        }
        let count = directions.count();
        let shells = (0..shells)
            .into_par_iter()
            .map(|number| {
                let shell_radius = SPACING * radius * (number + 1) as f32;
                let mut grid = Grid { resolution, count, values: Vec::new() };
                let vectors: Vec<Vec<f32>> = (0..resolution * resolution)
                    .into_par_iter()
                    .map(|place| {
                        let [u, v] = grid.place(place);
                        let point = center + shell_radius * direction(u, v);
                        directions.visibility_from(rays, point, center, radius)
                    })
                    .collect();
                grid.values = vectors.concat();
                progress.advance(1);
                grid
            })
            .collect();
        let core = directions.visibility_from(rays, center, center, radius);
        Some(Self { center, radius, core, shells })
    }
}

impl Field {
    /// Thins out every shell to the threshold, if there is one, and stores it.
    pub(super) fn new(projected: &Projected, bands: usize, threshold: Option<f64>, storage: Storage) -> Self {
        let mean = AbsoluteMean::new(bands);
        let shells = (projected.shells.par_iter())
            .map(|grid| match threshold {
                Some(threshold) => Shell::store(&thinned(grid.clone(), threshold, &mean), storage),
                None => Shell::store(grid, storage),
            })
            .collect();
        let stride = (bands * bands).next_multiple_of(8);
        let mut core = projected.core.clone();
        core.resize(stride, 0.0);
        Self { center: projected.center, spacing: SPACING * projected.radius, stride, core, shells }
    }

    /// Memory that it takes.
    pub(super) fn bytes(&self) -> usize {
        self.shells.iter().map(Shell::bytes).sum()
    }

    /// What is visible from a place in shell coordinates: distance from the centre in spacings, longitude and latitude as
    /// shares of the whole. Continuous: between the centre and the first shell as between two shells.
    #[inline]
    pub(super) fn at(&self, distance: f32, u: f32, v: f32, visibility: &mut [f32; MOST]) {
        visibility[..self.stride].fill(0.0);
        let last = self.shells.len() - 1;
        if distance < 1.0 {
            self.shells[0].add(u, v, 1.0, self.stride, visibility);
            for (value, core) in visibility.iter_mut().zip(&self.core) {
                *value = core + distance * (*value - core);
            }
            return;
        }
        let x = (distance - 1.0).clamp(0.0, last as f32);
        let inner = (x as usize).min(last);
        let share = x - inner as f32;
        self.shells[inner].add(u, v, 1.0 - share, self.stride, visibility);
        if share > 0.0 {
            self.shells[inner + 1].add(u, v, share, self.stride, visibility);
        }
        let outermost = (last + 1) as f32;
        if distance > outermost {
            // What is blocked shrinks as the object's solid angle does.
            let left = (outermost / distance).powi(2);
            visibility[..self.stride].iter_mut().for_each(|value| *value *= left);
            visibility[0] += (1.0 - left) * halfshade_sh::kernel::FULL;
        }
    }
}

impl Shell {
    fn store(grid: &Grid, storage: Storage) -> Self {
        let (count, stride) = (grid.count, grid.count.next_multiple_of(8));
        let column = |k: usize| grid.values.iter().skip(k).step_by(count);
        let (mut least, mut step) = (vec![0.0; stride], vec![1.0; stride]);
        if storage == Storage::U8 {
            for k in 0..count {
                let (low, high) = column(k).fold((f32::INFINITY, f32::NEG_INFINITY), |(a, b), &x| (a.min(x), b.max(x)));
                (least[k], step[k]) = (low, (high - low) / 255.0);
            }
        }
        let padded = || {
            grid.values
                .chunks_exact(count)
                .flat_map(|vector| (0..stride).map(|k| (k, vector.get(k).copied().unwrap_or(0.0))))
        };
        let values = match storage {
            Storage::U8 => Values::U8(
                padded()
                    .map(|(k, x)| if step[k] > 0.0 && k < count { ((x - least[k]) / step[k]).round() as u8 } else { 0 })
                    .collect(),
            ),
            Storage::F16 => Values::F16(padded().map(|(_, x)| half::f16::from_f32(x)).collect()),
            Storage::F32 => Values::F32(padded().map(|(_, x)| x).collect()),
        };
        // Past the last coefficient there is nothing.
        step[count..].fill(0.0);
        Self { resolution: grid.resolution, values, least, step }
    }

    fn bytes(&self) -> usize {
        let tables = if matches!(self.values, Values::U8(_)) { 8 * self.least.len() } else { 0 };
        tables
            + match &self.values {
                Values::U8(values) => values.len(),
                Values::F16(values) => 2 * values.len(),
                Values::F32(values) => 4 * values.len(),
            }
    }

    /// Adds `share` of the interpolated vector to `sum`.
    #[inline]
    fn add(&self, u: f32, v: f32, share: f32, stride: usize, sum: &mut [f32; MOST]) {
        let (places, weights) = four_nearest(self.resolution, u, v);
        for first in (0..stride).step_by(8) {
            let mut mixed = f32x8::ZERO;
            for (place, weight) in places.into_iter().zip(weights) {
                let from = place * stride + first;
                let lanes: [f32; 8] = match &self.values {
                    Values::U8(values) => eight(values, from, |x| f32::from(*x)),
                    Values::F16(values) => eight(values, from, |x| x.to_f32()),
                    Values::F32(values) => eight(values, from, |x| *x),
                };
                mixed = f32x8::from(lanes).mul_add(f32x8::splat(weight), mixed);
            }
            let row = |list: &[f32]| f32x8::from(eight(list, first, |x| *x));
            let value = mixed.mul_add(row(&self.step), row(&self.least));
            let added = value.mul_add(f32x8::splat(share), row(&sum[..]));
            sum[first..first + 8].copy_from_slice(added.as_array());
        }
    }
}

#[inline(always)]
fn eight<T>(list: &[T], first: usize, value: impl Fn(&T) -> f32) -> [f32; 8] {
    let list = &list[first..first + 8];
    std::array::from_fn(|k| value(&list[k]))
}

/// The unit direction at a share of the whole in longitude and latitude.
pub(super) fn direction(u: f32, v: f32) -> Vec3 {
    let ((sin, cos), (sin_polar, cos_polar)) = ((TAU * u).sin_cos(), (PI * v).sin_cos());
    Vec3::new(sin_polar * cos, cos_polar, sin_polar * sin)
}

/// The four points of a grid around a place, and their weights, of sum 1: across the seam of longitudes as anywhere, and
/// over a pole to the opposite longitude.
#[inline]
pub(super) fn four_nearest(resolution: usize, u: f32, v: f32) -> ([usize; 4], [f32; 4]) {
    let size = resolution as f32;
    let (x, y) = (u * size - 0.5, v * size - 0.5);
    let (column, row) = (x.floor(), y.floor());
    let (s, t) = (x - column, y - row);
    let (column, row) = (column as i32, row as i32);
    let sides = resolution as i32;
    let at = |column: i32, row: i32| {
        let (column, row) = if row < 0 || row >= sides {
            // One point alone is its own opposite.
            (column + sides / 2, row.clamp(0, sides - 1))
        } else {
            (column, row)
        };
        (row * sides + column.rem_euclid(sides)) as usize
    };
    (
        [at(column, row), at(column + 1, row), at(column, row + 1), at(column + 1, row + 1)],
        [(1.0 - s) * (1.0 - t), s * (1.0 - t), (1.0 - s) * t, s * t],
    )
}

#[cfg(test)]
mod tests {
    use super::super::occlusion;
    use super::*;
    use halfshade_scene::{builtin::shapes, progress::Silent};

    fn baked(mesh: &Mesh, threshold: Option<f64>, storage: Storage) -> Field {
        let directions = Directions::new(4, 32);
        let projected = Projected::new(mesh, &occlusion::rays(mesh), &directions, (12, 16), &Silent).unwrap();
        Field::new(&projected, 4, threshold, storage)
    }

    fn at(field: &Field, point: Vec3) -> [f32; MOST] {
        let offset = point - field.center;
        let distance = offset.length();
        let mut found = [0.0; MOST];
        let (u, v) = (offset.z.atan2(offset.x) / TAU, (offset.y / distance).acos() / PI);
        field.at(distance / field.spacing, u, v, &mut found);
        found
    }

    /// At its sample points a field is what was projected there, to the quantizer's step.
    #[test]
    fn sample_points_keep_their_values() {
        let mesh = shapes::torus(0.7, 0.3, 40, 20);
        let directions = Directions::new(4, 32);
        let rays = occlusion::rays(&mesh);
        for (storage, bound) in [(Storage::F32, 2e-5), (Storage::F16, 4e-3), (Storage::U8, 0.02)] {
            let field = baked(&mesh, None, storage);
            for (shell, column, row) in [(0, 3, 5), (4, 0, 0), (5, 15, 8), (7, 9, 15), (11, 4, 4)] {
                let place = direction((column as f32 + 0.5) / 16.0, (row as f32 + 0.5) / 16.0);
                let point = field.center + field.spacing * (shell + 1) as f32 * place;
                let exact = directions.visibility_from(&rays, point, field.center, 5.0 * field.spacing);
                let found = at(&field, point);
                for (found, exact) in found.iter().zip(&exact) {
                    assert!((found - exact).abs() < bound, "{storage:?} {shell}: {found} {exact}");
                }
            }
        }
    }

    /// Between sample points and shells the field comes near to what would be projected there, the nearer the denser its
    /// points are.
    #[test]
    fn denser_points_converge_to_the_projection() {
        let mesh = shapes::torus(0.7, 0.3, 40, 20);
        let (directions, rays) = (Directions::new(4, 48), occlusion::rays(&mesh));
        let points: Vec<Vec3> = (0..60)
            .map(|i| {
                let direction = direction(0.618_034 * i as f32 % 1.0, (i as f32 + 0.5) / 60.0);
                // On a shell outside: what is between shells isn't asked here.
                [1.2, 1.6, 2.0][i % 3] * direction
            })
            .collect();
        let error = |resolution| {
            let projected = Projected::new(&mesh, &rays, &directions, (10, resolution), &Silent).unwrap();
            let field = Field::new(&projected, 4, None, Storage::F32);
            let squares = points.iter().map(|&point| {
                // In spacings, so that it is exactly a shell's radius.
                let point = field.center + 5.0 * field.spacing * point;
                let exact = directions.visibility_from(&rays, point, field.center, 5.0 * field.spacing);
                at(&field, point).iter().zip(&exact).map(|(found, exact)| f64::from(found - exact).powi(2)).sum::<f64>()
            });
            (squares.sum::<f64>() / points.len() as f64).sqrt()
        };
        let errors = [8, 16, 32].map(error);
        assert!(errors[1] < 0.5 * errors[0] && errors[2] < 0.6 * errors[1] && errors[2] < 0.03, "{errors:?}");
    }

    /// Of a ball all shells are alike in all directions but for the turn of what is seen; within it everything is dark,
    /// and one point tells all.
    #[test]
    fn shells_inside_a_solid_collapse_and_bytes_shrink() {
        let mesh = shapes::sphere(24);
        let fixed = baked(&mesh, None, Storage::U8);
        let adaptive = baked(&mesh, Some(0.02), Storage::U8);
        let resolutions: Vec<usize> = adaptive.shells.iter().map(|shell| shell.resolution).collect();
        assert!(resolutions[..4].iter().all(|&resolution| resolution == 1), "{resolutions:?}");
        assert!(adaptive.bytes() < fixed.bytes() && resolutions[11] <= 16, "{resolutions:?}");
        let all = baked(&mesh, Some(1e9), Storage::F32);
        assert!(all.shells.iter().all(|shell| shell.resolution == 1));
    }

    /// Over seam, poles, shells, past the last one, at the centre: finite, and no step.
    #[test]
    fn continuous_along_every_path() {
        let field = baked(&shapes::torus(0.7, 0.3, 40, 20), Some(0.02), Storage::U8);
        let paths: [fn(f32) -> Vec3; 4] = [
            |t| 1.3 * Vec3::new((TAU * t).cos(), 0.2, (TAU * t).sin()),
            |t| 1.7 * Vec3::new((TAU * t).sin(), (TAU * t).cos(), 0.0),
            |t| (0.05 + 8.0 * t) * Vec3::new(0.6, 0.48, 0.64),
            |t| Vec3::new(1e-3, 2.0 - 4.0 * t, 1e-3),
        ];
        for (number, path) in paths.iter().enumerate() {
            let steps = 4_000;
            let mut before = at(&field, path(0.0));
            for i in 1..=steps {
                let now = at(&field, path(i as f32 / steps as f32));
                let change = (0..16).map(|k| (now[k] - before[k]).abs()).fold(0.0, f32::max);
                assert!(now.iter().all(|x| x.is_finite()) && change < 0.06, "path {number} at {i}: {change}");
                before = now;
            }
        }
        let mut found = [0.0; MOST];
        for (distance, u, v) in [(0.0, 0.0, 0.0), (1e9, 0.5, 1.0), (f32::MAX, -0.5, 0.5), (3.0, 0.5, 0.0)] {
            field.at(distance, u, v, &mut found);
            assert!(found[..16].iter().all(|x| x.is_finite()));
        }
        assert!((found[0] - halfshade_sh::kernel::FULL).abs() < halfshade_sh::kernel::FULL);
    }
}
