//! Scanlines of Radiance pictures: four bytes a pixel, flat or run-length encoded in either of two ways.
//!
//! A pixel of bytes r, g, b, e is (r, g, b) · 2^(e − 136), nothing if e is 0 \[Ward1991\].

use super::decoded::cut_short;
use crate::SceneError;
use glam::Vec3;

/// Widths for which a scanline may be encoded by component.
const BY_COMPONENT: std::ops::Range<usize> = 8..0x8000;

/// Decodes scanlines of one picture, from its first byte on.
pub(super) struct Scanlines<'a> {
    rest: &'a [u8],
    /// Four bytes a pixel of the scanline at hand.
    pixels: Vec<[u8; 4]>,
}

impl<'a> Scanlines<'a> {
    /// Scanlines of `length` pixels from `bytes`.
    pub(super) fn new(bytes: &'a [u8], length: usize) -> Self {
        Self { rest: bytes, pixels: vec![[0; 4]; length] }
    }

    /// Appends the next scanline.
    pub(super) fn append_next(&mut self, texels: &mut Vec<Vec3>) -> Result<(), SceneError> {
        match *self.rest {
            [2, 2, high, low, ..] if high < 128 && BY_COMPONENT.contains(&self.pixels.len()) => {
                let length = usize::from(high) << 8 | usize::from(low);
                if length != self.pixels.len() {
                    return Err(damaged(format!("a scanline of {length} pixels, not {}", self.pixels.len())));
                }
                self.rest = &self.rest[4..];
                for component in 0..4 {
                    self.component(component)?;
                }
            }
            _ => self.flat_or_old_runs()?,
        }
        texels.extend(self.pixels.iter().map(|&[r, g, b, e]| scale(e) * Vec3::new(r.into(), g.into(), b.into())));
        Ok(())
    }

    fn take(&mut self, count: usize) -> Result<&'a [u8], SceneError> {
        let (taken, rest) = self.rest.split_at_checked(count).ok_or_else(cut_short)?;
        self.rest = rest;
        Ok(taken)
    }

    /// One of the four bytes of all pixels: counts up to 128 of bytes as they are, or of 128 more than a byte repeats.
    fn component(&mut self, component: usize) -> Result<(), SceneError> {
        let mut at = 0;
        while at < self.pixels.len() {
            let count = self.take(1)?[0];
            let (length, repeats) = if count > 128 { (usize::from(count - 128), true) } else { (count.into(), false) };
            let width = self.pixels.len();
            if length == 0 || at + length > width {
                return Err(damaged(format!("{length} pixels after {at} in a scanline of {width}")));
            }
            let values = self.take(if repeats { 1 } else { length })?;
            let pixels = &mut self.pixels[at..at + length];
            if repeats {
                pixels.iter_mut().for_each(|pixel| pixel[component] = values[0]);
            } else {
                pixels.iter_mut().zip(values).for_each(|(pixel, value)| pixel[component] = *value);
            }
            at += length;
        }
        Ok(())
    }

    /// Whole pixels; 1, 1, 1, n repeats the one before n times, and of several in a row each counts 256 times more.
    fn flat_or_old_runs(&mut self) -> Result<(), SceneError> {
        let width = self.pixels.len();
        let (mut at, mut shift) = (0, 0);
        while at < width {
            let &[r, g, b, e] = self.take(4)? else { return Err(cut_short()) };
            if [r, g, b] != [1; 3] {
                self.pixels[at] = [r, g, b, e];
                (at, shift) = (at + 1, 0);
                continue;
            }
            let Some(&before) = at.checked_sub(1).and_then(|before| self.pixels.get(before)) else {
                return Err(damaged("a scanline that begins with a repetition".to_owned()));
            };
            // Shifted beyond any width, only nothing fits.
            let length = if shift < 32 { usize::from(e) << shift } else { usize::from(e) * width };
            if at + length > width {
                return Err(damaged(format!("{length} pixels after {at} in a scanline of {width}")));
            }
            self.pixels[at..at + length].fill(before);
            (at, shift) = (at + length, shift + 8);
        }
        Ok(())
    }
}

