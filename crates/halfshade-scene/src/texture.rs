//! Pictures on surfaces: colours that multiply an albedo, looked up by texture coordinates.
//!
//! PNG and JPEG hold sRGB \[IEC61966-2-1\]; texels are decoded to linear values before anything is interpolated. Lookups
//! are at the full resolution, bilinear unless the nearest texel is asked for: there are no mipmaps. Alpha is read apart,
//! where it cuts holes into a surface. Colour profiles are ignored.

use crate::SceneError;
use glam::{DVec2, Vec3};
use image::{DynamicImage, ImageBuffer, ImageError, ImageFormat, ImageReader, Limits, Rgb};
use serde::Serialize;
use std::io::Cursor;
use std::path::Path;

/// The largest width or height read.
const LARGEST_SIDE: u32 = 16384;

/// Values beyond a texture's edge.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq, Serialize)]
pub enum Wrap {
    /// The texture again.
    #[default]
    Repeat,
    /// The texture mirrored, then again.
    Mirror,
    /// The texels of the edge.
    Clamp,
}

impl Wrap {
    /// The texel, of `size` in a row, that stands at place `index`.
    fn index(self, index: i64, size: usize) -> usize {
        let count = size as i64;
        let inside = match self {
            Self::Repeat => index.rem_euclid(count),
            Self::Mirror => {
                let place = index.rem_euclid(2 * count);
                place.min(2 * count - 1 - place)
            }
            Self::Clamp => index.clamp(0, count - 1),
        };
        inside as usize
    }
}

/// Values between the centres of texels.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq, Serialize)]
pub enum Filter {
    /// Values interpolated bilinearly.
    #[default]
    Linear,
    /// The value of the nearest texel.
    Nearest,
}

/// A picture of linear values in [0, 1].
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Texture {
    width: usize,
    height: usize,
    texels: Vec<Vec3>,
    wrap: [Wrap; 2],
    filter: Filter,
}

impl Texture {
    /// A texture of linear `texels`, row by row from the top, that repeats and is interpolated bilinearly.
    pub fn new(width: usize, height: usize, texels: Vec<Vec3>) -> Result<Self, SceneError> {
        if width == 0 || height == 0 || width.checked_mul(height) != Some(texels.len()) {
            return Err(SceneError::new(format!("a texture of {width}x{height} cannot have {} texels", texels.len())));
        }
        if texels.iter().any(|texel| !texel.to_array().iter().all(|x| (0.0..=1.0).contains(x))) {
            return Err(SceneError::new("a texture has texels outside of [0, 1]"));
        }
        Ok(Self { width, height, texels, wrap: [Wrap::Repeat; 2], filter: Filter::Linear })
    }

    /// The same texture with other surroundings: along a row, and along a column.
    pub fn wrapped(self, wrap: [Wrap; 2]) -> Self {
        Self { wrap, ..self }
    }

    /// The same texture with something else between its texels.
    pub fn filtered(self, filter: Filter) -> Self {
        Self { filter, ..self }
    }

    /// Columns.
    pub fn width(&self) -> usize {
        self.width
    }

    /// Rows.
    pub fn height(&self) -> usize {
        self.height
    }

    /// Linear values, row by row from the top.
    pub fn texels(&self) -> &[Vec3] {
        &self.texels
    }

    /// Values beyond the edge, along a row and along a column.
    pub fn wrap(&self) -> [Wrap; 2] {
        self.wrap
    }

    /// Values between the centres of texels.
    pub fn filter(&self) -> Filter {
        self.filter
    }

    /// Reads a PNG or JPEG file, told apart by content.
    pub fn load(path: &Path) -> Result<Self, SceneError> {
        let read = crate::input::read(path).map_err(|error| SceneError::new(format!("cannot be read: {error}")));
        read.and_then(|bytes| Self::decode(&bytes)).map_err(|error| error.in_file(path))
    }

    /// Decodes PNG or JPEG.
    pub fn decode(bytes: &[u8]) -> Result<Self, SceneError> {
        Self::from_image(image(bytes)?.into_rgb16())
    }

