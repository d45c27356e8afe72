//! Numbers of a kernel: one f32, one f64 or eight f32 side by side.

use std::ops::{Add, Mul, Sub};
use wide::f32x8;

/// A number, or eight in parallel.
pub trait Lane: Copy + Default + Add<Output = Self> + Sub<Output = Self> + Mul<Output = Self> {
    /// The constant `value` in every lane, rounded to the lane's precision.
    fn constant(value: f64) -> Self;

    /// `self·a + b`, fused.
    fn mul_add(self, a: Self, b: Self) -> Self;
}

impl Lane for f32 {
    #[inline(always)]
    fn constant(value: f64) -> Self {
        value as f32
    }

    #[inline(always)]
    fn mul_add(self, a: Self, b: Self) -> Self {
        f32::mul_add(self, a, b)
    }
}

impl Lane for f64 {
    #[inline(always)]
    fn constant(value: f64) -> Self {
        value
    }

    #[inline(always)]
    fn mul_add(self, a: Self, b: Self) -> Self {
        f64::mul_add(self, a, b)
    }
}

impl Lane for f32x8 {
    #[inline(always)]
    fn constant(value: f64) -> Self {
        Self::splat(value as f32)
    }

    #[inline(always)]
    fn mul_add(self, a: Self, b: Self) -> Self {
        f32x8::mul_add(self, a, b)
    }
}
