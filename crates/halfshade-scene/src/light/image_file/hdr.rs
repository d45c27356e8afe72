//! Radiance HDR: the header, and from scanlines in any of eight orders to rows from the top \[Ward1991\].

use super::decoded::{Decoded, Image, check_size};
use super::primaries::Primaries;
use super::rgbe::Scanlines;
use crate::SceneError;
use glam::Vec3;

/// Contents of the header.
struct Header {
    /// By what the picture was multiplied.
    applied: Vec3,
    primaries: Primaries,
    resolution: Resolution,
}

/// The resolution line: how scanlines lie in the picture.
#[derive(Debug, Clone, Copy, PartialEq)]
struct Resolution {
    /// Whether scanlines are rows; else columns.
    is_by_row: bool,
    /// Number of scanlines, and of pixels of each.
    scanlines: usize,
    pixels: usize,
    /// Whether the first scanline, and the first pixel of each, is at the picture's top or left.
    from_start: [bool; 2],
}

/// Decodes a Radiance HDR picture. EXPOSURE and COLORCORR say by what it was multiplied, each as often as it appears; all
/// are divided out, so that the result is radiance.
///
/// The crate `image` reads one order of eight, and no XYZE.
pub(super) fn decode(bytes: &[u8]) -> Result<Decoded, SceneError> {
    let (header, data) = Header::parse(bytes)?;
    let Resolution { scanlines, pixels, .. } = header.resolution;
    let (width, height) = header.resolution.size();
    check_size(width, height, bytes.len())?;
    let mut lines = Scanlines::new(data, pixels);
    // More only as the file turns out to hold it.
    let mut texels = Vec::with_capacity((scanlines * pixels).min(16 * data.len()));
    for _ in 0..scanlines {
        lines.append_next(&mut texels)?;
    }
    if header.applied != Vec3::ONE {
        texels.iter_mut().for_each(|texel| *texel /= header.applied);
    }
    let image = Image { width, height, texels: header.resolution.in_order(texels) };
    Ok(Decoded { image, to_rec709: header.primaries.to_rec709()?, notes: Vec::new() })
}

impl Header {
    /// The header, and what follows it.
    fn parse(bytes: &[u8]) -> Result<(Self, &[u8]), SceneError> {
        let (mut exposure, mut correction) = (1.0f32, Vec3::ONE);
        let (mut rgb, mut is_xyz) = (Primaries::REC709, false);
        let mut is_over = false;
        let mut rest = bytes;
        while let Some(end) = rest.iter().position(|&byte| byte == b'\n') {
            let (raw, after) = (&rest[..end], &rest[end + 1..]);
            let line = String::from_utf8_lossy(raw);
            let line = line.trim_end();
            // Programs that make a picture of others keep their headers, each line behind a tab.
            let is_of_another = raw.starts_with(b"\t") || raw.starts_with(b" ");
            rest = after;
            // Some writers leave the empty line out.
            if let Some(resolution) = Resolution::parse(line).filter(|_| is_over || !is_of_another) {
                let applied = exposure * correction;
                if !(applied.is_finite() && applied.min_element() > 0.0) {
                    return Err(SceneError::new(format!(
                        "EXPOSURE times COLORCORR is {applied}, which is not positive"
                    ))
                    .with_remedy("correct the header"));
                }
                let primaries = if is_xyz { Primaries::XYZ } else { rgb };
                return Ok((Self { applied, primaries, resolution }, rest));
            }
            if is_over && !line.is_empty() {
                break;
            }
            is_over = matches!(raw, b"" | b"\r");
            if is_of_another || line.starts_with('#') {
                continue;
            }
            // Other lines are commands that made the picture.
            let Some((key, value)) = line.split_once('=') else { continue };
            let value = value.trim();
            match key.trim() {
                "FORMAT" => match value {
                    "32-bit_rle_rgbe" => is_xyz = false,
                    "32-bit_rle_xyze" => is_xyz = true,
                    _ => {
                        return Err(SceneError::new(format!("the pixel format `{value}` is not known"))
                            .with_remedy("convert it to 32-bit_rle_rgbe"));
                    }
                },
                "EXPOSURE" => exposure *= numbers::<1>("EXPOSURE", value)?[0],
                "COLORCORR" => correction *= Vec3::from(numbers("COLORCORR", value)?),
                "PRIMARIES" => rgb = Primaries::read(numbers("PRIMARIES", value)?),
                "GAMMA" if numbers::<1>("GAMMA", value)? != [1.0] => {
                    return Err(SceneError::new(format!("GAMMA={value}: its values are not linear"))
                        .with_remedy("undo the gamma, or remove the line if they are"));
                }
                _ => {}
            }
        }
        Err(SceneError::new("the header has no line with the picture's size, such as `-Y 512 +X 1024`")
            .with_remedy("it was cut short or damaged: get it again"))
    }
}

