//! OpenEXR files as they are written here: one part, named layers.

use exr::{
    meta::attribute::{Chromaticities, Text},
    prelude::{AnyChannel, AnyChannels, Encoding, FlatSamples, Image, Layer, LayerAttributes, Vec2, WritableImage},
};
use glam::Vec3;
use smallvec::SmallVec;
use std::io::Cursor;

/// Facts that a file tells of itself; what is empty isn't told.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub struct ExrFacts<'a> {
    /// Attribute `software`: what wrote it.
    pub software: &'a str,
    /// Attribute `comments`.
    pub comments: &'a str,
}

/// Primaries and white of Rec. 709.
const REC_709: Chromaticities =
    Chromaticities { red: Vec2(0.64, 0.33), green: Vec2(0.3, 0.6), blue: Vec2(0.15, 0.06), white: Vec2(0.3127, 0.329) };

/// A text that OpenEXR can hold; what it can't becomes a question mark.
fn exr_text(text: &str) -> Option<Text> {
    let text: String = text.chars().map(|c| if c.is_ascii() { c } else { '?' }).collect();
    Text::new_or_none(text).filter(|text| !text.as_slice().is_empty())
}

/// An OpenEXR file of one part, `width` by `height` pixels: each layer's channels are `NAME.R`, `NAME.G`, `NAME.B`; a layer
/// without a name is the root, `R`, `G`, `B`. Pixels go row by row from the top. 32-bit floating point, lossless, with the
/// primaries of Rec. 709. Error if there is no layer, or one doesn't have as many pixels.
pub fn exr_bytes(
    [width, height]: [usize; 2],
    layers: &[(&str, &[Vec3])],
    facts: ExrFacts<'_>,
) -> Result<Vec<u8>, String> {
    if layers.is_empty() || layers.iter().any(|(_, pixels)| pixels.len() != width * height) {
        return Err(format!("a picture needs a layer, and each {width}x{height} pixels"));
    }
    let mut channels = SmallVec::new();
    for (name, pixels) in layers {
        for (c, letter) in ["R", "G", "B"].into_iter().enumerate() {
            let name = if name.is_empty() { letter.to_owned() } else { format!("{name}.{letter}") };
            let samples = pixels.iter().map(|pixel| pixel[c]).collect();
            channels.push(AnyChannel::new(name.as_str(), FlatSamples::F32(samples)));
        }
    }
    let (size, channels) = (Vec2(width, height), AnyChannels::sort(channels));
    let attributes = LayerAttributes {
        software_name: exr_text(facts.software),
        comments: exr_text(facts.comments),
        ..LayerAttributes::default()
    };
    let mut bytes = Cursor::new(Vec::new());
    let mut image = Image::from_layer(Layer::new(size, attributes, Encoding::SMALL_LOSSLESS, channels));
    image.attributes.chromaticities = Some(REC_709);
    image.write().to_buffered(&mut bytes).map_err(|error| error.to_string())?;
    Ok(bytes.into_inner())
}
