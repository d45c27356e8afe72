//! How far a strategy may stray, and what is said of one that strays farther.

/// How far a strategy may stray, as fractions of the scene's mean unshadowed radiance.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Bounds {
    /// Without blockers, from the closed form of constant light.
    pub constant: f32,
    /// Without blockers, from quadrature over a map, a sun or a lamp.
    pub quadrature: f32,
    /// The same for glossy receivers, for whom a highlight may be many times the mean.
    pub gloss: f32,
    /// Between a scene and the same scene turned with everything in it.
    pub rotation: f32,
    /// Rise of a receiver's radiance when a blocker is added.
    pub brightening: f32,
}

/// A clause that doesn't hold, with the numbers.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
#[error("{0}")]
pub struct Violation(pub(super) String);

/// Whether a clause holds.
pub(super) type Checked = Result<(), Violation>;

pub(super) fn violation(message: String) -> Checked {
    Err(Violation(message))
}