/// So many numbers after `key`.
fn numbers<const N: usize>(key: &str, text: &str) -> Result<[f32; N], SceneError> {
    let parsed: Option<Vec<f32>> = text.split_whitespace().map(|word| word.parse().ok()).collect();
    parsed.and_then(|numbers| numbers.try_into().ok()).ok_or_else(|| {
        let count = if N == 1 { "a number".to_owned() } else { format!("{N} numbers") };
        SceneError::new(format!("{key}={text}: expected {count}")).with_remedy("correct the header")
    })
}

impl Resolution {
    /// Reads `-Y 512 +X 1024`, in any order and direction.
    fn parse(line: &str) -> Option<Self> {
        let words: Vec<&str> = line.split_whitespace().collect();
        let &[first, scanlines, second, pixels] = words.as_slice() else { return None };
        let axis = |word: &str| match word {
            "-Y" => Some((true, true)),
            "+Y" => Some((true, false)),
            "+X" => Some((false, true)),
            "-X" => Some((false, false)),
            _ => None,
        };
        let ((is_by_row, first), (is_other, second)) = (axis(first)?, axis(second)?);
        let (scanlines, pixels) = (scanlines.parse().ok()?, pixels.parse().ok()?);
        (is_by_row != is_other).then_some(Self { is_by_row, scanlines, pixels, from_start: [first, second] })
    }

    /// Width and height.
    fn size(self) -> (usize, usize) {
        if self.is_by_row { (self.pixels, self.scanlines) } else { (self.scanlines, self.pixels) }
    }

