//! Radiance HDR and OpenEXR images, decoded to linear RGB.

use crate::SceneError;
use exr::prelude::{ReadChannels, ReadLayers, read};
use glam::Vec3;
use image::ImageDecoder;
use std::io::Cursor;

/// The largest width or height read: 16k by 8k is the largest probe in circulation.
const LARGEST_SIDE: usize = 16384;

/// Linear RGB, row by row from the top. Values as stored, unchecked.
#[derive(Debug, Clone)]
pub(super) struct Image {
    pub(super) width: usize,
    pub(super) height: usize,
    pub(super) texels: Vec<Vec3>,
}

/// Refuses sizes that no file of this length holds, before memory is asked for.
fn check_size(width: usize, height: usize, bytes: usize, texels_per_byte: usize) -> Result<(), SceneError> {
    if width == 0 || height == 0 {
        return Err(SceneError::new(format!("the image is empty: {width}x{height}")));
    }
    if width > LARGEST_SIDE || height > LARGEST_SIDE {
        return Err(SceneError::new(format!("the image is {width}x{height}; at most {LARGEST_SIDE} are read"))
            .with_remedy("reduce it: 2048x1024 resolves all but a sun"));
    }
    if width * height / texels_per_byte > bytes {
        return Err(SceneError::new(format!("the image claims to be {width}x{height}, too much for {bytes} bytes"))
            .with_remedy("the file was cut short or damaged: get it again"));
    }
    Ok(())
}

/// Radiance HDR (RGBE). EXPOSURE and COLORCORR say by what the picture was multiplied; both are divided out, so that the
/// result is radiance (\[Ward1991\]).
pub(super) fn decode_hdr(bytes: &[u8]) -> Result<Image, SceneError> {
    if !bytes.starts_with(b"#?") {
        return Err(SceneError::new("this is no Radiance HDR file: it doesn't begin with `#?`"));
    }
    let wrong = |error: image::ImageError| SceneError::new(format!("cannot be decoded: {error}"));
    // Not strict: `#?RGBE` is as common a first line as `#?RADIANCE`.
    let decoder = image::codecs::hdr::HdrDecoder::new_nonstrict(Cursor::new(bytes)).map_err(wrong)?;
    let metadata = decoder.metadata();
    if let Some((_, format)) = metadata.custom_attributes.iter().find(|(key, _)| key == "FORMAT")
        && format.trim() != "32-bit_rle_rgbe"
    {
        return Err(SceneError::new(format!("the pixel format `{}` is not supported", format.trim()))
            .with_remedy("convert it to 32-bit_rle_rgbe"));
    }
    let (width, height) = (metadata.width as usize, metadata.height as usize);
    // A run of the old encoding repeats a pixel 255 times in 4 bytes.
    check_size(width, height, bytes.len(), 64)?;
    let (r, g, b) = metadata.color_correction.unwrap_or((1.0, 1.0, 1.0));
    let applied = metadata.exposure.unwrap_or(1.0) * Vec3::new(r, g, b);
    if !(applied.is_finite() && applied.min_element() > 0.0) {
        return Err(SceneError::new(format!("EXPOSURE times COLORCORR is {applied}, which is not positive")));
    }
    let mut data = vec![0_u8; width * height * 12];
    decoder.read_image(&mut data).map_err(wrong)?;
    let number = |b: &[u8]| f32::from_ne_bytes([b[0], b[1], b[2], b[3]]);
    let texel = |b: &[u8]| Vec3::new(number(b), number(&b[4..]), number(&b[8..])) / applied;
    Ok(Image { width, height, texels: data.chunks_exact(12).map(texel).collect() })
}

/// OpenEXR: R, G, B or Y of the first layer that has them, at full resolution.
pub(super) fn decode_exr(bytes: &[u8]) -> Result<Image, SceneError> {
    let wrong = |error: exr::error::Error| SceneError::new(format!("cannot be decoded: {error}"));
    let meta = exr::meta::MetaData::read_from_buffered(Cursor::new(bytes), false).map_err(wrong)?;
    for header in &meta.headers {
        // Constant images deflate about a thousandfold, and samples may be half a texel's size.
        check_size(header.layer_size.width(), header.layer_size.height(), bytes.len(), 4096)?;
        if header.deep {
            return Err(SceneError::new("the image is deep, which is not supported").with_remedy("flatten it"));
        }
    }
    let image = read()
        .no_deep_data()
        .largest_resolution_level()
        .all_channels()
        .all_layers()
        .all_attributes()
        .non_parallel()
        .from_buffered(Cursor::new(bytes))
        .map_err(wrong)?;
    for layer in &image.layer_data {
        let channel = |name: &str| {
            let found = layer.channel_data.list.iter().find(|c| c.name.to_string().eq_ignore_ascii_case(name))?;
            Some(found.sample_data.values_as_f32().collect::<Vec<f32>>())
        };
        let planes = match (channel("R"), channel("G"), channel("B"), channel("Y")) {
            (Some(r), Some(g), Some(b), _) => [r, g, b],
            (_, _, _, Some(y)) => [y.clone(), y.clone(), y],
            _ => continue,
        };
        let (width, height) = (layer.size.width(), layer.size.height());
        if planes.iter().any(|plane| plane.len() != width * height) {
            return Err(SceneError::new("the channels R, G, B differ in resolution").with_remedy("resample them"));
        }
        let texels = (0..width * height).map(|i| Vec3::new(planes[0][i], planes[1][i], planes[2][i])).collect();
        return Ok(Image { width, height, texels });
    }
    Err(SceneError::new("no layer has the channels R, G and B (or Y)"))
}

#[cfg(test)]
mod tests {
    use super::*;

    fn flat_hdr(header: &str) -> Vec<u8> {
        let mut bytes = format!("{header}\n\n-Y 1 +X 2\n").into_bytes();
        bytes.extend([128, 64, 32, 129, 128, 0, 0, 128]);
        bytes
    }

    #[test]
    fn exposure_and_colour_correction_are_divided_out() {
        let plain = decode_hdr(&flat_hdr("#?RGBE\nFORMAT=32-bit_rle_rgbe")).unwrap();
        assert_eq!(plain.texels, [Vec3::new(1.0, 0.5, 0.25), Vec3::new(0.5, 0.0, 0.0)]);
        let exposed = decode_hdr(&flat_hdr("#?RADIANCE\nEXPOSURE=2\nEXPOSURE=4\nCOLORCORR=1 2 0.5")).unwrap();
        assert_eq!(exposed.texels[0], Vec3::new(0.125, 0.03125, 0.0625));
        assert!(decode_hdr(&flat_hdr("#?RADIANCE\nEXPOSURE=0")).is_err());
        assert!(decode_hdr(&flat_hdr("#?RADIANCE\nFORMAT=32-bit_rle_xyze")).is_err());
    }

    #[test]
    fn a_claimed_size_is_not_believed() {
        let bytes = b"#?RADIANCE\n\n-Y 16000 +X 16000\n12345678";
        assert!(decode_hdr(bytes).unwrap_err().problem.contains("too much"));
        assert!(decode_hdr(b"#?RADIANCE\n\n-Y 2000000 +X 4000000\n").unwrap_err().problem.contains("at most"));
        assert!(decode_hdr(b"#?RADIANCE\n\n-Y 0 +X 0\n").unwrap_err().problem.contains("empty"));
    }
}
