//! Stages of the work for one receiver and light, any of which can be repeated to find its share of the time.

use std::hint::black_box;

/// A part of the work, in the order of [Meunier2009, table 1].
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Stage {
    /// Lobes of the reflectance.
    Reflectance,
    /// The light, and what a receiver reflects of it unblocked.
    Light,
    /// Spheres in the way, and which cells they cover.
    Mask,
    /// Lobes of the covered cells.
    MaskLobes,
    /// Integrals of their products.
    Integrals,
}

impl Stage {
    /// Every stage.
    pub const ALL: [Self; 5] = [Self::Reflectance, Self::Light, Self::Mask, Self::MaskLobes, Self::Integrals];
}

/// How often stages run; their results are the same.
pub(crate) trait Repetition: Copy {
    fn run<T>(self, stage: Stage, work: impl FnMut() -> T) -> T;
}

/// Every stage once.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Once;

/// One stage twice.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Twice(pub(crate) Stage);

impl Repetition for Once {
    #[inline(always)]
    fn run<T>(self, _: Stage, mut work: impl FnMut() -> T) -> T {
        work()
    }
}

impl Repetition for Twice {
    #[inline(always)]
    fn run<T>(self, stage: Stage, mut work: impl FnMut() -> T) -> T {
        if self.0 == stage {
            black_box(work());
        }
        work()
    }
}