    /// Texels by scanline as texels by row, from the top left.
    fn in_order(self, texels: Vec<Vec3>) -> Vec<Vec3> {
        let [first, second] = self.from_start;
        if self.is_by_row && first && second {
            return texels;
        }
        let place = |k: usize, count: usize, from_start: bool| if from_start { k } else { count - 1 - k };
        let (width, height) = self.size();
        (0..width * height)
            .map(|i| {
                let (row, column) = (i / width, i % width);
                let (line, pixel) = if self.is_by_row { (row, column) } else { (column, row) };
                texels[place(line, self.scanlines, first) * self.pixels + place(pixel, self.pixels, second)]
            })
            .collect()
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use image::ImageDecoder;

    /// A flat picture: pixels of 0, 1, 2 .. in red, as they follow in the file.
    fn picture(header: &str, resolution: &str, count: u8) -> Vec<u8> {
        let mut bytes = format!("{header}\n\n{resolution}\n").into_bytes();
        bytes.extend((0..count).flat_map(|k| [k, 64, 32, 136]));
        bytes
    }

    fn reds(header: &str, resolution: &str) -> (usize, usize, Vec<f32>) {
        let image = decode(&picture(header, resolution, 6)).unwrap().image;
        (image.width, image.height, image.texels.iter().map(|texel| texel.x).collect())
    }

    #[test]
    fn exposure_and_colour_correction_are_divided_out() {
        let texel = |header: &str| decode(&picture(header, "-Y 2 +X 3", 6)).unwrap().image.texels[2];
        assert_eq!(texel("#?RGBE\nFORMAT=32-bit_rle_rgbe"), Vec3::new(2.0, 64.0, 32.0));
        let several = "#?RADIANCE\nEXPOSURE=2\npfilt -x 3\nEXPOSURE= 4 \r\nCOLORCORR=1 2 0.5\n# a comment: EXPOSURE=9";
        assert_eq!(texel(several), Vec3::new(0.25, 4.0, 8.0));
        // Lines of the pictures that it was made of.
        let parts = "#?RADIANCE\nin.hdr:\n\t#?RADIANCE\n\tEXPOSURE=8\n \tCOLORCORR=2 2 2\n\tGAMMA=2.2\n\
                     \tFORMAT=32-bit_rle_xyze\n\tPRIMARIES=1 2 3\n\t\n\t-Y 1 +X 1\npcomb -s 1\nEXPOSURE=2";
        assert_eq!(texel(parts), Vec3::new(1.0, 32.0, 16.0));
        assert_eq!(
            texel("#?RADIANCE\nVIEW= -vtv\nGAMMA=1.0\nPIXASPECT=0.5\nSOFTWARE=none"),
            Vec3::new(2.0, 64.0, 32.0)
        );
        for (header, found) in [
            ("EXPOSURE=0", "not positive"),
            ("EXPOSURE=-1", "not positive"),
            ("EXPOSURE=nan", "not positive"),
            ("EXPOSURE=1e30\nEXPOSURE=1e30", "not positive"),
            ("EXPOSURE=two", "expected a number"),
            ("COLORCORR=1 2", "expected 3 numbers"),
            ("PRIMARIES=1 2 3", "expected 8 numbers"),
            ("PRIMARIES=0.3 0.6 0.3 0.6 0 0 0 0", "span no colours"),
            ("GAMMA=2.2", "not linear"),
            ("FORMAT=32-bit_rle_cmyk", "32-bit_rle_cmyk"),
        ] {
            let error = decode(&picture(&format!("#?RADIANCE\n{header}"), "-Y 2 +X 3", 6)).unwrap_err();
            assert!(error.problem.contains(found) && error.remedy.is_some(), "{header}: {error}");
        }
    }

    /// A picture of two rows and three columns, whose places by hand are 0 1 2 over 3 4 5.
    #[test]
    fn eight_orders() {
        let head = "#?RADIANCE";
        let expect = |resolution: &str, rows: [f32; 6]| assert_eq!(reds(head, resolution), (3, 2, rows.into()));
        expect("-Y 2 +X 3", [0.0, 1.0, 2.0, 3.0, 4.0, 5.0]);
        expect("-Y 2 -X 3", [2.0, 1.0, 0.0, 5.0, 4.0, 3.0]);
        expect("+Y 2 +X 3", [3.0, 4.0, 5.0, 0.0, 1.0, 2.0]);
        expect("+Y 2 -X 3", [5.0, 4.0, 3.0, 2.0, 1.0, 0.0]);
        expect("+X 3 -Y 2", [0.0, 2.0, 4.0, 1.0, 3.0, 5.0]);
        expect("+X 3 +Y 2", [1.0, 3.0, 5.0, 0.0, 2.0, 4.0]);
        expect("-X 3 -Y 2", [4.0, 2.0, 0.0, 5.0, 3.0, 1.0]);
        expect("-X 3 +Y 2", [5.0, 3.0, 1.0, 4.0, 2.0, 0.0]);
        let error = |resolution: &str| decode(&picture(head, resolution, 6)).unwrap_err().to_string();
        for bad in ["-Y 2 +Y 3", "-Y 2", "-Y two +X 3", "-Y -2 +X 3", "2 3"] {
            assert!(error(bad).contains("-Y 512 +X 1024"), "{bad}");
        }
    }

    #[test]
    fn headers_as_they_are_found() {
        let with = |head: &[u8]| {
            let mut bytes = head.to_vec();
            bytes.extend((0..6).flat_map(|k| [k, 64, 32, 136]));
            decode(&bytes).unwrap().image.texels[4].x
        };
        assert_eq!(with(b"#?RADIANCE\nFORMAT=32-bit_rle_rgbe\n-Y 2 +X 3\n"), 4.0);
        assert_eq!(with(b"#?RADIANCE\r\nEXPOSURE=2\r\n\r\n-Y 2 +X 3\r\n"), 2.0);
        assert_eq!(with(b"#?RADIANCE\n\n\n-Y 2 +X 3\n"), 4.0);
        assert_eq!(with(b"#?rgbe\n\xff\xfe not text\n\n  -Y  2  +X  3 \n"), 4.0);
        assert!(decode(b"#?RADIANCE\n\nnot a size\n-Y 2 +X 3\n").unwrap_err().problem.contains("no line with"));
    }

    #[test]
    fn xyz_and_other_primaries_are_told() {
        let with = |header: &str| decode(&picture(header, "-Y 2 +X 3", 6)).unwrap().to_rec709;
        assert_eq!(with("#?RADIANCE\nPRIMARIES=0.64 0.33 0.3 0.6 0.15 0.06 0.3127 0.329"), None);
        assert_eq!(with("#?RADIANCE\nPRIMARIES=0 0 0 0 0 0 0 0"), None);
        let xyz = with("#?RADIANCE\nPRIMARIES=.64 .33 .3 .6 .15 .06 .3127 .329\nFORMAT=32-bit_rle_xyze").unwrap();
        assert_eq!(xyz, Primaries::XYZ.to_rec709().unwrap().unwrap());
        assert!(with("#?RADIANCE\nPRIMARIES=0.7347 0.2653 0 1 0.0001 -0.077 0.32168 0.33767").is_some());
    }

    #[test]
    fn a_claimed_size_is_not_believed() {
        let problem = |bytes: &[u8]| decode(bytes).unwrap_err().problem;
        assert!(problem(b"#?RADIANCE\n\n-Y 16000 +X 16000\n12345678").contains("too much"));
        assert!(problem(b"#?RADIANCE\n\n-Y 2000000 +X 4000000\n").contains("at most"));
        assert!(problem(b"#?RADIANCE\n\n-Y 0 +X 0\n").contains("empty"));
        assert!(problem(b"#?RADIANCE\n\n-Y 99999999999999999999 +X 2\n").contains("no line with"));
        assert!(problem(b"#?RADIANCE\n\n-Y 64 +X 128\n12345678").contains("ends before"));
    }

    /// The decoder of the crate `image`, which shares nothing with this one, on what its encoder writes.
    #[test]
    fn agrees_with_another_decoder() {
        let pixels: Vec<image::Rgb<f32>> = (0..40 * 20)
            .map(|k| {
                let x = f32::from(k as u16);
                // Runs, slopes, and exponents of any size.
                image::Rgb([(x / 50.0).floor(), (0.1 * x).sin().abs(), 2f32.powf(0.3 * x - 120.0)])
            })
            .collect();
        let mut bytes = Vec::new();
        image::codecs::hdr::HdrEncoder::new(&mut bytes).encode(&pixels, 40, 20).unwrap();
        let found = decode(&bytes).unwrap().image;
        let decoder = image::codecs::hdr::HdrDecoder::new(std::io::Cursor::new(&bytes)).unwrap();
        let mut other = vec![0_u8; 40 * 20 * 12];
        decoder.read_image(&mut other).unwrap();
        let number = |b: &[u8]| f32::from_ne_bytes([b[0], b[1], b[2], b[3]]);
        let other: Vec<Vec3> =
            other.chunks_exact(12).map(|b| Vec3::new(number(b), number(&b[4..]), number(&b[8..]))).collect();
        assert_eq!(found.texels, other);
    }
}
