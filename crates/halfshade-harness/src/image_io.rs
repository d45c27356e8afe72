//! Pictures on disk: OpenEXR with named layers, and PNG to look at.

use crate::{HarnessError, output::write_atomically};
use glam::Vec3;
use halfshade_scene::{ExrFacts, exr_bytes as exr_file_bytes};
use std::{io::Cursor, path::Path};

/// Linear radiance on a grid of pixels; row 0 is the top.
#[derive(Debug, Clone, PartialEq)]
pub struct Picture {
    /// Columns.
    pub width: usize,
    /// Rows.
    pub height: usize,
    /// Row by row from the top.
    pub pixels: Vec<Vec3>,
}

impl Picture {
    /// A picture of one colour.
    pub fn filled(width: usize, height: usize, color: Vec3) -> Self {
        Self { width, height, pixels: vec![color; width * height] }
    }

    /// `self` − `other`, pixel by pixel.
    pub fn minus(&self, other: &Self) -> Self {
        let largest = Vec3::splat(f32::MAX);
        let difference = |(a, b): (&Vec3, &Vec3)| (*a - *b).clamp(-largest, largest);
        Self { pixels: self.pixels.iter().zip(&other.pixels).map(difference).collect(), ..*self }
    }

    /// `factor` times the size of each pixel's difference to `other`.
    pub fn magnified_difference(&self, other: &Self, factor: f32) -> Self {
        let mut difference = self.minus(other);
        difference.pixels.iter_mut().for_each(|pixel| *pixel = (factor * pixel.abs()).min(Vec3::splat(f32::MAX)));
        difference
    }

    /// The picture as people see it: times `exposure`, sRGB transfer, 8 bits.
    pub fn to_srgb(&self, exposure: f32) -> image::RgbImage {
        image::RgbImage::from_fn(self.width as u32, self.height as u32, |x, y| {
            let pixel = self.pixels[y as usize * self.width + x as usize] * exposure;
            image::Rgb(pixel.to_array().map(|value| (srgb(value) * 255.0 + 0.5) as u8))
        })
    }

    /// The exposure that shows the 98th percentile of the lit pixels' largest channel at 0.9 of white.
    pub fn exposure(&self) -> f32 {
        let mut lit: Vec<f64> =
            self.pixels.iter().map(|p| f64::from(p.max_element())).filter(|v| *v > 0.0 && v.is_finite()).collect();
        lit.sort_by(f64::total_cmp);
        crate::statistics::percentile(&lit, 0.98).map_or(1.0, |value| (0.9 / value).min(f64::from(f32::MAX)) as f32)
    }
}

/// The transfer function of sRGB (IEC 61966-2-1), of linear light clamped to [0, 1].
pub fn srgb(linear: f32) -> f32 {
    let linear = if linear.is_nan() { 0.0 } else { linear.clamp(0.0, 1.0) };
    if linear <= 0.003_130_8 { 12.92 * linear } else { 1.055 * linear.powf(1.0 / 2.4) - 0.055 }
}

/// Origin of a picture, which its file tells where the format can.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Origin<'a> {
    /// Name and version of the program.
    pub program: &'a str,
    /// Name of the scene.
    pub scene: &'a str,
    /// Frame of its animation.
    pub frame: usize,
    /// Method, with the parameters that were set.
    pub strategy: &'a str,
    /// Samples of the truth per receiver, where there is one.
    pub truth_samples: Option<usize>,
}

impl Origin<'_> {
    /// Lines of `key: value`.
    fn lines(&self) -> String {
        let Self { scene, frame, strategy, truth_samples, .. } = self;
        let samples = truth_samples.map_or_else(String::new, |samples| format!("truth samples: {samples}\n"));
        format!(
            "scene: {scene}\nframe: {frame}\nstrategy: {strategy}\n{samples}units: outgoing radiance, linear and scene-referred, \
             Rec. 709 primaries"
        )
    }
}

/// An OpenEXR file of one part: each layer's channels are `NAME.R`, `NAME.G`, `NAME.B`; a layer without a name is the
/// root, `R`, `G`, `B`. 32-bit floating point, lossless. The attributes `software`, `comments` and `chromaticities` tell the origin.
pub fn exr_bytes(layers: &[(&str, &Picture)], origin: &Origin<'_>) -> Result<Vec<u8>, String> {
    let (_, first) = layers.first().ok_or("a picture needs a layer")?;
    let layers: Vec<(&str, &[Vec3])> = layers.iter().map(|(name, picture)| (*name, &picture.pixels[..])).collect();
    let facts = ExrFacts { software: &format!("halfshade {}", origin.program), comments: &origin.lines() };
    exr_file_bytes([first.width, first.height], &layers, facts)
}

/// A PNG file.
pub fn png_bytes(image: &image::RgbImage) -> Result<Vec<u8>, String> {
    let mut bytes = Cursor::new(Vec::new());
    image.write_to(&mut bytes, image::ImageFormat::Png).map_err(|error| error.to_string())?;
    Ok(bytes.into_inner())
}

