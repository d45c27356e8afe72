//! OpenEXR: one layer's light, in the display window.
//!
//! Blocks of that layer alone are decompressed, one at a time, and of several resolutions the largest. Alpha is left out:
//! colours are premultiplied by it, as the format demands, and light that comes through is not in the file.

use super::caught::caught;
use super::decoded::{Decoded, Image, TEXELS_PER_BYTE, check_size, cut_short};
use super::exr_layers::{Kind, Layer, choose};
use super::primaries::Primaries;
use crate::SceneError;
use exr::block::UncompressedBlock;
use exr::block::reader::ChunksReader;
use exr::error::Error;
use exr::math::Vec2;
use exr::meta::attribute::{ChannelDescription, Chromaticities, SampleType};
use exr::meta::header::Header;
use exr::meta::{BlockDescription, MetaData};
use exr::prelude::f16;
use glam::{DVec3, Vec3};
use std::collections::BTreeSet;
use std::io::Cursor;

/// Bytes that a block may decompress to: 256 lines of the widest picture with a dozen channels.
const LARGEST_BLOCK: usize = 256 << 20;

/// Decodes the light of the layer called `wanted`, or of the one that needs no name.
///
/// The picture is the display window: where the data window doesn't reach it is black, and what hangs over is cut off.
pub(super) fn decode(bytes: &[u8], wanted: Option<&str>) -> Result<Decoded, SceneError> {
    // On some damage the crate panics, as on a compressed block that ends early.
    caught(|| decode_sound(bytes, wanted)).unwrap_or_else(|| {
        Err(SceneError::new("cannot be decoded: its data are damaged").with_remedy("get it again, or write it again"))
    })
}

fn decode_sound(bytes: &[u8], wanted: Option<&str>) -> Result<Decoded, SceneError> {
    let meta = MetaData::read_from_buffered(Cursor::new(bytes), false).map_err(wrong)?;
    check(&meta.headers, bytes.len())?;
    let (layer, notes) = choose(&meta.headers, wanted)?;
    let header = &meta.headers[layer.part];
    let channels = layer.channels.map(|place| &header.channels.list[place]);
    for channel in channels {
        if channel.sample_type == SampleType::U32 {
            let problem = format!("channel {} holds whole numbers, which count or name things", channel.name);
            return Err(SceneError::new(problem).with_remedy("save it as half or float"));
        }
    }
    // The crate takes every channel of a block for as large as the block.
    if let Some(channel) = header.channels.list.iter().find(|channel| channel.sampling != Vec2(1, 1)) {
        let Vec2(x, y) = channel.sampling;
        let problem = format!("channel {} has a sample for {x} x {y} pixels only, which is not read", channel.name);
        return Err(SceneError::new(problem).with_remedy("save it as R, G and B at full resolution"));
    }
    let primaries = header.shared_attributes.chromaticities.map_or(Primaries::REC709, primaries_of);
    let mut picture = Picture::new(header, &layer);
    let reader = exr::block::read(Cursor::new(bytes), false).map_err(wrong)?;
    reader
        .filter_chunks(false, |_, _, block| block.layer == layer.part && block.level == Vec2(0, 0))
        .and_then(|chunks| {
            chunks.decompress_sequential(false, |_, block| {
                // Where a block belongs it says itself; where it was looked for, another table does.
                if block.index.layer != layer.part || block.index.level != Vec2(0, 0) {
                    return Err(Error::Invalid("block of another layer or resolution".into()));
                }
                picture.insert(&block);
                Ok(())
            })
        })
        .map_err(wrong)?;
    if picture.covered != header.layer_size.area() {
        return Err(SceneError::new("some of its blocks are missing").with_remedy("write it again"));
    }
    let Picture { mut image, .. } = picture;
    if layer.kind == Kind::LuminanceChroma {
        from_chroma(&mut image.texels, primaries.luminance_weights()?);
    }
    Ok(Decoded { image, to_rec709: primaries.to_rec709()?, notes })
}

/// Refuses what can't be read, and sizes that are not believed, before memory is asked for.
fn check(headers: &[Header], bytes: usize) -> Result<(), SceneError> {
    for header in headers {
        if header.deep {
            return Err(SceneError::new("the image is deep, which is not supported").with_remedy("flatten it"));
        }
        for size in [header.layer_size, header.shared_attributes.display_window.size] {
            check_size(size.width(), size.height(), bytes)?;
        }
        // Each block takes at least its place in the file.
        if header.chunk_count > bytes / 8 {
            return Err(SceneError::new(format!("{} blocks are too many for {bytes} bytes", header.chunk_count))
                .with_remedy("the file was cut short or damaged: get it again"));
        }
        let Vec2(width, height) = match header.blocks {
            BlockDescription::Tiles(tiles) => tiles.tile_size,
            BlockDescription::ScanLines => Vec2(header.layer_size.width(), header.compression.scan_lines_per_block()),
        };
        let block = header.channels.bytes_per_pixel.saturating_mul(width).saturating_mul(height);
        if block > LARGEST_BLOCK || width.saturating_mul(height) / TEXELS_PER_BYTE > bytes {
            let problem = format!("blocks of {width}x{height} with {} channels", header.channels.list.len());
            return Err(SceneError::new(format!("{problem} are more than is read of {bytes} bytes"))
                .with_remedy("save it with R, G and B alone, in smaller tiles"));
        }
    }
    Ok(())
}

