//! OpenEXR files as they are written here: one part, named layers.

use exr::prelude::{
    AnyChannel, AnyChannels, Encoding, FlatSamples, Image, Layer, LayerAttributes, Vec2, WritableImage,
};
use glam::Vec3;
use smallvec::SmallVec;
use std::io::Cursor;

/// An OpenEXR file of one part, `width` by `height` pixels: each layer's channels are `NAME.R`, `NAME.G`, `NAME.B`; a layer
/// without a name is the root, `R`, `G`, `B`. Pixels go row by row from the top. 32-bit floating point, lossless. Error if
/// there is no layer, or one doesn't have as many pixels.
pub fn exr_bytes([width, height]: [usize; 2], layers: &[(&str, &[Vec3])]) -> Result<Vec<u8>, String> {
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
    let layer = Layer::new(size, LayerAttributes::default(), Encoding::SMALL_LOSSLESS, channels);
    let mut bytes = Cursor::new(Vec::new());
    Image::from_layer(layer).write().to_buffered(&mut bytes).map_err(|error| error.to_string())?;
    Ok(bytes.into_inner())
}
