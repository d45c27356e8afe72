//! Structural similarity \[Wang2004\].
//!
//! With means μ, variances σ² and covariance σ_ab under a Gaussian window of 11 by 11 pixels and σ = 1.5 that sums to 1,
//!
//! ```text
//! S = (2 μ_a μ_b + C1) (2 σ_ab + C2) / ((μ_a² + μ_b² + C1) (σ_a² + σ_b² + C2)),   C1 = (0.01 L)², C2 = (0.03 L)²
//! ```
//!
//! and the figure is the mean of S over all windows that lie within the picture: 1 is identical. L is the data range, 255
//! for pictures of 8 bits. Channels are compared one by one, in sRGB as shown, and averaged; the paper compares luminance
//! alone. The variances are those of the window, without Bessel's correction.
//!
//! A picture that is less than 11 pixels wide or high holds no window: its similarity isn't defined. Windows continued
//! past the border would give a figure that can't be compared with those of larger pictures.

use image::RgbImage;

/// Pixels along a side of the window.
pub const WINDOW: usize = 11;

/// Standard deviation of the window, in pixels.
const SIGMA: f64 = 1.5;

/// Largest value of 8 bits.
const DATA_RANGE: f64 = 255.0;

const C1: f64 = (0.01 * DATA_RANGE) * (0.01 * DATA_RANGE);
const C2: f64 = (0.03 * DATA_RANGE) * (0.03 * DATA_RANGE);

/// Mean structural similarity of two pictures of one size, over channels; `None` where no window fits or sizes differ.
pub fn structural_similarity(a: &RgbImage, b: &RgbImage) -> Option<f64> {
    let (width, height) = (a.width() as usize, a.height() as usize);
    if a.dimensions() != b.dimensions() || width < WINDOW || height < WINDOW {
        return None;
    }
    let channel = |image: &RgbImage, c: usize| -> Vec<f64> { image.pixels().map(|p| f64::from(p.0[c])).collect() };
    let sum: f64 = (0..3).map(|c| of_channel(&channel(a, c), &channel(b, c), width)).sum();
    Some(sum / 3.0)
}

/// Structural similarity of one channel, row by row.
fn of_channel(a: &[f64], b: &[f64], width: usize) -> f64 {
    let weights = window();
    let product = |x: &[f64], y: &[f64]| -> Vec<f64> { x.iter().zip(y).map(|(x, y)| x * y).collect() };
    let blurred = |values: &[f64]| blur(values, width, &weights);
    let (mean_a, mean_b) = (blurred(a), blurred(b));
    let (aa, bb, ab) = (blurred(&product(a, a)), blurred(&product(b, b)), blurred(&product(a, b)));
    let similarity = |i: usize| {
        let (ma, mb) = (mean_a[i], mean_b[i]);
        let (va, vb, covariance) = (aa[i] - ma * ma, bb[i] - mb * mb, ab[i] - ma * mb);
        (2.0 * ma * mb + C1) * (2.0 * covariance + C2) / ((ma * ma + mb * mb + C1) * (va + vb + C2))
    };
    (0..mean_a.len()).map(similarity).sum::<f64>() / mean_a.len() as f64
}

fn window() -> [f64; WINDOW] {
    let raw: [f64; WINDOW] = std::array::from_fn(|i| {
        let x = i as f64 - (WINDOW / 2) as f64;
        (-0.5 * (x / SIGMA).powi(2)).exp()
    });
    let sum: f64 = raw.iter().sum();
    raw.map(|value| value / sum)
}

/// Weighted means over all windows that lie within the picture, row by row.
fn blur(values: &[f64], width: usize, weights: &[f64; WINDOW]) -> Vec<f64> {
    let across = |row: &[f64]| -> Vec<f64> {
        row.windows(WINDOW).map(|part| part.iter().zip(weights).map(|(value, weight)| value * weight).sum()).collect()
    };
    let rows: Vec<Vec<f64>> = values.chunks_exact(width).map(across).collect();
    let down = |part: &[Vec<f64>]| -> Vec<f64> {
        let column = |c: usize| part.iter().zip(weights).map(|(row, weight)| row[c] * weight).sum();
        (0..part[0].len()).map(column).collect()
    };
    rows.windows(WINDOW).flat_map(down).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    // scikit-image 0.26.0, printed by `tests/ssim_reference.py`.
    const NOISY: f64 = 0.973_563_689_286_390_1;
    const BLURRED: f64 = 0.246_130_378_585_727_3;
    const CONSTANTS: f64 = 0.470_669_222_903_013_2;
    const CONSTANT_AND_PLAIN: f64 = 0.034_409_504_407_167_59;
    const BLACK_AND_WHITE: f64 = 9.999_000_099_990_003e-5;
    const INVERTED: f64 = -0.953_821_496_482_690_5;
    const SINGLE_WINDOW: f64 = 0.935_931_290_740_173_9;

    /// Whole numbers that `tests/ssim_reference.py` computes too.
    fn picture(width: u32, height: u32, value: impl Fn(u32, u32, u32) -> u32) -> RgbImage {
        RgbImage::from_fn(width, height, |x, y| image::Rgb([0, 1, 2].map(|c| value(x, y, c).min(255) as u8)))
    }

    fn plain(x: u32, y: u32, c: u32) -> u32 {
        40 + (x * x + 3 * y + 7 * c * x + x * y / 4) % 160
    }

    fn noisy(x: u32, y: u32, c: u32) -> u32 {
        plain(x, y, c) + (x * 7919 + y * 104_729 + c * 1299) % 31
    }

    fn blurred(x: u32, y: u32, c: u32) -> u32 {
        (0..3).flat_map(|i| (0..3).map(move |j| (i, j))).map(|(i, j)| plain(x + i, y + j, c)).sum::<u32>() / 9
    }

    fn flat(value: u32) -> impl Fn(u32, u32, u32) -> u32 {
        move |_, _, _| value
    }

    fn similarity(size: (u32, u32), a: impl Fn(u32, u32, u32) -> u32, b: impl Fn(u32, u32, u32) -> u32) -> Option<f64> {
        structural_similarity(&picture(size.0, size.1, a), &picture(size.0, size.1, b))
    }

    #[test]
    fn values_of_scikit_image() {
        let cases = [
            ("noisy", similarity((40, 32), plain, noisy), NOISY),
            ("blurred", similarity((40, 32), plain, blurred), BLURRED),
            ("constant against constant", similarity((16, 16), flat(50), flat(200)), CONSTANTS),
            ("constant against a picture", similarity((20, 24), flat(100), plain), CONSTANT_AND_PLAIN),
            ("black and white", similarity((12, 12), flat(0), flat(255)), BLACK_AND_WHITE),
            ("turned inside out", similarity((33, 17), plain, |x, y, c| 255 - plain(x, y, c)), INVERTED),
            ("a single window", similarity((11, 11), plain, noisy), SINGLE_WINDOW),
        ];
        for (name, found, expected) in cases {
            let found = found.unwrap();
            assert!((found - expected).abs() < 1e-10, "{name}: {found}, scikit-image gives {expected}");
        }
    }

    #[test]
    fn identical_pictures_give_one_and_small_ones_nothing() {
        assert!((similarity((30, 12), plain, plain).unwrap() - 1.0).abs() < 1e-12);
        assert!((similarity((30, 12), flat(7), flat(7)).unwrap() - 1.0).abs() < 1e-12);
        assert_eq!(similarity((7, 7), plain, plain), None);
        assert_eq!(similarity((400, 10), plain, plain), None);
        assert_eq!(structural_similarity(&picture(12, 13, plain), &picture(13, 12, plain)), None);
    }
}
