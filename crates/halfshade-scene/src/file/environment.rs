//! The light from infinitely far in a scene file.

use super::document::{EnvironmentTable, SkyTable};
use super::source::{Source, named_notes};
use super::values::{checked, radiance};
use crate::keys::Spanned;
use crate::light::{ProbeOptions, Projection, Sky, load_probe};
use crate::{Environment, SceneError};
use glam::Vec3;

type Result<T> = std::result::Result<T, SceneError>;

/// The environment, and its turn in radians per second; what the user should know of its image is appended to `notes`.
pub(super) fn environment(
    source: &Source<'_>,
    table: Spanned<EnvironmentTable>,
    notes: &mut Vec<String>,
) -> Result<(Environment, f32)> {
    let span = table.span();
    let EnvironmentTable { constant, image, projection, forward_degrees, layer, clamp, sky, turn_degrees_per_sec } =
        table.into_inner();
    let degrees = |what: &str, value: Option<Spanned<f32>>| match value {
        Some(value) => checked(source, what, &value, "a finite number", f32::is_finite),
        None => Ok(0.0),
    };
    if image.is_none() {
        let words = [projection.as_ref().map(Spanned::span), layer.as_ref().map(Spanned::span)];
        let numbers = [&forward_degrees, &clamp].map(|key| key.as_ref().map(Spanned::span));
        if let Some(span) = words.into_iter().chain(numbers).flatten().next() {
            let problem = "projection, forward_degrees, layer and clamp belong to an image, and there is none";
            return Err(source.error(span, problem));
        }
    }
    let turn = degrees("turn_degrees_per_sec", turn_degrees_per_sec)?.to_radians();
    let environment = match (constant, image, sky) {
        (Some(constant), None, None) => Environment::constant(radiance(source, "constant", &constant)?),
        (None, Some(image), None) => {
            let options = ProbeOptions {
                projection: Some(projection.map_or(Projection::LatLong, Spanned::into_inner)),
                forward_degrees: degrees("forward_degrees", forward_degrees)?,
                layer: layer.map(Spanned::into_inner),
                clamp: match clamp {
                    Some(value) => {
                        Some(checked(source, "clamp", &value, "positive and finite", ProbeOptions::is_clamp)?)
                    }
                    None => None,
                },
            };
            let path = source.resolve(image.get_ref());
            let (map, found) = load_probe(&path, &options).map_err(|error| source.named_at(&image, error))?;
            notes.extend(named_notes(&path, found));
            Environment::map(map)
        }
        (None, None, Some(table)) => {
            let span = table.span();
            sky_of(table.into_inner()).environment().map_err(|error| source.error(span, error.problem))?
        }
        _ => return Err(source.error(span, "an environment is one of: constant, image, sky")),
    };
    Ok((environment, turn))
}

/// A sky with defaults filled in.
fn sky_of(table: SkyTable) -> Sky {
    let SkyTable { sun_elevation_degrees, sun_azimuth_degrees, turbidity, ground_albedo, sun, resolution } = table;
    let default = Sky::default();
    Sky {
        sun_elevation_degrees: sun_elevation_degrees.unwrap_or(default.sun_elevation_degrees),
        sun_azimuth_degrees: sun_azimuth_degrees.unwrap_or(default.sun_azimuth_degrees),
        turbidity: turbidity.unwrap_or(default.turbidity),
        ground_albedo: ground_albedo.map_or(default.ground_albedo, Vec3::from),
        sun: sun.unwrap_or(default.sun),
        resolution: resolution.unwrap_or(default.resolution),
    }
}
