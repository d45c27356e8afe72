//! Light probes: images of all directions, in files.

use super::angular::from_angular;
use super::image_file::{Decoded, Image, decode};
use super::{EnvironmentMap, luminance};
use crate::SceneError;
use glam::{DMat3, Vec3};
use schemars::JsonSchema;
use serde::Deserialize;
use std::path::Path;

/// Extensions of the images that [`load_probe`] reads, in lower case.
pub const EXTENSIONS: &[&str] = &["hdr", "pic", "exr"];

/// Values below zero down to this fraction of the mean luminance are rounding and filtering, and taken for 0.
const NEGLIGIBLE: f32 = 0.01;

/// Projection of all directions onto an image.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Deserialize, JsonSchema)]
#[serde(rename_all = "lowercase")]
pub enum Projection {
    /// Latitude and longitude: row 0 is the zenith, width is twice the height.
    LatLong,
    /// A disc: radius proportional to the angle from the centre. Width equals height.
    Angular,
}

/// Options for reading a light probe.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct ProbeOptions {
    /// Projection of the image; `None`: a square is an angular map, anything else latitude and longitude.
    pub projection: Option<Projection>,
    /// Azimuth of the image's centre, in degrees from -Z toward +X.
    pub forward_degrees: f32,
    /// Layer of an OpenEXR file; `None`: the one that has no name within its part.
    pub layer: Option<String>,
    /// The largest radiance of a channel: infinity and what is larger becomes this, what isn't a number or is negative
    /// becomes 0. `None`: radiance that isn't finite is an error.
    pub clamp: Option<f32>,
}

impl ProbeOptions {
    /// Whether `clamp` can be a largest radiance.
    pub fn is_clamp(clamp: f32) -> bool {
        clamp > 0.0 && clamp.is_finite()
    }
}

/// Reads a light probe, Radiance HDR or OpenEXR, as linear Rec. 709 radiance, with what the user should know of it.
///
/// A latitude-longitude map is turned by whole columns exactly, and by parts of a column by sharing texels between two
/// neighbours, which keeps every row's mean. Factors by which an HDR file was multiplied (EXPOSURE, COLORCORR) are
/// divided out. Other primaries (PRIMARIES, XYZE, OpenEXR's chromaticities) are converted, white to white; channels
/// that fall below 0, of colours that Rec. 709 can't show, become 0. An OpenEXR file's picture is its display window,
/// black where its data window doesn't reach.
///
/// Without [`ProbeOptions::clamp`], radiances that aren't finite are errors, and so are negative ones beyond a hundredth
/// of the mean luminance; smaller ones are set to 0.
pub fn load_probe(path: &Path, options: &ProbeOptions) -> Result<(EnvironmentMap, Vec<String>), SceneError> {
    read(path, options).map_err(|error| error.in_file(path))
}

/// Columns and rows of a picture, its pixels, and what the user should know.
pub(crate) type Picture = ([usize; 2], Vec<Vec3>, Vec<String>);

/// Reads a picture of radiance, Radiance HDR or OpenEXR, whatever its shape and its projection: columns and rows, pixels
/// row by row from the top, and what the user should know. Radiance is converted and checked as [`load_probe`] does.
pub(crate) fn load_picture(path: &Path) -> Result<Picture, SceneError> {
    let read = || {
        let bytes = crate::input::read(path).map_err(|error| SceneError::new(format!("cannot be read: {error}")))?;
        let Decoded { mut image, to_rec709, mut notes } = decode(&bytes, None)?;
        notes.extend(to_radiance(&mut image, Projection::LatLong, to_rec709, None)?);
        Ok(([image.width, image.height], image.texels, notes))
    };
    read().map_err(|error: SceneError| error.in_file(path))
}

