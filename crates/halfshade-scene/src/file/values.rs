//! Numbers of a scene file, each checked against what it may be.

use super::source::Source;
use crate::SceneError;
use glam::Vec3;
use std::ops::RangeInclusive;
use toml::Spanned;

type Result<T> = std::result::Result<T, SceneError>;

/// A whole number within a range, or its default.
pub(super) fn whole(
    source: &Source<'_>,
    what: &str,
    value: Option<Spanned<i64>>,
    range: RangeInclusive<i64>,
    default: usize,
) -> Result<usize> {
    let Some(value) = value else { return Ok(default) };
    let number = *value.get_ref();
    if range.contains(&number) {
        return Ok(number as usize);
    }
    let (min, max) = range.into_inner();
    Err(source.error(value.span(), format!("{what} = {number} lies outside of {min} to {max}")))
}

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

/// A point or a shift: three finite numbers.
pub(super) fn place(source: &Source<'_>, what: &str, value: &Spanned<[f32; 3]>) -> Result<Vec3> {
    checked(source, what, value, "three finite numbers", |v| Vec3::from(v).is_finite()).map(Vec3::from)
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
