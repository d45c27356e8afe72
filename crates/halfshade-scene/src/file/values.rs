//! Numbers of a scene file, each checked against what it may be.

use super::source::Source;
use crate::SceneError;
use crate::keys::Spanned;
use crate::mesh::LARGEST_COORDINATE;
use glam::Vec3;

type Result<T> = std::result::Result<T, SceneError>;

/// Remedy for a scene too large to compute with.
const IF_LARGER: &str = "; choose a larger unit of length if the scene is that large";

/// A value that `fits`, or an error that says what is expected.
pub(super) fn checked<T: Copy + std::fmt::Debug>(
    source: &Source<'_>,
    what: &str,
    value: &Spanned<T>,
    expected: &str,
    fits: impl Fn(T) -> bool,
) -> Result<T> {
    let inner = *value.get_ref();
    if fits(inner) {
        return Ok(inner);
    }
    Err(source.error(value.span(), format!("{what} = {inner:?} must be {expected}")))
}

/// A point or a shift, no farther out than numbers can be computed with.
pub(super) fn place(source: &Source<'_>, what: &str, value: &Spanned<[f32; 3]>) -> Result<Vec3> {
    let expected = format!("three numbers from -{LARGEST_COORDINATE:e} to {LARGEST_COORDINATE:e}{IF_LARGER}");
    let fits = |v: [f32; 3]| v.iter().all(|x| x.abs() <= LARGEST_COORDINATE);
    checked(source, what, value, &expected, fits).map(Vec3::from)
}

/// A radius, or a scale of what is as large as `size`.
pub(super) fn length(source: &Source<'_>, what: &str, value: &Spanned<f32>, size: f64) -> Result<f32> {
    let largest = f64::from(LARGEST_COORDINATE) / size;
    let expected = format!("positive and at most {largest:.2e}{IF_LARGER}");
    checked(source, what, value, &expected, |x| x > 0.0 && x.is_finite() && f64::from(x) <= largest)
}

/// A fraction of light per channel.
pub(super) fn albedo(source: &Source<'_>, what: &str, value: &Spanned<[f32; 3]>) -> Result<Vec3> {
    let fits = |v: [f32; 3]| v.iter().all(|x| (0.0..=1.0).contains(x));
    checked(source, what, value, "within [0, 1]", fits).map(Vec3::from)
}

/// Light per channel.
pub(super) fn radiance(source: &Source<'_>, what: &str, value: &Spanned<[f32; 3]>) -> Result<Vec3> {
    let fits = |v: [f32; 3]| v.iter().all(|x| x.is_finite() && *x >= 0.0);
    checked(source, what, value, "finite and not negative", fits).map(Vec3::from)
}
