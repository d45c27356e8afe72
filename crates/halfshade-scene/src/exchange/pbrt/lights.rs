//! Light of a scene file.

use super::parameters::Parameters;
use crate::SceneError;
use crate::exchange::assembly::{Assembly, Distant};
use crate::exchange::values::radiance;
use crate::light::{EnvironmentMap, load_picture};
use glam::{DMat4, DVec3, Vec3};
use std::f64::consts::FRAC_2_PI;
use std::path::Path;

type Result<T> = std::result::Result<T, SceneError>;

/// Adds a light source that stands by itself.
pub(super) fn light_source(
    kind: &str,
    parameters: &Parameters,
    world_from_light: DMat4,
    assembly: &mut Assembly,
) -> Result<()> {
    let (path, line) = (parameters.path.clone(), parameters.line);
    if kind != "infinite" {
        assembly.note(&path, line, &format!("light source `{}` left out", kind.escape_debug()));
        return Ok(());
    }
    if parameters.kind("portal").is_some() || parameters.kind("illuminance").is_some() {
        assembly.note(&path, line, "`portal` and `illuminance` of an infinite light left out");
    }
    let distant = match parameters.text("filename") {
        None => Distant::Constant(emitted(parameters, assembly)?),
        Some(name) => {
            let map = environment_map(parameters, &path.parent().unwrap_or(Path::new("")).join(name), assembly)?;
            Distant::Map { map, world_from_map: world_from_light }
        }
    };
    if assembly.distant.is_some() {
        assembly.note(&path, line, "a second infinite light left out");
        return Ok(());
    }
    assembly.distant = Some(distant);
    Ok(())
}

/// Radiance `L` times `scale`.
pub(super) fn emitted(parameters: &Parameters, assembly: &mut Assembly) -> Result<Vec3> {
    let color = match parameters.kind("L") {
        None => Vec3::ONE,
        Some("rgb") => parameters.rgb("L").ok_or_else(|| parameters.error_at("L", "`L` needs red, green and blue"))?,
        Some(_) => {
            assembly.note(&parameters.path, parameters.line, "`L` by a spectrum left out: white, of radiance 1");
            Vec3::ONE
        }
    };
    if parameters.kind("power").is_some() {
        assembly.note(&parameters.path, parameters.line, "`power` of a light left out");
    }
    let scale = parameters.number("scale").unwrap_or(1.0) as f32;
    radiance(scale * color).map_err(|problem| parameters.error_at("L", problem))
}

/// An image on a square that the sphere is unfolded to, of equal areas, as a map of latitude and longitude: a lookup for each
/// of its texels, which are about as large.
fn environment_map(parameters: &Parameters, path: &Path, assembly: &mut Assembly) -> Result<EnvironmentMap> {
    let ending = path.extension().map(|ending| ending.to_string_lossy().to_lowercase());
    if !matches!(ending.as_deref(), Some("exr" | "hdr" | "pic")) {
        return Err(parameters
            .error_at("filename", "the image of an infinite light is neither .exr nor .hdr")
            .with_remedy("convert it to OpenEXR"));
    }
    let ([side, rows], pixels, notes) = load_picture(path).map_err(|error| match path.is_file() {
        true => error,
        false => parameters.error_at("filename", error.to_string()),
    })?;
    assembly.note_all(path, notes);
    if side != rows {
        let problem = format!("the image is {side}x{rows}, and pbrt-v4 unfolds the sphere to a square");
        return Err(parameters.error_at("filename", problem).with_remedy("convert it by `imgtool makeequiarea`"));
    }
    assembly.note(&parameters.path, parameters.line, "the environment is resampled by latitude and longitude");
    let scale = parameters.number("scale").unwrap_or(1.0) as f32;
    let height = side.max(2);
    let empty = EnvironmentMap::new(2 * height, height, vec![Vec3::ZERO; 2 * height * height]);
    let texels = empty.iter().flat_map(|map| {
        (0..map.texels().len()).map(|texel| {
            let place = place_on_square(map.texel_direction(texel).as_dvec3());
            let [column, row] = place.map(|x| ((x * side as f64) as usize).min(side - 1));
            scale * pixels[row * side + column]
        })
    });
    let map = EnvironmentMap::new(2 * height, height, texels.collect());
    let map = map.filter(|map| map.texels().iter().all(|texel| radiance(*texel).is_ok()));
    map.ok_or_else(|| parameters.error_at("scale", format!("scale = {scale} makes radiance that is none")))
}

/// The place of a unit direction on the unit square, both from 0 to 1: the inverse of a mapping that keeps areas
/// \[Clarberg2008\], +Z in the middle.
fn place_on_square(direction: DVec3) -> [f64; 2] {
    let d = direction.abs();
    let radius = (1.0 - d.z).max(0.0).sqrt();
    let phi = d.x.min(d.y).atan2(d.x.max(d.y)) * FRAC_2_PI;
    let phi = if d.x < d.y { 1.0 - phi } else { phi };
    let (mut u, mut v) = (radius - phi * radius, phi * radius);
    if direction.z < 0.0 {
        (u, v) = (1.0 - v, 1.0 - u);
    }
    [0.5 * (u.copysign(direction.x) + 1.0), 0.5 * (v.copysign(direction.y) + 1.0)]
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_square_has_equal_areas_and_z_in_its_middle() {
        assert_eq!(place_on_square(DVec3::Z), [0.5, 0.5]);
        let near = |d: DVec3, expected: [f64; 2]| {
            let found = place_on_square(d);
            assert!((found[0] - expected[0]).abs() + (found[1] - expected[1]).abs() < 1e-12, "{d}: {found:?}");
        };
        near(DVec3::X, [1.0, 0.5]);
        near(DVec3::Y, [0.5, 1.0]);
        near(DVec3::NEG_X, [0.0, 0.5]);
        near(DVec3::NEG_Z, [1.0, 1.0]);
        let mut counts = [0_u32; 64];
        let count = 64 * 400;
        for i in 0..count {
            let z = 1.0 - (2.0 * f64::from(i) + 1.0) / f64::from(count);
            let (sin, cos) = (2.399_963_229_728_653 * f64::from(i)).sin_cos();
            let r = (1.0 - z * z).sqrt();
            let [x, y] = place_on_square(DVec3::new(r * cos, r * sin, z)).map(|x| ((8.0 * x) as usize).min(7));
            counts[8 * y + x] += 1;
        }
        assert!(counts.iter().all(|count| count.abs_diff(400) < 25), "{counts:?}");
    }
}
