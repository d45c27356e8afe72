//! Light probes: images of all directions, in files.

use super::angular::from_angular;
use super::image_file::{Image, decode_exr, decode_hdr};
use super::{EnvironmentMap, luminance};
use crate::SceneError;
use glam::Vec3;
use std::path::Path;
use std::str::FromStr;

/// Extensions of the images that [`load_probe`] reads, in lower case.
pub const EXTENSIONS: &[&str] = &["hdr", "pic", "exr"];

/// Values below zero down to this fraction of the mean luminance are rounding and filtering, and taken for 0.
const NEGLIGIBLE: f32 = 0.01;

/// How an image holds all directions.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Projection {
    /// Latitude and longitude: row 0 is the zenith, width is twice the height.
    LatLong,
    /// A disc: radius proportional to the angle from the centre. Width equals height.
    Angular,
}

impl Projection {
    /// The names that scene files use.
    pub const NAMES: [&'static str; 2] = ["latlong", "angular"];
}

impl FromStr for Projection {
    type Err = SceneError;

    fn from_str(name: &str) -> Result<Self, SceneError> {
        match name {
            "latlong" => Ok(Self::LatLong),
            "angular" => Ok(Self::Angular),
            _ => Err(SceneError::new(format!("unknown projection `{name}`; known: {}", Self::NAMES.join(", ")))),
        }
    }
}

/// Reads a light probe: Radiance HDR or OpenEXR, by extension, as linear Rec. 709 radiance.
///
/// The image's centre looks `forward_degrees` from -Z toward +X; 0 is -Z. A latitude-longitude map is turned by whole
/// columns exactly, and by parts of a column by sharing texels between two neighbours, which keeps every row's mean.
/// What an HDR file says it was multiplied by (EXPOSURE, COLORCORR) is divided out. Radiances that aren't finite are
/// errors, and so are negative ones beyond a hundredth of the mean luminance; smaller ones are set to 0.
pub fn load_probe(path: &Path, projection: Projection, forward_degrees: f32) -> Result<EnvironmentMap, SceneError> {
    read(path, projection, forward_degrees).map_err(|error| error.in_file(path))
}

fn read(path: &Path, projection: Projection, forward_degrees: f32) -> Result<EnvironmentMap, SceneError> {
    if !forward_degrees.is_finite() {
        return Err(SceneError::new("forward_degrees is not a finite number"));
    }
    let extension = path.extension().map(|e| e.to_string_lossy().to_lowercase()).unwrap_or_default();
    let decode = match extension.as_str() {
        "hdr" | "pic" => decode_hdr,
        "exr" => decode_exr,
        _ => {
            return Err(SceneError::new(format!("`.{extension}` is no light probe format known here"))
                .with_remedy(format!("use one of: .{}", EXTENSIONS.join(", ."))));
        }
    };
    let bytes = crate::input::read(path).map_err(|error| SceneError::new(format!("cannot be read: {error}")))?;
    if bytes.is_empty() {
        return Err(SceneError::new("the file is empty"));
    }
    let mut image = decode(&bytes)?;
    check_shape(&image, projection)?;
    check_radiance(&mut image, projection)?;
    let forward = forward_degrees.rem_euclid(360.0);
    let map = match projection {
        Projection::LatLong => turned(image, f64::from(forward) / 360.0),
        Projection::Angular => from_angular(&image, forward.to_radians()),
    };
    map.ok_or_else(|| SceneError::new("the image is empty"))
}

/// Refuses an image that can't be of this projection.
fn check_shape(image: &Image, projection: Projection) -> Result<(), SceneError> {
    let (width, height) = (image.width, image.height);
    let (fits, needed, other) = match projection {
        Projection::LatLong => {
            (width == 2 * height, "a lat-long map is twice as wide as high", "projection = \"angular\"")
        }
        Projection::Angular => (width == height, "an angular map is a square", "projection = \"latlong\""),
    };
    if fits {
        return Ok(());
    }
    let error = SceneError::new(format!("the image is {width}x{height}, but {needed}"));
    let is_other = if projection == Projection::LatLong { width == height } else { width == 2 * height };
    Err(error.with_remedy(if is_other {
        format!("try {other}")
    } else {
        "convert it to latlong or angular".to_owned()
    }))
}

/// Refuses radiance that isn't one, and sets negligible negative values to 0. Of an angular map only the disc counts.
fn check_radiance(image: &mut Image, projection: Projection) -> Result<(), SceneError> {
    let n = image.width as f32;
    let counts = |i: usize| {
        let center = |i: usize| 2.0 * (i as f32 + 0.5) / n - 1.0;
        projection == Projection::LatLong || center(i % image.width).hypot(center(i / image.width)) <= 1.0
    };
    let place = |i: usize| format!("column {}, row {}", i % image.width, i / image.width);
    let used = || image.texels.iter().enumerate().filter(|(i, _)| counts(*i));
    if let Some((i, texel)) = used().find(|(_, texel)| !texel.is_finite()) {
        return Err(SceneError::new(format!("the radiance at {} is {texel}, not a finite number", place(i))));
    }
    let mean = used().map(|(_, texel)| luminance(texel.max(Vec3::ZERO))).sum::<f32>() / used().count().max(1) as f32;
    if let Some((i, texel)) = used().find(|(_, texel)| texel.min_element() < -NEGLIGIBLE * mean) {
        return Err(SceneError::new(format!("the radiance at {} is negative: {texel}", place(i))));
    }
    image.texels.iter_mut().for_each(|texel| *texel = texel.max(Vec3::ZERO));
    Ok(())
}

/// A latitude-longitude image turned by `turn` of a full circle toward +X.
fn turned(image: Image, turn: f64) -> Option<EnvironmentMap> {
    let Image { width, height, texels } = image;
    let shift = turn * width as f64;
    let (whole, part) = (shift.floor() as usize % width.max(1), shift.fract() as f32);
    if whole == 0 && part == 0.0 {
        return EnvironmentMap::new(width, height, texels);
    }
    let turned = texels.chunks_exact(width).flat_map(|row| {
        (0..width).map(move |column| {
            let source = (column + width - whole) % width;
            row[source].lerp(row[(source + width - 1) % width], part)
        })
    });
    EnvironmentMap::new(width, height, turned.collect())
}

#[cfg(test)]
mod tests {
    use super::*;
    use glam::Vec3;

