//! Similarity of pictures as people would judge them.
//!
//! SSIM compares the exposed 8-bit sRGB pictures through the crate image-compare (mean structural similarity over
//! 8×8 windows, the worst of the three channels): 1 is identical. FLIP stays `null` in results: the crate that computes it wraps C++
//! and is no dependency of the default build; NVIDIA's own `flip` reads the PNG and EXR files written beside the
//! results.

use crate::image_io::Picture;

/// Mean structural similarity of two pictures of one size, shown with the same exposure; `None` if it isn't defined.
pub fn ssim(picture: &Picture, truth: &Picture, exposure: f32) -> Option<f64> {
    let (first, second) = (picture.to_srgb(exposure), truth.to_srgb(exposure));
    image_compare::rgb_similarity_structure(&image_compare::Algorithm::MSSIMSimple, &first, &second)
        .ok()
        .map(|similarity| similarity.score)
        .filter(|score| score.is_finite())
}

#[cfg(test)]
mod tests {
    use super::*;
    use glam::Vec3;

    #[test]
    fn identical_pictures_score_one_and_worse_ones_less() {
        let truth = Picture {
            width: 32,
            height: 32,
            pixels: (0..1024).map(|i| Vec3::splat(if (i / 4 + i / 128) % 2 == 0 { 0.8 } else { 0.1 })).collect(),
        };
        let disturbed = |amount: f32| {
            let mut picture = truth.clone();
            for (i, pixel) in picture.pixels.iter_mut().enumerate() {
                *pixel += amount * ((i * 7919 % 13) as f32 / 13.0 - 0.5);
            }
            ssim(&picture, &truth, 1.0).unwrap()
        };
        assert!((ssim(&truth, &truth, 1.0).unwrap() - 1.0).abs() < 1e-9);
        let (little, much) = (disturbed(0.05), disturbed(0.5));
        assert!(1.0 > little && little > much && much > 0.0, "{little} {much}");
        assert_eq!(ssim(&truth, &Picture::filled(3, 3, Vec3::ONE), 1.0), None);
    }
}