    /// Decodes PNG or JPEG: its colours and, unless it is 1 all over, its alpha, in all channels.
    pub fn decode_with_alpha(bytes: &[u8]) -> Result<(Self, Option<Self>), SceneError> {
        let image = image(bytes)?;
        let mut alpha = None;
        if image.color().has_alpha() {
            let list: Vec<u16> = image.to_rgba16().pixels().map(|pixel| pixel.0[3]).collect();
            if list.iter().any(|code| *code != u16::MAX) {
                let texels = list.into_iter().map(|code| Vec3::splat(f32::from(code) / 65535.0)).collect();
                alpha = Some(Self::new(image.width() as usize, image.height() as usize, texels)?);
            }
        }
        Ok((Self::from_image(image.into_rgb16())?, alpha))
    }

    /// A texture from sRGB values. 16 bits hold 8-bit ones exactly, as the same fraction of the maximum.
    fn from_image(image: ImageBuffer<Rgb<u16>, Vec<u16>>) -> Result<Self, SceneError> {
        let linear: Vec<f32> = (0..=u16::MAX).map(|code| linear_from_srgb(f64::from(code) / 65535.0) as f32).collect();
        let texels = image.pixels().map(|pixel| Vec3::from(pixel.0.map(|code| linear[usize::from(code)]))).collect();
        Self::new(image.width() as usize, image.height() as usize, texels)
    }

    /// The least and the largest value of the first channel.
    pub(crate) fn red_bounds(&self) -> [f32; 2] {
        let reds = || self.texels.iter().map(|texel| texel.x);
        [reds().fold(f32::INFINITY, f32::min), reds().fold(f32::NEG_INFINITY, f32::max)]
    }

    /// The value at a finite coordinate, between texel centres as the filter says: (0, 0) is the top left corner of the
    /// picture, (1, 1) the bottom right one.
    pub fn at(&self, coordinate: DVec2) -> Vec3 {
        let place = coordinate * DVec2::new(self.width as f64, self.height as f64);
        if self.filter == Filter::Nearest {
            let column = self.wrap[0].index(place.x.floor() as i64, self.width);
            let row = self.wrap[1].index(place.y.floor() as i64, self.height);
            return self.texels[row * self.width + column];
        }
        let place = place - 0.5;
        let first = place.floor();
        let part = (place - first).as_vec2();
        let pair = |first: f64, axis: usize, size: usize| {
            let first = first as i64;
            [first, first.saturating_add(1)].map(|index| self.wrap[axis].index(index, size))
        };
        let columns = pair(first.x, 0, self.width);
        let [above, below] = pair(first.y, 1, self.height)
            .map(|row| columns.map(|column| self.texels[row * self.width + column]))
            .map(|[left, right]| left.lerp(right, part.x));
        above.lerp(below, part.y)
    }
}

/// The pixels of a PNG or JPEG file, told apart by content.
fn image(bytes: &[u8]) -> Result<DynamicImage, SceneError> {
    let wrong = |error: ImageError| {
        SceneError::new(format!("the image cannot be decoded: {error}"))
            .with_remedy("it must be a whole PNG or JPEG file")
    };
    let format = match image::guess_format(bytes) {
        Ok(format @ (ImageFormat::Png | ImageFormat::Jpeg)) => format,
        other => {
            let found = match other {
                Ok(format) => format!(", but {format:?}"),
                Err(_) if bytes.starts_with(b"\xabKTX 20\xbb") => ", but KTX2".to_owned(),
                Err(_) => String::new(),
            };
            return Err(
                SceneError::new(format!("the image is neither PNG nor JPEG{found}")).with_remedy("convert it to PNG")
            );
        }
    };
    if format == ImageFormat::Jpeg && !jpeg_ends(bytes) {
        return Err(SceneError::new("the JPEG image was cut short").with_remedy("get the file again"));
    }
    let mut reader = ImageReader::with_format(Cursor::new(bytes), format);
    let mut limits = Limits::default();
    limits.max_image_width = Some(LARGEST_SIDE);
    limits.max_image_height = Some(LARGEST_SIDE);
    reader.limits(limits);
    reader.decode().map_err(wrong)
}

/// Whether the mark of the end follows the last scan: the decoder fills in grey for what is missing. Within a scan
/// neither mark occurs.
fn jpeg_ends(bytes: &[u8]) -> bool {
    let last = |mark: u8| bytes.windows(2).rposition(|pair| pair == [0xff, mark]);
    last(0xd9) > last(0xda)
}

