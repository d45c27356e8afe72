//! Distant light gathered into cells of directions, for integrals against smooth functions and the clamped cosine.

use super::EnvironmentMap;
use glam::{DVec3, Vec3};
use std::f64::consts::{PI, TAU};

/// Columns and rows of the coarsest grid of cells; a map of fewer texels is cut finer.
const COLUMNS: usize = 128;
const ROWS: usize = 64;

/// A map's light in cells of about 2.8 degrees, each with its vector irradiance per channel.
///
/// The vector irradiance ∫ L(ω) ω dω of a cell is exact (texels have constant radiance, and ∫ ω dω of a texel is
/// elementary). Irradiance of a cell wholly above or below the horizon of a surface is then exact too,
/// max(n · ∫ L ω dω, 0); only cells cut by the horizon err. On a constant map the sum is 3e-4 too small at most.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct DirectionalCells {
    /// Unit direction of each cell's light: that of its vector irradiance, summed over the channels.
    pub direction: Vec<Vec3>,
    /// ∫ L ω dω of each cell: for each channel, watts per square metre.
    pub vector_irradiance: Vec<[Vec3; 3]>,
}

impl DirectionalCells {
    /// The cells of `map` that are not black.
    pub fn new(map: &EnvironmentMap) -> Self {
        let (fine_columns, fine_rows) =
            (map.width() * COLUMNS.div_ceil(map.width()), map.height() * ROWS.div_ceil(map.height()));
        let mut sums = vec![[DVec3::ZERO; 3]; COLUMNS * ROWS];
        let horizontal: Vec<(f64, f64)> = (0..fine_columns)
            .map(|column| {
                let edge = |c: usize| (c as f64 / fine_columns as f64 - 0.5) * TAU;
                let (a, b) = (edge(column), edge(column + 1));
                (a.cos() - b.cos(), b.sin() - a.sin())
            })
            .collect();
        for row in 0..fine_rows {
            let edge = |r: usize| PI * r as f64 / fine_rows as f64;
            let (a, b) = (edge(row), edge(row + 1));
            let sine_squared = 0.5 * (b - a) - 0.25 * ((2.0 * b).sin() - (2.0 * a).sin());
            let up = 0.5 * (b.sin().powi(2) - a.sin().powi(2)) * TAU / fine_columns as f64;
            let texel_row = row * map.height() / fine_rows;
            for (column, &(sin_azimuth, cos_azimuth)) in horizontal.iter().enumerate() {
                let radiance = map.texels()[texel_row * map.width() + column * map.width() / fine_columns].as_dvec3();
                let vector = DVec3::new(sine_squared * sin_azimuth, up, -sine_squared * cos_azimuth);
                let cell = &mut sums[row * ROWS / fine_rows * COLUMNS + column * COLUMNS / fine_columns];
                for channel in 0..3 {
                    cell[channel] += radiance[channel] * vector;
                }
            }
        }
        let mut cells = Self::default();
        for sum in sums {
            let total = sum[0] + sum[1] + sum[2];
            if let Some(direction) = total.try_normalize() {
                cells.direction.push(direction.as_vec3());
                cells.vector_irradiance.push(sum.map(|vector| vector.as_vec3()));
            }
        }
        cells
    }

    /// Irradiance per channel on a surface of unit `normal` if nothing blocks.
    pub fn irradiance(&self, normal: Vec3) -> Vec3 {
        let sum = self.vector_irradiance.iter().fold([0.0f64; 3], |mut sum, vectors| {
            for (total, vector) in sum.iter_mut().zip(vectors) {
                *total += f64::from(vector.dot(normal).max(0.0));
            }
            sum
        });
        DVec3::from(sum).as_vec3()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Midpoint rule on a grid that has nothing to do with the cells, its pole along `normal`.
    fn quadrature(map: &EnvironmentMap, normal: Vec3) -> Vec3 {
        let (rings, spokes) = (500, 2000);
        let (t, b) = normal.any_orthonormal_pair();
        let mut sum = DVec3::ZERO;
        for ring in 0..rings {
            // Equal steps of sin² of the polar angle: equal steps of irradiance.
            let sine_squared = (f64::from(ring) + 0.5) / f64::from(rings);
            let (sine, cosine) = (sine_squared.sqrt() as f32, (1.0 - sine_squared).sqrt() as f32);
            for spoke in 0..spokes {
                // Turned from ring to ring, lest spokes and columns keep step.
                let turn = f64::from(spoke) / f64::from(spokes) + 0.618_033_988_75 * f64::from(ring);
                let (y, x) = (turn * TAU).sin_cos();
                sum += map.radiance(sine * (x as f32 * t + y as f32 * b) + cosine * normal).as_dvec3();
            }
        }
        (sum * PI / f64::from(rings * spokes)).as_vec3()
    }

    #[test]
    fn irradiance_matches_quadrature() {
        // Few texels of very different radiance: every cell edge and horizon cut shows.
        for (width, height) in [(8, 4), (7, 3), (300, 130)] {
            let texels = (0..width * height).map(|i| Vec3::new((i * 7 % 11) as f32, (i * 5 % 3) as f32, 1.0)).collect();
            let map = EnvironmentMap::new(width, height, texels).unwrap();
            let cells = DirectionalCells::new(&map);
            for normal in
                [Vec3::Y, Vec3::X, Vec3::new(0.3, -0.8, 0.5).normalize(), Vec3::new(-1.0, 0.1, -1.0).normalize()]
            {
                let (ours, exact) = (cells.irradiance(normal), quadrature(&map, normal));
                assert!(((ours - exact) / exact).abs().max_element() < 2e-3, "{width} {normal}: {ours} {exact}");
            }
        }
    }

    #[test]
    fn a_constant_map_gives_pi() {
        let map = EnvironmentMap::new(1, 1, vec![Vec3::ONE]).unwrap();
        let cells = DirectionalCells::new(&map);
        for normal in [Vec3::Y, Vec3::NEG_Z, Vec3::new(1.0, 1.0, 1.0).normalize()] {
            let relative = cells.irradiance(normal).x / std::f32::consts::PI - 1.0;
            assert!((-3e-4..=1e-5).contains(&relative), "{relative}");
        }
    }
}