/// Whether `path` ends in a picture format that can be written.
pub fn check_extension(path: &Path) -> Result<(), HarnessError> {
    match extension(path).as_deref() {
        Some("exr" | "png") => Ok(()),
        _ => Err(HarnessError::in_file(path, "pictures are written as .exr or .png: choose one by the file's ending")),
    }
}

/// Writes layers to `.exr`, or the first layer, exposed, to `.png`.
pub fn write_picture(
    path: &Path,
    layers: &[(&str, &Picture)],
    exposure: f32,
    origin: &Origin<'_>,
) -> Result<(), HarnessError> {
    check_extension(path)?;
    let bytes = match (extension(path).as_deref(), layers.first()) {
        (Some("png"), Some((_, picture))) => png_bytes(&picture.to_srgb(exposure)),
        _ => exr_bytes(layers, origin),
    };
    write_atomically(path, &bytes.map_err(|problem| HarnessError::in_file(path, problem))?)
}

fn extension(path: &Path) -> Option<String> {
    path.extension().map(|extension| extension.to_string_lossy().to_lowercase())
}

#[cfg(test)]
mod tests {
    use super::*;
    use exr::prelude::{ReadChannels, ReadLayers};

    const ORIGIN: Origin<'static> =
        Origin { program: "1.0", scene: "Küche", frame: 7, strategy: "dim:factor=2", truth_samples: Some(64) };

    fn gradient() -> Picture {
        let pixels = (0..6).map(|i| Vec3::new(i as f32, 0.5, -0.25 * i as f32)).collect();
        Picture { width: 3, height: 2, pixels }
    }

    #[test]
    fn exr_layers_read_back_to_the_bit_and_rewrite_the_same() {
        let picture = gradient();
        let error = picture.minus(&Picture::filled(3, 2, Vec3::ONE));
        let layers = [("", &picture), ("error", &error)];
        let bytes = exr_bytes(&layers, &ORIGIN).unwrap();
        assert_eq!(bytes, exr_bytes(&layers, &ORIGIN).unwrap());
        let read = exr::prelude::read()
            .no_deep_data()
            .largest_resolution_level()
            .all_channels()
            .first_valid_layer()
            .all_attributes()
            .from_buffered(Cursor::new(bytes))
            .unwrap();
        let attributes = &read.layer_data.attributes;
        assert_eq!(attributes.software_name.as_ref().map(ToString::to_string).as_deref(), Some("halfshade 1.0"));
        let comments = attributes.comments.as_ref().map(ToString::to_string).unwrap();
        let expected = "scene: K?che\nframe: 7\nstrategy: dim:factor=2\ntruth samples: 64\nunits: outgoing radiance, ";
        assert!(comments.starts_with(expected), "{comments}");
        // White of Rec. 709.
        let white = read.attributes.chromaticities.unwrap().white;
        assert_eq!([white.x(), white.y()], [0.3127, 0.329]);
        let channels = &read.layer_data.channel_data.list;
        let names: Vec<String> = channels.iter().map(|channel| channel.name.to_string()).collect();
        assert_eq!(names, ["B", "G", "R", "error.B", "error.G", "error.R"]);
        let values: Vec<f32> = channels[5].sample_data.values_as_f32().collect();
        assert_eq!(values, [-1.0, 0.0, 1.0, 2.0, 3.0, 4.0]);
    }

    #[test]
    fn srgb_at_known_points() {
        assert_eq!((srgb(-1.0), srgb(0.0), srgb(f32::NAN)), (0.0, 0.0, 0.0));
        assert!((srgb(7.0) - 1.0).abs() < 1e-6);
        // 18 % grey is 46 % of the signal.
        assert!((srgb(0.18) - 0.4613).abs() < 1e-4);
    }

    #[test]
    fn exposure_brings_the_bright_pixels_near_white() {
        let mut picture = Picture::filled(10, 10, Vec3::splat(2.0));
        picture.pixels[0] = Vec3::splat(1e6);
        assert!((picture.exposure() - 0.45).abs() < 1e-6);
        assert_eq!(Picture::filled(2, 2, Vec3::ZERO).exposure(), 1.0);
    }

    #[test]
    fn pictures_stay_finite_at_the_extremes() {
        let (dim, bright) = (Picture::filled(2, 2, Vec3::splat(1e-42)), Picture::filled(2, 2, Vec3::splat(3e38)));
        assert!(dim.exposure().is_finite() && bright.exposure() > 0.0);
        assert!((f32::from(bright.to_srgb(bright.exposure()).get_pixel(0, 0).0[0]) - 243.0).abs() < 2.0);
        let negative = Picture::filled(2, 2, Vec3::splat(-3e38));
        for picture in [bright.minus(&negative), negative.minus(&bright), bright.magnified_difference(&dim, 10.0)] {
            assert!(picture.pixels.iter().all(|pixel| pixel.is_finite()));
        }
    }

    #[test]
    fn other_endings_are_refused() {
        let error = write_picture(Path::new("a.jpg"), &[], 1.0, &ORIGIN).unwrap_err().to_string();
        assert!(error.contains(".exr or .png"), "{error}");
    }
}
