//! A sun or a local sphere as a cap of constant radiance.

use crate::{
    batch::Batch,
    directions::Axes,
    points::{Scramble, unit_f32},
    receiver::Receiver,
};
use glam::Vec3;
use std::f64::consts::TAU;

/// A sphere or a sun as a receiver sees it.
#[derive(Debug, Clone, Copy)]
pub(crate) struct LightCap {
    pub(crate) axes: Axes,
    /// Distance and radius of the sphere in tracing space; infinite and 0 for a sun.
    pub(crate) distance: f64,
    pub(crate) radius: f64,
    /// 1 - cos of the angular radius: its solid angle over 2π. 2 if the receiver is inside.
    pub(crate) one_minus_cosine: f64,
    pub(crate) radiance: Vec3,
}

impl LightCap {
    /// Whether the receiver is inside.
    pub(crate) fn is_around(&self) -> bool {
        self.distance <= self.radius
    }

    /// Density per steradian of uniform directions over the cap.
    pub(crate) fn density(&self) -> f64 {
        1.0 / (TAU * self.one_minus_cosine)
    }

    /// Distance along a direction at which the light begins, or ends if the receiver is inside.
    #[inline(always)]
    fn surface_distance(&self, cosine: f32, sine_squared: f32) -> f32 {
        let (distance, radius) = (self.distance as f32, self.radius as f32);
        let half_chord = (radius * radius - distance * distance * sine_squared).max(0.0).sqrt();
        distance * cosine + if distance <= radius { half_chord } else { -half_chord }
    }

    /// Length of a ray towards the light, at a cosine and squared sine to its axis.
    pub(crate) fn ray_length(&self, cosine: f32, sine_squared: f32) -> f32 {
        if self.distance.is_finite() { self.surface_distance(cosine, sine_squared) } else { f32::INFINITY }
    }

    /// Fills directions over the cap, and what arrives along them over the density, that of the cosine added if `wide`.
    pub(crate) fn sample(
        &self,
        wide: bool,
        receiver: &Receiver,
        points: &[[u32; 2]],
        scramble: Scramble,
        batch: &mut Batch,
    ) {
        let normal = receiver.axes.axis;
        let (one_minus_cosine, density) = (self.one_minus_cosine as f32, self.density() as f32);
        let cosine_density = if wide { std::f32::consts::FRAC_1_PI } else { 0.0 };
        let local = self.distance.is_finite();
        for (k, &point) in points.iter().enumerate() {
            let [u, v] = scramble.apply(point).map(unit_f32);
            let height = u * one_minus_cosine;
            let sine_squared = height * (2.0 - height);
            let direction = self.axes.direction(sine_squared.sqrt(), 1.0 - height, v);
            let cosine = (direction[0] * normal.x + direction[1] * normal.y + direction[2] * normal.z).max(0.0);
            let weight = cosine / (density + cosine * cosine_density);
            batch.set_direction(k, direction);
            batch.set_value(k, self.radiance.to_array().map(|radiance| radiance * weight));
            batch.distance[k] = if local { self.surface_distance(1.0 - height, sine_squared) } else { f32::INFINITY };
        }
    }

    /// Sets the values of directions that were drawn by cosine.
    pub(crate) fn weigh_cosine_samples(&self, receiver: &Receiver, batch: &mut Batch) {
        let (normal, axis) = (receiver.axes.axis, self.axes.axis);
        let inside = self.distance <= self.radius;
        let density = if inside { 0.0 } else { self.density() as f32 };
        let sine_limit = if inside { f32::INFINITY } else { (self.radius / self.distance).powi(2) as f32 };
        for k in 0..batch.len {
            let direction = Vec3::from_array(std::array::from_fn(|i| batch.direction[i][k]));
            let (across, along) = (direction.cross(axis).length_squared(), direction.dot(axis));
            let cosine = direction.dot(normal).max(0.0);
            let hits = inside || (along > 0.0 && across < sine_limit);
            let weight = cosine / (density + cosine * std::f32::consts::FRAC_1_PI).max(f32::MIN_POSITIVE);
            let weight = if hits { weight } else { 0.0 };
            batch.set_value(k, self.radiance.to_array().map(|radiance| radiance * weight));
            batch.distance[k] = self.surface_distance(along, across);
        }
    }
}
