//! Vertex colours: what numbers in a file mean.

use super::words::shown;
use crate::SceneError;
use crate::texture::linear_from_srgb;
use glam::Vec3;
use schemars::JsonSchema;
use serde::Deserialize;

/// Encoding of vertex colours.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Deserialize, JsonSchema)]
#[serde(rename_all = "lowercase")]
pub enum ColorEncoding {
    /// As in pictures, \[IEC61966-2-1\].
    Srgb,
    /// Linear: in proportion to reflected light.
    Linear,
}

/// The kind of number in which a file holds colours.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum ColorNumbers {
    /// Whole numbers, 255 for white.
    Bytes,
    /// Whole numbers of a wider type.
    Wide,
    /// Floating point, or numbers in text whose type nothing tells.
    Floats,
}

/// Colours of vertices as a file has them.
#[derive(Debug, Clone)]
pub(super) struct FileColors {
    pub(super) numbers: ColorNumbers,
    /// A colour per vertex; `None` where the file has none.
    pub(super) values: Vec<Option<Vec3>>,
}

/// Deviation of a colour that may be rounding.
const ROUNDING: f32 = 1e-3;

impl FileColors {
    /// Linear colours in [0, 1], white where there is none, and what people should know.
    ///
    /// Whole numbers are sRGB with 255 for white, floating-point numbers linear with 1 for white, unless `told`
    /// otherwise. Numbers of wider types up to 255, and floating-point ones from above 2 to 255, are taken for such of
    /// 8 bits, since a mesh all but black, or lit from within, is unlikely; whole numbers beyond, up to 65535, are of
    /// 16 bits. The error is that of the vertex at `place`.
    pub(super) fn linear(
        &self,
        told: Option<ColorEncoding>,
        place: impl Fn(usize) -> Option<usize>,
    ) -> Result<(Vec<Vec3>, Option<String>), SceneError> {
        let error = |vertex: usize, what: &str| {
            let color = self.values[vertex].unwrap_or_default();
            let problem = format!("vertex {vertex} has a colour that {what}: {}", shown(color.to_string().as_bytes()));
            let error = SceneError::new(problem).with_remedy("give colours from 0 to 1, or from 0 to 255, or none");
            SceneError { line: place(vertex), ..error }
        };
        let mut largest = (0.0_f32, 0);
        for (vertex, color) in self.values.iter().enumerate() {
            let Some(color) = color else { continue };
            if !color.is_finite() {
                return Err(error(vertex, "is not finite"));
            }
            if color.min_element() < -ROUNDING {
                return Err(error(vertex, "is negative"));
            }
            if color.max_element() > largest.0 {
                largest = (color.max_element(), vertex);
            }
        }
        let (white, encoding, note) = match (self.numbers, largest.0) {
            (ColorNumbers::Bytes, _) => (255.0, ColorEncoding::Srgb, None),
            (ColorNumbers::Wide, ..=255.0) => (255.0, ColorEncoding::Srgb, Some("whole numbers up to 255")),
            (ColorNumbers::Wide, ..=65535.0) => (65535.0, ColorEncoding::Srgb, None),
            (ColorNumbers::Wide, _) => return Err(error(largest.1, "is neither of 8 nor of 16 bits")),
            (ColorNumbers::Floats, x) if x <= 1.0 + ROUNDING => (1.0, ColorEncoding::Linear, None),
            (ColorNumbers::Floats, ..=2.0) => (1.0, ColorEncoding::Linear, Some("")),
            (ColorNumbers::Floats, ..=255.0) => (255.0, ColorEncoding::Srgb, Some("numbers up to 255")),
            (ColorNumbers::Floats, _) => return Err(error(largest.1, "lies outside of 0 to 255")),
        };
        let encoding = told.unwrap_or(encoding);
        let decoded = |value: f32| {
            let fraction = (f64::from(value) / white).clamp(0.0, 1.0);
            match encoding {
                ColorEncoding::Linear => fraction as f32,
                ColorEncoding::Srgb => linear_from_srgb(fraction) as f32,
            }
        };
        let colors = self.values.iter().map(|color| color.map_or(Vec3::ONE, |color| color.map(decoded))).collect();
        let note = note.map(|what| match what {
            "" => {
                let count = self.values.iter().flatten().filter(|color| color.max_element() > 1.0).count();
                format!("vertex colours above 1 cut to 1: {count}")
            }
            _ => {
                let name = if encoding == ColorEncoding::Srgb { "sRGB" } else { "linear" };
                format!("vertex colours are {what}: taken for 8 bits, {name}")
            }
        });
        Ok((colors, note))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn linear(numbers: ColorNumbers, values: &[f32], told: Option<ColorEncoding>) -> (Vec<f32>, Option<String>) {
        let values = values.iter().map(|&value| Some(Vec3::splat(value))).collect();
        let (colors, note) = FileColors { numbers, values }.linear(told, |_| None).unwrap();
        (colors.iter().map(|color| color.x).collect(), note)
    }

    #[test]
    fn whole_numbers_are_srgb_and_floats_linear_unless_told_otherwise() {
        use ColorEncoding::{Linear, Srgb};
        // IEC 61966-2-1: code 128 is 0.215861, code 10 lies on the straight part.
        let srgb = [0.0, 10.0 / 255.0 / 12.92, 0.215_860_5, 1.0];
        let close = |found: &[f32], expected: &[f32]| found.iter().zip(expected).all(|(a, b)| (a - b).abs() < 1e-6);
        for (numbers, white) in [(ColorNumbers::Bytes, 255.0), (ColorNumbers::Wide, 65535.0)] {
            let values = [0.0, 10.0, 128.0, 255.0].map(|value| value * white / 255.0);
            let (found, note) = linear(numbers, &values, None);
            assert!(close(&found, &srgb) && note.is_none(), "{found:?}");
            let (found, _) = linear(numbers, &values, Some(Linear));
            assert!(close(&found, &[0.0, 10.0 / 255.0, 128.0 / 255.0, 1.0]), "{found:?}");
        }
        assert_eq!(linear(ColorNumbers::Floats, &[0.0, 0.25, 1.0], None), (vec![0.0, 0.25, 1.0], None));
        let told = linear(ColorNumbers::Floats, &[128.0 / 255.0], Some(Srgb)).0;
        assert!(close(&told, &[0.215_860_5]), "{told:?}");
    }

    #[test]
    fn scales_are_told_by_the_largest_value_with_a_note() {
        for numbers in [ColorNumbers::Wide, ColorNumbers::Floats] {
            let (found, note) = linear(numbers, &[128.0, 255.0], None);
            assert!((found[0] - 0.215_860_5).abs() < 1e-6 && found[1] == 1.0);
            assert!(note.unwrap().contains("8 bits, sRGB"));
        }
        let (found, note) = linear(ColorNumbers::Floats, &[1.5, 0.5], None);
        assert_eq!((found, note.unwrap().as_str()), (vec![1.0, 0.5], "vertex colours above 1 cut to 1: 1"));
        assert_eq!(linear(ColorNumbers::Floats, &[1.000_01, -1e-6], None), (vec![1.0, 0.0], None));
    }

    #[test]
    fn colours_that_are_none_are_refused_and_missing_ones_white() {
        let color = |numbers, value| FileColors { numbers, values: vec![None, Some(Vec3::new(0.0, value, 0.0))] };
        for (numbers, value, part) in [
            (ColorNumbers::Floats, f32::NAN, "not finite"),
            (ColorNumbers::Floats, f32::INFINITY, "not finite"),
            (ColorNumbers::Floats, -0.1, "negative"),
            (ColorNumbers::Floats, 300.0, "outside"),
            (ColorNumbers::Wide, 70000.0, "bits"),
            (ColorNumbers::Wide, -1.0, "negative"),
        ] {
            let error = color(numbers, value).linear(None, |vertex| Some(vertex + 7)).unwrap_err();
            assert!(error.line == Some(8) && error.problem.contains(part), "{error}");
        }
        let (colors, _) = color(ColorNumbers::Floats, 0.5).linear(None, |_| None).unwrap();
        assert_eq!(colors, [Vec3::ONE, Vec3::new(0.0, 0.5, 0.0)]);
    }
}