    fn image(width: usize, height: usize) -> Image {
        Image { width, height, texels: (0..width * height).map(|i| Vec3::splat(1.0 + i as f32)).collect() }
    }

    #[test]
    fn a_turned_map_shows_its_centre_where_it_should() {
        let plain = turned(image(8, 4), 0.0).unwrap();
        let quarter = turned(image(8, 4), 0.25).unwrap();
        assert_eq!(quarter.radiance(quarter.direction_at(0.76, 0.6)), plain.radiance(plain.direction_at(0.51, 0.6)));
        let odd = turned(image(8, 4), 0.3).unwrap();
        assert!(odd.mean_radiance().distance(plain.mean_radiance()) < 1e-5);
        assert!((odd.texels()[3].x - (0.6 * plain.texels()[1].x + 0.4 * plain.texels()[0].x)).abs() < 1e-5);
    }

    #[test]
    fn wrong_shapes_are_named_with_the_likely_remedy() {
        let error = |image: &Image, projection| check_shape(image, projection).unwrap_err().to_string();
        let text = error(&image(4, 4), Projection::LatLong);
        assert!(text.contains("4x4") && text.contains("twice as wide") && text.contains("angular"), "{text}");
        assert!(error(&image(8, 4), Projection::Angular).contains("latlong"));
        assert!(error(&image(4, 3), Projection::LatLong).contains("convert"));
    }

    #[test]
    fn impossible_radiance_is_named_and_undershoot_forgiven() {
        for bad in [f32::NAN, f32::INFINITY, -1.0] {
            let mut damaged = image(8, 4);
            damaged.texels[13].y = bad;
            let text = check_radiance(&mut damaged, Projection::LatLong).unwrap_err().to_string();
            assert!(text.contains("column 5, row 1"), "{text}");
        }
        let mut undershoot = image(8, 4);
        undershoot.texels[13].y = -0.05;
        check_radiance(&mut undershoot, Projection::LatLong).unwrap();
        assert_eq!(undershoot.texels[13].y, 0.0);
        let mut captioned = image(4, 4);
        captioned.texels[15] = Vec3::NAN;
        check_radiance(&mut captioned, Projection::Angular).unwrap();
    }
}
