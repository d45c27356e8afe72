//! Signed errors in colours that the colour-blind tell apart.

use crate::image_io::Picture;
use glam::Vec3;

/// The error, as a fraction of the mean unshadowed radiance, that gets full colour.
pub const FULL_SCALE: f32 = 0.25;

/// White where there is no error, blue where the picture is too dark, vermilion where it is too bright; the channel
/// with the largest error counts.
pub fn signed_error(error: &Picture, unshadowed_mean: f64) -> image::RgbImage {
    let scale = if unshadowed_mean > 0.0 { 1.0 / (FULL_SCALE * unshadowed_mean as f32) } else { 1.0 };
    image::RgbImage::from_fn(error.width as u32, error.height as u32, |x, y| {
        let channels = error.pixels[y as usize * error.width + x as usize].to_array();
        let worst = channels.into_iter().fold(0.0f32, |worst, e| if e.abs() > worst.abs() { e } else { worst });
        let amount = (worst * scale).clamp(-1.0, 1.0);
        let full = if amount < 0.0 { Vec3::new(0.0, 90.0, 181.0) } else { Vec3::new(213.0, 80.0, 0.0) };
        image::Rgb(Vec3::splat(255.0).lerp(full, amount.abs()).to_array().map(|value| (value + 0.5) as u8))
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_sign_gives_the_colour_and_the_size_its_strength() {
        let pixels = vec![Vec3::ZERO, Vec3::new(0.0, -9.0, 1.0), Vec3::new(0.0625, 0.125, 0.0)];
        let image = signed_error(&Picture { width: 3, height: 1, pixels }, 1.0);
        assert_eq!(image.get_pixel(0, 0).0, [255, 255, 255]);
        assert_eq!(image.get_pixel(1, 0).0, [0, 90, 181]);
        assert_eq!(image.get_pixel(2, 0).0, [234, 168, 128]);
    }
}
