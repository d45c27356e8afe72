//! Draws: the same for the same seed.

use glam::{Quat, Vec3};
use rand::{RngExt, SeedableRng};
use rand_pcg::Pcg64Mcg;

/// A source of draws.
pub(crate) struct Random(Pcg64Mcg);

impl Random {
    pub(crate) fn new(seed: u64) -> Self {
        Self(Pcg64Mcg::seed_from_u64(seed))
    }

    /// Uniform in [from, to).
    pub(crate) fn between(&mut self, from: f32, to: f32) -> f32 {
        from + (to - from) * self.0.random::<f32>()
    }

    /// Uniform in the logarithm.
    pub(crate) fn log_between(&mut self, from: f32, to: f32) -> f32 {
        self.between(from.ln(), to.ln()).exp()
    }

    /// A number below `count`.
    pub(crate) fn below(&mut self, count: usize) -> usize {
        self.0.random_range(0..count.max(1))
    }

    pub(crate) fn chance(&mut self, probability: f32) -> bool {
        self.0.random::<f32>() < probability
    }

    pub(crate) fn pick<T: Copy>(&mut self, choices: &[T]) -> T {
        choices[self.below(choices.len())]
    }

    /// A unit vector, evenly over the sphere.
    pub(crate) fn direction(&mut self) -> Vec3 {
        let y = self.between(-1.0, 1.0);
        let (sin, cos) = self.between(0.0, std::f32::consts::TAU).sin_cos();
        let across = (1.0 - y * y).max(0.0).sqrt();
        Vec3::new(across * cos, y, across * sin).normalize()
    }

    pub(crate) fn rotation(&mut self) -> Quat {
        Quat::from_axis_angle(self.direction(), self.between(0.0, std::f32::consts::TAU)).normalize()
    }

    /// A colour in [0, 1]³, often at an end.
    pub(crate) fn color(&mut self) -> Vec3 {
        match self.below(5) {
            0 => Vec3::ZERO,
            1 => Vec3::ONE,
            2 => Vec3::splat(self.between(0.0, 1.0)),
            _ => Vec3::new(self.between(0.0, 1.0), self.between(0.0, 1.0), self.between(0.0, 1.0)),
        }
    }
}