/// The picture in the making.
struct Picture {
    image: Image,
    /// Column and row in the picture of the data window's first pixel.
    origin: [i64; 2],
    /// Bytes of all channels of a pixel.
    bytes_per_pixel: usize,
    /// By colour: bytes of the channels before its own, and its type.
    channels: [(usize, SampleType); 3],
    /// Places of blocks that were inserted, and how many pixels they have.
    inserted: BTreeSet<(usize, usize)>,
    covered: usize,
}

impl Picture {
    fn new(header: &Header, layer: &Layer) -> Self {
        let window = header.shared_attributes.display_window;
        let (width, height) = (window.size.width(), window.size.height());
        let offset = |data: i32, display: i32| i64::from(data) - i64::from(display);
        let position = header.own_attributes.layer_position;
        let size = |channel: &ChannelDescription| channel.sample_type.bytes_per_sample();
        let channels = layer.channels.map(|place| {
            (header.channels.list[..place].iter().map(size).sum(), header.channels.list[place].sample_type)
        });
        Self {
            image: Image { width, height, texels: vec![Vec3::ZERO; width * height] },
            origin: [offset(position.x(), window.position.x()), offset(position.y(), window.position.y())],
            bytes_per_pixel: header.channels.list.iter().map(size).sum(),
            channels,
            inserted: BTreeSet::new(),
            covered: 0,
        }
    }

    /// Puts a block where it belongs. Its lines follow each other, and in each line the channels.
    fn insert(&mut self, block: &UncompressedBlock) {
        let Vec2(x, y) = block.index.pixel_position;
        let Vec2(width, height) = block.index.pixel_size;
        if self.inserted.insert((x, y)) {
            self.covered += width * height;
        }
        let left = self.origin[0] + x as i64;
        // Columns of the block that lie in the picture.
        let first = (-left).clamp(0, width as i64) as usize;
        let last = (self.image.width as i64 - left).clamp(first as i64, width as i64) as usize;
        for (line, bytes) in block.data.chunks_exact((self.bytes_per_pixel * width).max(1)).enumerate() {
            let row = self.origin[1] + (y + line) as i64;
            if first == last || !(0..self.image.height as i64).contains(&row) {
                continue;
            }
            let start = row as usize * self.image.width + (left + first as i64) as usize;
            let texels = &mut self.image.texels[start..start + last - first];
            for (color, &(before, sample_type)) in self.channels.iter().enumerate() {
                let samples = &bytes[before * width..];
                match sample_type {
                    SampleType::F16 => {
                        let (samples, _) = samples[2 * first..2 * last].as_chunks::<2>();
                        for (texel, sample) in texels.iter_mut().zip(samples) {
                            texel[color] = f16::from_ne_bytes(*sample).to_f32();
                        }
                    }
                    _ => {
                        let (samples, _) = samples[4 * first..4 * last].as_chunks::<4>();
                        for (texel, sample) in texels.iter_mut().zip(samples) {
                            texel[color] = f32::from_ne_bytes(*sample);
                        }
                    }
                }
            }
        }
    }
}

/// From luminance Y and chroma (R − Y)/Y and (B − Y)/Y to R, G, B, Y being what `weights` make of them.
fn from_chroma(texels: &mut [Vec3], weights: DVec3) {
    for texel in texels {
        let [y, ry, by] = texel.as_dvec3().to_array();
        let (red, blue) = ((ry + 1.0) * y, (by + 1.0) * y);
        *texel = DVec3::new(red, (y - weights.x * red - weights.z * blue) / weights.y, blue).as_vec3();
    }
}

fn primaries_of(chromaticities: Chromaticities) -> Primaries {
    let Chromaticities { red, green, blue, white } = chromaticities;
    Primaries::read([red.x(), red.y(), green.x(), green.y(), blue.x(), blue.y(), white.x(), white.y()])
}

fn wrong(error: Error) -> SceneError {
    match error {
        // As the crate calls the end of a file.
        Error::Invalid(problem) if problem.contains("missing bytes") => cut_short(),
        Error::NotSupported(what) => SceneError::new(format!("cannot be decoded: {what}"))
            .with_remedy("save it with another compression, such as ZIP, and without deep data"),
        error => SceneError::new(format!("cannot be decoded: {error}")).with_remedy("get it again, or write it again"),
    }
}
