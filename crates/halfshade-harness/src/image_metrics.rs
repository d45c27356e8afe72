//! Similarity of pictures as people would judge them, on the exposed 8-bit sRGB pictures.
//!
//! SSIM \[Wang2004\] by our own `ssim.rs`: 1 is identical; not defined for pictures of fewer than 11 pixels either way. FLIP
//! through the crate nv-flip (\[Andersson2020\], at its default distance of 67 pixels per degree), the mean over pixels; 0
//! is identical. That crate wraps C++: it is there with the feature `flip` only.

use crate::{image_io::Picture, ssim::structural_similarity};
use serde::{Deserialize, Serialize};

/// How like the truth a picture looks; nothing where it isn't defined or wasn't computed.
#[derive(Debug, Clone, Copy, PartialEq, Default, Serialize, Deserialize)]
pub struct Similarity {
    /// Mean FLIP error, from 0 (identical) to 1; computed with the feature `flip` only.
    pub flip: Option<f64>,
    /// Mean structural similarity, from -1 to 1 (identical); nothing for pictures smaller than its window.
    pub ssim: Option<f64>,
}

/// FLIP's error of each pixel in the colours of its authors, `magma`: black is none, light yellow 1.
pub type FlipMap = image::RgbImage;

impl Similarity {
    /// Compares two pictures shown with the same exposure; with the feature `flip`, a map of it goes with them. Those of
    /// different sizes compare to nothing.
    pub fn between(picture: &Picture, truth: &Picture, exposure: f32) -> (Self, Option<FlipMap>) {
        let (shown, expected) = (picture.to_srgb(exposure), truth.to_srgb(exposure));
        if shown.dimensions() != expected.dimensions() {
            return Default::default();
        }
        let (flip, map) = flip(&shown, &expected).unzip();
        (Self { flip, ssim: structural_similarity(&shown, &expected) }, map)
    }
}

#[cfg(feature = "flip")]
fn flip(shown: &image::RgbImage, expected: &image::RgbImage) -> Option<(f64, FlipMap)> {
    let (width, height) = shown.dimensions();
    let [shown, expected] = [shown, expected].map(|picture| nv_flip::FlipImageRgb8::with_data(width, height, picture));
    let errors = nv_flip::flip(expected, shown, nv_flip::DEFAULT_PIXELS_PER_DEGREE);
    let mean = f64::from(nv_flip::FlipPool::from_image(&errors).mean());
    let map = FlipMap::from_raw(width, height, errors.apply_color_lut(&nv_flip::magma_lut()).to_vec())?;
    mean.is_finite().then_some((mean, map))
}

#[cfg(not(feature = "flip"))]
fn flip(_: &image::RgbImage, _: &image::RgbImage) -> Option<(f64, FlipMap)> {
    None
}