fn read(path: &Path, options: &ProbeOptions) -> Result<(EnvironmentMap, Vec<String>), SceneError> {
    let ProbeOptions { projection, forward_degrees, layer, clamp } = options;
    if !forward_degrees.is_finite() {
        return Err(SceneError::new("forward_degrees is not a finite number"));
    }
    if let Some(clamp) = clamp.filter(|clamp| !ProbeOptions::is_clamp(*clamp)) {
        return Err(SceneError::new(format!("clamp = {clamp} must be positive and finite")));
    }
    let extension = path.extension().map(|e| e.to_string_lossy().to_lowercase()).unwrap_or_default();
    if !EXTENSIONS.contains(&extension.as_str()) {
        return Err(SceneError::new(format!("`.{extension}` is no light probe format known here"))
            .with_remedy(format!("use one of: .{}", EXTENSIONS.join(", ."))));
    }
    let bytes = crate::input::read(path).map_err(|error| SceneError::new(format!("cannot be read: {error}")))?;
    let Decoded { mut image, to_rec709, mut notes } = decode(&bytes, layer.as_deref())?;
    let is_square = image.width == image.height;
    let projection = projection.unwrap_or(if is_square { Projection::Angular } else { Projection::LatLong });
    check_shape(&image, projection)?;
    notes.extend(to_radiance(&mut image, projection, to_rec709, *clamp)?);
    let forward = forward_degrees.rem_euclid(360.0);
    let map = match projection {
        Projection::LatLong => turned(image, f64::from(forward) / 360.0),
        Projection::Angular => from_angular(&image, forward.to_radians()),
    };
    Ok((map.ok_or_else(|| SceneError::new("the image is empty"))?, notes))
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

/// Makes radiance in Rec. 709 of what the file holds, or says what is none. Only the disc of an angular map counts.
/// Returns notes for the user.
fn to_radiance(
    image: &mut Image,
    projection: Projection,
    to_rec709: Option<DMat3>,
    clamp: Option<f32>,
) -> Result<Vec<String>, SceneError> {
    let (n, width) = (image.width as f32, image.width);
    let counts = |i: usize| {
        let center = |i: usize| 2.0 * (i as f32 + 0.5) / n - 1.0;
        projection == Projection::LatLong || center(i % width).hypot(center(i / width)) <= 1.0
    };
    if projection == Projection::Angular {
        image.texels.iter_mut().enumerate().filter(|(i, _)| !counts(*i)).for_each(|(_, texel)| *texel = Vec3::ZERO);
    }
    let mut notes = Vec::new();
    let changed = |limit: f32, texel: &mut Vec3| {
        // Not a number is less than nothing here.
        let within = texel.map(|x| if x > 0.0 { x.min(limit) } else { 0.0 });
        std::mem::replace(texel, within) != within
    };
    match clamp {
        Some(limit) => {
            let count = image.texels.iter_mut().filter_map(|texel| changed(limit, texel).then_some(())).count();
            if count > 0 {
                notes.push(format!("radiance of {count} texels was clamped to lie within 0 and {limit}"));
            }
        }
        None => check_radiance(image, projection)?,
    }
    if let Some(matrix) = to_rec709 {
        let mut outside = 0;
        for texel in &mut image.texels {
            let converted = (matrix * texel.as_dvec3()).as_vec3();
            outside += usize::from(converted.min_element() < -NEGLIGIBLE * luminance(converted));
            *texel = converted.max(Vec3::ZERO).min(Vec3::splat(clamp.unwrap_or(f32::INFINITY)));
        }
        check_radiance(image, projection)?;
        if outside > 0 {
            notes.push(format!(
                "colours of {outside} texels lie outside of Rec. 709; what they lack of a primary was set to 0"
            ));
        }
    }
    image.texels.iter_mut().for_each(|texel| *texel = texel.max(Vec3::ZERO));
    Ok(notes)
}

/// Refuses radiance that isn't one.
fn check_radiance(image: &Image, projection: Projection) -> Result<(), SceneError> {
    let place = |i: usize| format!("column {}, row {}", i % image.width, i / image.width);
    let remedy = "mend it, or give a largest radiance: `--clamp 65504`, or `clamp = 65504` in the environment of a scene \
                  file, which also sets negative ones to 0";
    let wrong = |i: usize, texel: &Vec3, what: &str, count: usize| {
        let others = if count > 1 { format!(" (and {} others)", count - 1) } else { String::new() };
        SceneError::new(format!("the radiance at {} is {texel}, {what}{others}", place(i))).with_remedy(remedy)
    };
    let mut bad = image.texels.iter().enumerate().filter(|(_, texel)| !texel.is_finite());
    if let Some((i, texel)) = bad.next() {
        return Err(wrong(i, texel, "not a finite number", 1 + bad.count()));
    }
    // In double precision, where no sum of them is infinite.
    let sum: f64 = image.texels.iter().map(|texel| f64::from(luminance(texel.max(Vec3::ZERO)))).sum();
    let disc = if projection == Projection::Angular { std::f64::consts::FRAC_PI_4 } else { 1.0 };
    let least = -f64::from(NEGLIGIBLE) * sum / (disc * image.texels.len().max(1) as f64);
    let mut bad = image.texels.iter().enumerate().filter(|(_, texel)| f64::from(texel.min_element()) < least);
    if let Some((i, texel)) = bad.next() {
        return Err(wrong(i, texel, "which is negative", 1 + bad.count()));
    }
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
        let radiance = |image: &mut Image, projection, clamp| to_radiance(image, projection, None, clamp);
        for bad in [f32::NAN, f32::INFINITY, -1.0] {
            let mut damaged = image(8, 4);
            damaged.texels[13].y = bad;
            damaged.texels[20].x = bad;
            let text = radiance(&mut damaged, Projection::LatLong, None).unwrap_err().to_string();
            for word in ["column 5, row 1", "and 1 others", "--clamp"] {
                assert!(text.contains(word), "{text}");
            }
            let notes = radiance(&mut damaged, Projection::LatLong, Some(9.0)).unwrap();
            assert_eq!(damaged.texels[13].y, if bad == f32::INFINITY { 9.0 } else { 0.0 });
            // Nine to thirty-two are larger, and the one that is damaged at 13 among them.
            assert!(
                notes[0].contains("23 texels") && damaged.texels.iter().all(|t| t.max_element() <= 9.0),
                "{notes:?}"
            );
        }
        let mut undershoot = image(8, 4);
        undershoot.texels[13].y = -0.05;
        assert!(radiance(&mut undershoot, Projection::LatLong, None).unwrap().is_empty());
        assert_eq!(undershoot.texels[13].y, 0.0);
        let mut captioned = image(4, 4);
        captioned.texels[15] = Vec3::NAN;
        assert!(radiance(&mut captioned, Projection::Angular, None).unwrap().is_empty());
        let mut huge = image(8, 4);
        huge.texels.fill(Vec3::splat(3e38));
        huge.texels[13].y = -1e37;
        assert!(radiance(&mut huge, Projection::LatLong, None).unwrap_err().problem.contains("negative"));
    }

    #[test]
    fn conversion_keeps_white_and_tells_what_no_screen_shows() {
        let matrix = DMat3::from_cols_array(&[1.5, -0.5, 0.0, -0.5, 1.5, 0.0, 0.0, 0.0, 1.0]);
        let convert = |texel: Vec3, clamp| {
            let mut one = image(2, 1);
            one.texels = vec![Vec3::ONE, texel];
            to_radiance(&mut one, Projection::LatLong, Some(matrix), clamp).map(|notes| (one.texels, notes.len()))
        };
        assert_eq!(convert(Vec3::splat(2.0), None).unwrap(), (vec![Vec3::ONE, Vec3::splat(2.0)], 0));
        assert_eq!(convert(Vec3::X, None).unwrap(), (vec![Vec3::ONE, Vec3::new(1.5, 0.0, 0.0)], 1));
        assert!(convert(Vec3::new(3e38, 0.0, 0.0), None).unwrap_err().problem.contains("finite"));
        assert_eq!(convert(Vec3::new(f32::INFINITY, 0.0, 0.0), Some(8.0)).unwrap().0[1], Vec3::new(8.0, 0.0, 0.0));
    }
}
