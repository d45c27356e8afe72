//! A shell of SH vectors in memory.

use super::projection::ShBasis;
use crate::shadow_field::{
    bake::{basis::Storage, grid::Grid, shell::Shell},
    kernel::reconstruct::{MOST, add_samples},
};

/// One shell.
#[derive(Debug)]
pub(crate) struct ShShell {
    resolution: usize,
    pub(crate) values: Values,
    /// Per coefficient the smallest value and the step [Tamura2006, 5.1]; 0 and 1 unless in 8 bits. As many as a sample has
    /// in memory: whole vector registers.
    pub(crate) least: Vec<f32>,
    pub(crate) step: Vec<f32>,
}

/// Coefficients as they are stored, sample by sample.
#[derive(Debug)]
pub(crate) enum Values {
    U8(Vec<u8>),
    F16(Vec<half::f16>),
    F32(Vec<f32>),
}

impl Shell for ShShell {
    type Basis = ShBasis;
    type Sum = [f32; MOST];

    fn store(_: &ShBasis, grid: &Grid<Vec<f32>>, storage: Storage) -> Self {
        let count = grid.samples.first().map_or(0, Vec::len);
        let stride = count.next_multiple_of(8);
        let column = |k: usize| grid.samples.iter().map(move |vector| vector[k]);
        let (mut least, mut step) = (vec![0.0; stride], vec![1.0; stride]);
        if storage == Storage::U8 {
            for k in 0..count {
                let (low, high) = column(k).fold((f32::INFINITY, f32::NEG_INFINITY), |(a, b), x| (a.min(x), b.max(x)));
                (least[k], step[k]) = (low, (high - low) / 255.0);
            }
        }
        let padded = || {
            let row = |vector: &Vec<f32>| -> Vec<(usize, f32)> {
                (0..stride).map(|k| (k, vector.get(k).copied().unwrap_or(0.0))).collect()
            };
            grid.samples.iter().flat_map(row)
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

    fn resolution(&self) -> usize {
        self.resolution
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

    #[inline(always)]
    fn add(&self, samples: [(usize, f32); 4], share: f32, sum: &mut [f32; MOST]) {
        let table = [self.least.as_slice(), &self.step];
        match &self.values {
            Values::U8(values) => add_samples(values, |x| f32::from(*x), table, samples, share, sum),
            Values::F16(values) => add_samples(values, |x| x.to_f32(), table, samples, share, sum),
            Values::F32(values) => add_samples(values, |x| *x, table, samples, share, sum),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::{
        shadow_field::bake::{
            basis::Basis,
            bounds::BoundingSphere,
            field::{Field, Thinning},
            grid::direction,
            projected::{ProjectedField, ShellLayout},
        },
        shared::triangle_rays::TriangleRays,
    };
    use glam::Vec3;
    use halfshade_scene::{Mesh, builtin::shapes, progress::Silent};
    use std::f32::consts::{PI, TAU};
    use wide::f32x8;

    const FIXED: Thinning = Thinning { threshold: None, drops_shells: false };

    fn shells(count: usize, resolution: usize) -> ShellLayout {
        ShellLayout { count, inner: 0, resolution, spacing: 0.2, leaves_solids: false }
    }

    fn bounds_of(mesh: &Mesh) -> BoundingSphere {
        BoundingSphere::of_mesh(mesh).unwrap()
    }

    fn baked(mesh: &Mesh, threshold: Option<f64>, storage: Storage) -> Field<ShShell> {
        let basis = ShBasis::new(4, 32);
        let bounds = bounds_of(mesh);
        let projected = ProjectedField::new(&basis, (&TriangleRays::new(mesh), bounds), shells(12, 16), &Silent);
        Field::new(&basis, &projected, Thinning { threshold, drops_shells: false }, storage)
    }

    fn at(field: &Field<ShShell>, point: Vec3) -> [f32; MOST] {
        let offset = point - field.center;
        let distance = offset.length();
        let mut found = [0.0; MOST];
        let (u, v) = (offset.z.atan2(offset.x) / TAU, (offset.y / distance).acos() / PI);
        field.add_at([distance / field.radius, u, v].map(f32x8::splat), std::slice::from_mut(&mut found));
        found
    }

    fn exact(mesh: &Mesh, field: &Field<ShShell>, point: Vec3, map: usize) -> Vec<f32> {
        let bounds = BoundingSphere { center: field.center, radius: field.radius };
        ShBasis::new(4, map).blocked_from(&TriangleRays::new(mesh), point, bounds)
    }

    /// At its sample points a field is what was projected there, to the quantizer's step.
    #[test]
    fn sample_points_keep_their_values() {
        let mesh = shapes::torus(0.7, 0.3, 40, 20);
        for (storage, bound) in [(Storage::F32, 2e-5), (Storage::F16, 4e-3), (Storage::U8, 0.02)] {
            let field = baked(&mesh, None, storage);
            for (shell, column, row) in [(0, 3, 5), (4, 0, 0), (5, 15, 8), (7, 9, 15), (11, 4, 4)] {
                let place = direction([(column as f32 + 0.5) / 16.0, (row as f32 + 0.5) / 16.0]);
                let point = field.center + 0.2 * field.radius * (shell + 1) as f32 * place;
                for (found, exact) in at(&field, point).iter().zip(exact(&mesh, &field, point, 32)) {
                    assert!((found - exact).abs() < bound, "{storage:?} {shell}: {found} {exact}");
                }
            }
        }
    }

    /// Between sample points of a shell the field comes near to what would be projected there, the nearer the denser
    /// they are.
    #[test]
    fn denser_points_converge_to_the_projection() {
        let mesh = shapes::torus(0.7, 0.3, 40, 20);
        let (basis, bounds) = (ShBasis::new(4, 48), bounds_of(&mesh));
        let points: Vec<Vec3> = (0..60)
            .map(|i| {
                let direction = direction([0.618_034 * i as f32 % 1.0, (i as f32 + 0.5) / 60.0]);
                // On a shell outside: what is between shells isn't asked here.
                bounds.center + [1.2, 1.6, 2.0][i % 3] * bounds.radius * direction
            })
            .collect();
        let error = |resolution| {
            let projected =
                ProjectedField::new(&basis, (&TriangleRays::new(&mesh), bounds), shells(10, resolution), &Silent);
            let field = Field::new(&basis, &projected, FIXED, Storage::F32);
            let squares = points.iter().map(|&point| {
                let exact = exact(&mesh, &field, point, 48);
                at(&field, point).iter().zip(&exact).map(|(found, exact)| f64::from(found - exact).powi(2)).sum::<f64>()
            });
            (squares.sum::<f64>() / points.len() as f64).sqrt()
        };
        let errors = [8, 16, 32].map(error);
        assert!(errors[1] < 0.5 * errors[0] && errors[2] < 0.6 * errors[1] && errors[2] < 0.03, "{errors:?}");
    }

    /// All shells of a ball are alike in all directions but for the turn of what is seen; within it everything is dark,
    /// and one point tells all.
    #[test]
    fn shells_inside_a_solid_collapse_and_bytes_shrink() {
        let mesh = shapes::sphere(24);
        let fixed = baked(&mesh, None, Storage::U8);
        let adaptive = baked(&mesh, Some(0.02), Storage::U8);
        let resolutions = adaptive.resolutions();
        assert!(resolutions[..4].iter().all(|&resolution| resolution == 1), "{resolutions:?}");
        assert!(adaptive.bytes() < fixed.bytes() && resolutions[11] <= 16, "{resolutions:?}");
        let all = baked(&mesh, Some(1e9), Storage::F32);
        assert!(all.resolutions().iter().all(|&resolution| resolution == 1));
    }

    /// Shells that go where their neighbours tell as much: fewer bytes, the error still within bounds everywhere.
    #[test]
    fn dropped_shells_are_found_between_their_neighbours() {
        let mesh = shapes::torus(0.7, 0.3, 40, 20);
        let (basis, bounds) = (ShBasis::new(4, 32), bounds_of(&mesh));
        let projected = ProjectedField::new(&basis, (&TriangleRays::new(&mesh), bounds), shells(24, 16), &Silent);
        let field = |drops_shells| {
            Field::<ShShell>::new(&basis, &projected, Thinning { threshold: Some(0.02), drops_shells }, Storage::F32)
        };
        let (all, fewer) = (field(false), field(true));
        let left = fewer.resolutions().iter().filter(|&&resolution| resolution > 0).count();
        assert!(left < 20 && fewer.bytes() < all.bytes(), "{:?}", fewer.resolutions());
        for i in 0..200 {
            let place = direction([0.618_034 * i as f32 % 1.0, (i as f32 + 0.5) / 200.0]);
            let point = bounds.center + (0.2 + 4.5 * (i % 20) as f32 / 20.0) * bounds.radius * place;
            let (a, b) = (at(&all, point), at(&fewer, point));
            let off = basis.difference(&a[..16].to_vec(), &b[..16].to_vec());
            assert!(off < 0.04, "{i}: {off}");
        }
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
        for (distance, u, v) in [(0.0, 0.0, 0.0), (1e9, 0.5, 1.0), (f32::MAX, -0.5, 0.5), (3.0, 0.5, 0.0)] {
            let mut found = [0.0; MOST];
            field.add_at([distance, u, v].map(f32x8::splat), std::slice::from_mut(&mut found));
            assert!(found.iter().all(|x| x.is_finite()) && (0.0..4.0).contains(&found[0]), "{distance}: {found:?}");
        }
    }
}