/// 2^(e − 136), exactly; 0 for 0.
fn scale(e: u8) -> f32 {
    // Smaller than any normal number for the smallest exponents, so that it takes two steps.
    let first = f32::from_bits(if e > 1 { u32::from(e - 1) << 23 } else { u32::from(e) << 22 });
    first * (1.0 / 256.0)
}

fn damaged(found: String) -> SceneError {
    SceneError::new(format!("its picture is damaged: {found}")).with_remedy("get it again")
}

#[cfg(test)]
mod tests {
    use super::*;

    fn decoded(bytes: &[u8], width: usize) -> Result<Vec<Vec3>, SceneError> {
        let mut texels = Vec::new();
        Scanlines::new(bytes, width).append_next(&mut texels).map(|()| texels)
    }

    #[test]
    fn exponents_from_end_to_end() {
        assert_eq!(scale(0), 0.0);
        for e in 1..=255u8 {
            assert_eq!(f64::from(scale(e)), 2f64.powi(i32::from(e) - 136), "{e}");
        }
    }

    #[test]
    fn three_encodings() {
        let flat = [[128, 64, 32, 129], [128, 0, 0, 128]].concat();
        assert_eq!(decoded(&flat, 2).unwrap(), [Vec3::new(1.0, 0.5, 0.25), Vec3::new(0.5, 0.0, 0.0)]);
        let grey = |k: f32| Vec3::splat(k);
        let old = [[128, 128, 128, 129], [1, 1, 1, 2], [64, 64, 64, 129]].concat();
        assert_eq!(decoded(&old, 4).unwrap(), [grey(1.0), grey(1.0), grey(1.0), grey(0.5)]);
        // 2 + 256 · 1 repetitions.
        let long = [[128, 128, 128, 129], [1, 1, 1, 2], [1, 1, 1, 1]].concat();
        assert_eq!(decoded(&long, 259).unwrap(), [grey(1.0); 259]);
        let mut new = vec![2, 2, 0, 9];
        for component in [[128, 64], [128, 32], [128, 16], [129, 129]] {
            new.extend([128 + 7, component[0], 2, component[1], component[1]]);
        }
        let expected: Vec<Vec3> = (0..9).map(|k| if k < 7 { Vec3::ONE } else { Vec3::new(0.5, 0.25, 0.125) }).collect();
        assert_eq!(decoded(&new, 9).unwrap(), expected);
        // Too short to be encoded by component: a pixel like any other.
        assert_eq!(decoded(&[2, 2, 0, 136, 4, 4, 4, 136], 2).unwrap(), [Vec3::new(2.0, 2.0, 0.0), grey(4.0)]);
    }

    #[test]
    fn damage_is_said() {
        let problem = |bytes: &[u8], width| decoded(bytes, width).unwrap_err().problem;
        assert!(problem(&[128, 128, 128], 2).contains("ends before"));
        assert!(problem(&[1, 1, 1, 2, 0, 0, 0, 0], 2).contains("begins with"));
        assert!(problem(&[9, 9, 9, 9, 1, 1, 1, 9], 2).contains("9 pixels after 1"));
        assert!(problem(&[2, 2, 0, 8, 0, 0, 0, 0], 9).contains("of 8 pixels, not 9"));
        assert!(problem(&[2, 2, 0, 9, 128 + 10, 0, 0, 0], 9).contains("10 pixels after 0"));
        assert!(problem(&[2, 2, 0, 9, 0, 0, 0, 0], 9).contains("0 pixels after 0"));
        // Many repetitions of nothing, each worth 256 times more, and then one of something.
        let mut runs = [[9, 9, 9, 9]].concat();
        runs.extend([[1, 1, 1, 0]; 40].concat());
        assert!(problem(&runs, 2).contains("ends before"));
        runs.extend([1, 1, 1, 1]);
        assert!(problem(&runs, 2).contains("2 pixels after 1"));
    }
}