/// Linear value of an sRGB value, both in [0, 1] \[IEC61966-2-1\].
pub(crate) fn linear_from_srgb(value: f64) -> f64 {
    if value <= 0.04045 { value / 12.92 } else { ((value + 0.055) / 1.055).powf(2.4) }
}

#[cfg(test)]
mod tests {
    use super::*;
    use image::{GrayImage, Luma, Rgba, RgbaImage};

    fn encoded(image: impl Into<DynamicImage>, format: ImageFormat) -> Vec<u8> {
        let mut bytes = Cursor::new(Vec::new());
        image.into().write_to(&mut bytes, format).unwrap();
        bytes.into_inner()
    }

    /// Two columns and two rows of greys.
    fn greys(wrap: [Wrap; 2]) -> Texture {
        let texels = [0.0, 0.4, 0.8, 1.0].map(Vec3::splat).to_vec();
        Texture::new(2, 2, texels).unwrap().wrapped(wrap)
    }

    #[test]
    fn between_texel_centres_values_are_bilinear() {
        let texture = greys([Wrap::Clamp; 2]);
        for (u, v, value) in [
            (0.25, 0.25, 0.0),
            (0.75, 0.25, 0.4),
            (0.25, 0.75, 0.8),
            (0.75, 0.75, 1.0),
            (0.5, 0.25, 0.2),
            (0.5, 0.5, 0.55),
            // A quarter of the way right, half of the way down: (3/4 (0 + 0.8) + 1/4 (0.4 + 1)) / 2.
            (0.375, 0.5, 0.475),
        ] {
            let found = texture.at(DVec2::new(u, v));
            assert!((found - Vec3::splat(value)).abs().max_element() < 1e-6, "{u} {v}: {found}");
        }
    }

    #[test]
    fn the_nearest_texel_ends_where_the_next_begins() {
        let texture = greys([Wrap::Repeat, Wrap::Clamp]).filtered(Filter::Nearest);
        for (u, v, value) in [
            (0.0, 0.0, 0.0),
            (0.49, 0.49, 0.0),
            (0.51, 0.2, 0.4),
            (0.49, 0.51, 0.8),
            (-0.01, 9.0, 1.0),
            (1.2, 0.9, 0.8),
        ] {
            assert_eq!(texture.at(DVec2::new(u, v)), Vec3::splat(value), "{u} {v}");
        }
        let value = texture.at(DVec2::new(f32::MAX.into(), f32::MIN.into()));
        assert!((0.0..=1.0).contains(&value.x), "{value}");
    }

    #[test]
    fn beyond_its_edge_a_texture_repeats_mirrors_or_stays() {
        let row = |wrap: Wrap| {
            let texture = greys([wrap, Wrap::Clamp]);
            // Texel centres from two texels left of the texture to two right of it, and one edge between centres.
            [-0.75, -0.25, 0.25, 0.75, 1.25, 1.75, 1.0].map(|u| texture.at(DVec2::new(u, 0.0)).x)
        };
        let close = |found: [f32; 7], expected: [f32; 7]| {
            assert!(found.iter().zip(expected).all(|(a, b)| (a - b).abs() < 1e-6), "{found:?} {expected:?}");
        };
        close(row(Wrap::Repeat), [0.0, 0.4, 0.0, 0.4, 0.0, 0.4, 0.2]);
        close(row(Wrap::Mirror), [0.4, 0.0, 0.0, 0.4, 0.4, 0.0, 0.4]);
        close(row(Wrap::Clamp), [0.0, 0.0, 0.0, 0.4, 0.4, 0.4, 0.4]);
        let column = greys([Wrap::Clamp, Wrap::Repeat]);
        assert_eq!(column.at(DVec2::new(0.0, 1.25)), column.at(DVec2::new(0.0, 0.25)));
        // Coordinates of any size are no reason to stop.
        for wrap in [Wrap::Repeat, Wrap::Mirror, Wrap::Clamp] {
            let value = greys([wrap; 2]).at(DVec2::new(f32::MAX.into(), f32::MIN.into()));
            assert!((0.0..=1.0).contains(&value.x), "{wrap:?}: {value}");
        }
    }

