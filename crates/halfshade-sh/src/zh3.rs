//! Light of two bands and of the third what is symmetric about one axis \[Roughton2024\]: five numbers a channel in place of nine.
//!
//! The axis a is that of band 1, along which light is brightest. Of the third band the part about it is kept,
//!
//! ```text
//! k = sqrt(4π/5) Σ_m f_2m y_2m(a)        f_2m -> sqrt(4π/5) k y_2m(a)
//! ```
//!
//! the nearest such function in the least squares; light from one direction, and any that is symmetric about an axis, stays what it
//! is. Where no third band is known, k can be guessed from how much band 1 is of band 0.

use crate::{basis, zonal};

/// Number of bands of the results.
pub const BANDS: usize = 3;

/// Rec. 709 luminance.
const LUMINANCE: [f64; 3] = [0.2126, 0.7152, 0.0722];

/// The axis of band 1 of a vector of at least 4 numbers, unit; +z where it has none.
pub fn axis(light: &[f64]) -> [f64; 3] {
    // Band 1 is sqrt(3/4π)·(-y, z, -x).
    let along = [-light[3], -light[1], light[2]];
    let length = basis::magnitude(&along);
    if length > 0.0 && length.is_finite() { along.map(|value| value / length) } else { [0.0, 0.0, 1.0] }
}

/// The axis of band 1 of the luminance of three channels.
pub fn luminance_axis(light: &[Vec<f64>; 3]) -> [f64; 3] {
    let mixed: Vec<f64> = (0..4).map(|i| (0..3).map(|channel| LUMINANCE[channel] * light[channel][i]).sum()).collect();
    axis(&mixed)
}

/// Keeps of the third band what is symmetric about `axis`.
///
/// # Panics
/// If there aren't 9 coefficients.
pub fn keep_zonal(light: &mut [f64], axis: [f64; 3]) {
    assert_eq!(light.len(), 9, "three bands");
    let y = basis::evaluate(BANDS, axis);
    let scale = zonal::rotation_scale(2);
    let coefficient = scale * basis::dot(&light[4..], &y[4..]);
    (4..9).for_each(|i| light[i] = scale * coefficient * y[i]);
}

/// Puts in place of the third band the part about `axis` that light of this kind is likely to have: with r the part of band 1 along the
/// axis over band 0, `k = f_0 (0.08 r + 0.6 r²)`, a fit over captured light \[Roughton2024, 3.4\].
///
/// # Panics
/// If there aren't 9 coefficients.
pub fn guess_zonal(light: &mut [f64], axis: [f64; 3]) {
    assert_eq!(light.len(), 9, "three bands");
    let y = basis::evaluate(BANDS, axis);
    let along = (zonal::rotation_scale(1) * basis::dot(&light[1..4], &y[1..4])).abs();
    // Nor is anything known of light whose mean is nothing.
    let ratio = if light[0] > 0.0 { along / light[0] } else { 0.0 };
    let coefficient = light[0] * (0.08 * ratio + 0.6 * ratio * ratio);
    (4..9).for_each(|i| light[i] = zonal::rotation_scale(2) * coefficient * y[i]);
}

#[cfg(test)]
mod tests {
    use super::*;

    const AXIS: [f64; 3] = [0.48, -0.36, 0.8];

    #[test]
    fn light_about_one_axis_is_kept() {
        let cap = zonal::rotate_to_axis(&zonal::cap(3, 0.7), AXIS);
        assert!(axis(&cap).iter().zip(AXIS).all(|(a, b)| (a - b).abs() < 1e-14));
        let mut kept = cap.clone();
        keep_zonal(&mut kept, axis(&cap));
        assert!(kept.iter().zip(&cap).all(|(a, b)| (a - b).abs() < 1e-14));
    }

    /// The part that is taken away stands at right angles on the one that is kept: no other function about the axis is nearer.
    #[test]
    fn the_rest_is_orthogonal() {
        let light: Vec<f64> = (0..9).map(|i| ((5 * i + 2) as f64).sin()).collect();
        let mut kept = light.clone();
        keep_zonal(&mut kept, AXIS);
        assert_eq!(kept[..4], light[..4]);
        let about = zonal::rotate_to_axis(&[0.0, 0.0, 1.0], AXIS);
        let taken: Vec<f64> = light.iter().zip(&kept).map(|(all, kept)| all - kept).collect();
        assert!(basis::dot(&taken, &about).abs() < 1e-14);
        let factor = basis::dot(&kept, &about);
        assert!((4..9).all(|i| (kept[i] - factor * about[i]).abs() < 1e-14));
    }

    #[test]
    fn guesses_are_the_formula_and_nothing_for_constant_light() {
        let mut light = zonal::rotate_to_axis(&[2.0, 1.5, 7.0], AXIS);
        guess_zonal(&mut light, AXIS);
        let expected = zonal::rotate_to_axis(&[2.0, 1.5, 2.0 * (0.08 * 0.75 + 0.6 * 0.75 * 0.75)], AXIS);
        assert!(light.iter().zip(&expected).all(|(a, b)| (a - b).abs() < 1e-14));
        for mut light in [basis::one(3), vec![0.0; 9], [vec![-1.0, 3.0], vec![0.0; 7]].concat()] {
            let axis = axis(&light);
            guess_zonal(&mut light, axis);
            assert!(light[4..].iter().all(|value| value.abs() < 1e-14), "{light:?}");
        }
    }

    #[test]
    fn axes_of_colours_are_those_of_their_luminance() {
        let green = zonal::rotate_to_axis(&[1.0, 1.0, 0.0], AXIS);
        let axis = luminance_axis(&[vec![0.0; 9], green, vec![0.0; 9]]);
        assert!(axis.iter().zip(AXIS).all(|(a, b)| (a - b).abs() < 1e-14));
    }
}
