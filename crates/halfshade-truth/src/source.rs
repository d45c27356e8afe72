//! One light as a glossy receiver sees it: directions drawn towards it, and what arrives along given directions.

use crate::{
    batch::{BATCH, Batch},
    environment::MapSampler,
    light_cap::LightCap,
    points::{Scramble, unit_f32},
};
use glam::{DVec3, Vec3};

/// Light of one integral.
#[derive(Debug)]
pub(crate) enum Source<'a> {
    /// The same from everywhere.
    Constant(Vec3),
    /// A distant map.
    Map(&'a MapSampler),
    /// A sun or a local sphere.
    Cap(LightCap),
}

/// Density per steradian with which [`Source::draw`] would have drawn each direction of a batch.
pub(crate) type Densities = [f64; BATCH];

impl Source<'_> {
    /// Whether drawing by light can find what drawing by reflectance misses: not where light is all around.
    pub(crate) fn is_drawn(&self) -> bool {
        match self {
            Self::Constant(_) => false,
            Self::Map(_) => true,
            Self::Cap(cap) => !cap.is_around(),
        }
    }

    /// Draws directions by light. The values of the batch become radiance, not divided by any density.
    pub(crate) fn draw(&self, points: &[[u32; 2]], scramble: Scramble, batch: &mut Batch) -> Densities {
        let mut densities = [0.0; BATCH];
        batch.len = points.len();
        match self {
            Self::Constant(_) => batch.len = 0,
            Self::Map(map) => {
                batch.distance = [f32::INFINITY; BATCH];
                let texels = map.draw(points, scramble, batch);
                set_texels(map, &texels, batch, &mut densities);
            }
            Self::Cap(cap) => {
                let one_minus_cosine = cap.one_minus_cosine as f32;
                for (k, &point) in points.iter().enumerate() {
                    let [u, v] = scramble.apply(point).map(unit_f32);
                    let height = u * one_minus_cosine;
                    let sine_squared = height * (2.0 - height);
                    batch.set_direction(k, cap.axes.direction(sine_squared.sqrt(), 1.0 - height, v));
                    batch.set_value(k, cap.radiance.to_array());
                    batch.distance[k] = cap.ray_length(1.0 - height, sine_squared);
                }
                densities[..batch.len].fill(cap.density());
            }
        }
        densities
    }

    /// Sets values and distances to what arrives along the directions of a batch.
    pub(crate) fn look(&self, batch: &mut Batch) -> Densities {
        let mut densities = [0.0; BATCH];
        match self {
            Self::Constant(radiance) => {
                batch.distance = [f32::INFINITY; BATCH];
                (0..batch.len).for_each(|k| batch.set_value(k, radiance.to_array()));
            }
            Self::Map(map) => {
                batch.distance = [f32::INFINITY; BATCH];
                let texels = map.texels_along(batch);
                set_texels(map, &texels, batch, &mut densities);
            }
            Self::Cap(cap) => {
                let (axis, inside) = (cap.axes.axis.as_dvec3(), cap.is_around());
                let sine_limit = cap.one_minus_cosine * (2.0 - cap.one_minus_cosine);
                let density = if inside { 0.0 } else { cap.density() };
                for (k, found) in densities.iter_mut().enumerate().take(batch.len) {
                    let direction = DVec3::from_array(std::array::from_fn(|i| f64::from(batch.direction[i][k])));
                    let (across, along) = (direction.cross(axis).length_squared(), direction.dot(axis));
                    let hits = inside || (along > 0.0 && across < sine_limit);
                    batch.set_value(k, if hits { cap.radiance.to_array() } else { [0.0; 3] });
                    batch.distance[k] = cap.ray_length(along as f32, across as f32);
                    *found = if hits { density } else { 0.0 };
                }
            }
        }
        densities
    }
}

fn set_texels(map: &MapSampler, texels: &[usize; BATCH], batch: &mut Batch, densities: &mut Densities) {
    for k in 0..batch.len {
        let (radiance, density) = map.radiance_and_density(texels[k]);
        batch.set_value(k, radiance);
        densities[k] = density;
    }
}