    #[test]
    fn eight_and_sixteen_bits_are_decoded_as_srgb() {
        let ramp = GrayImage::from_fn(256, 1, |x, _| Luma([x as u8]));
        let texture = Texture::decode(&encoded(ramp, ImageFormat::Png)).unwrap();
        for (code, texel) in texture.texels.iter().enumerate() {
            // The closed form, by its other branch rule: the pieces meet at 0.04045.
            let s = code as f64 / 255.0;
            let expected = if code <= 10 { s / 12.92 } else { (2.4 * ((s + 0.055) / 1.055).ln()).exp() };
            assert!((f64::from(texel.x) - expected).abs() < 1e-7 && texel.x == texel.z, "{code}: {texel}");
        }
        // sRGB 188 is half of white, within what a code resolves.
        assert!((texture.texels[188].x - 0.5).abs() < 0.005);
        let deep: ImageBuffer<Luma<u16>, Vec<u16>> = ImageBuffer::from_pixel(1, 1, Luma([128 * 257 + 100]));
        let deep = Texture::decode(&encoded(deep, ImageFormat::Png)).unwrap().texels[0].x;
        assert!(texture.texels[128].x < deep && deep < texture.texels[129].x);
    }

    #[test]
    fn colours_and_rows_keep_their_places_and_alpha_is_apart() {
        let mut image = RgbaImage::from_pixel(2, 3, Rgba([0, 0, 0, 9]));
        image.put_pixel(1, 2, Rgba([255, 0, 0, 0]));
        let bytes = encoded(image, ImageFormat::Png);
        let texture = Texture::decode(&bytes).unwrap();
        assert_eq!((texture.width, texture.height, texture.texels[5]), (2, 3, Vec3::X));
        assert_eq!(texture.at(DVec2::new(0.75, 2.5 / 3.0)), Vec3::X);
        let (color, alpha) = Texture::decode_with_alpha(&bytes).unwrap();
        let alpha = alpha.unwrap();
        assert_eq!((color, alpha.red_bounds()), (texture, [0.0, 9.0 / 255.0]));
        assert_eq!(alpha.at(DVec2::new(0.75, 2.5 / 3.0)), Vec3::ZERO);
        let opaque = encoded(RgbaImage::from_pixel(2, 3, Rgba([9, 9, 9, 255])), ImageFormat::Png);
        assert_eq!(Texture::decode_with_alpha(&opaque).unwrap().1, None);
        let flat = image::RgbImage::from_pixel(16, 16, image::Rgb([200, 100, 50]));
        let flat = Texture::decode(&encoded(flat, ImageFormat::Jpeg)).unwrap().at(DVec2::splat(0.5));
        let expected = [200.0, 100.0, 50.0].map(|code: f64| linear_from_srgb(code / 255.0) as f32);
        // JPEG rounds each code by a unit or two.
        assert!((flat - Vec3::from(expected)).abs().max_element() < 0.02, "{flat}");
    }

    #[test]
    fn images_cut_anywhere_are_refused() {
        let noise = image::RgbImage::from_fn(24, 24, |x, y| image::Rgb([(x * 37 + y * 91) as u8, (x * y) as u8, 7]));
        for format in [ImageFormat::Png, ImageFormat::Jpeg] {
            let bytes = encoded(noise.clone(), format);
            assert!(Texture::decode(&bytes).is_ok());
            // Without its last check sum a PNG still has all of its texels.
            for end in 0..bytes.len() - if format == ImageFormat::Png { 4 } else { 0 } {
                assert!(Texture::decode(&bytes[..end]).is_err(), "{format:?} cut at {end} of {}", bytes.len());
            }
        }
    }

    #[test]
    fn what_is_no_texture_is_refused() {
        let error = |result: Result<Texture, SceneError>| result.unwrap_err().to_string();
        assert!(error(Texture::new(0, 2, Vec::new())).contains("0x2"));
        assert!(error(Texture::new(2, 2, vec![Vec3::ONE; 3])).contains("3 texels"));
        assert!(error(Texture::new(1, 1, vec![Vec3::splat(f32::NAN)])).contains("[0, 1]"));
        assert!(error(Texture::decode(b"GIF89a")).contains("PNG"));
        // A PNG header that claims no columns, and one that claims too many.
        let mut png = encoded(GrayImage::new(1, 1), ImageFormat::Png);
        for width in [0, 1 << 20] {
            png[16..20].copy_from_slice(&u32::to_be_bytes(width));
            assert!(error(Texture::decode(&png)).contains("decoded"));
        }
        assert!(error(Texture::load(Path::new("no/such.png"))).starts_with("no/such.png: cannot be read"));
    }
}
