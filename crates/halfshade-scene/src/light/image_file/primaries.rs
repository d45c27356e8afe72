//! Conversion of a file's primaries to those of Rec. 709.

use crate::SceneError;
use glam::{DMat3, DVec2, DVec3};

/// Coordinates that differ by less are the same: files round them to three or four digits.
const SAME: f64 = 5e-4;

/// The cone responses of Bradford, by XYZ.
const BRADFORD: DMat3 = DMat3::from_cols(
    DVec3::new(0.8951, -0.7502, 0.0389),
    DVec3::new(0.2664, 1.7135, -0.0685),
    DVec3::new(-0.1614, 0.0367, 1.0296),
);

/// CIE xy chromaticities of red, green, blue and white.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Primaries(pub(super) [DVec2; 4]);

impl Primaries {
    /// Rec. 709, white D65.
    pub(super) const REC709: Self =
        Self([DVec2::new(0.64, 0.33), DVec2::new(0.3, 0.6), DVec2::new(0.15, 0.06), DVec2::new(0.3127, 0.329)]);
    /// CIE XYZ, whose white is of equal energy.
    pub(super) const XYZ: Self = Self([DVec2::X, DVec2::Y, DVec2::ZERO, DVec2::splat(1.0 / 3.0)]);

    /// Those of a file, x and y of red, green, blue and white, by their decimal digits, since they are compared with
    /// others of so many. Nothing but zeros is what programs write that know of none: Rec. 709.
    pub(super) fn read(numbers: [f32; 8]) -> Self {
        if numbers == [0.0; 8] {
            return Self::REC709;
        }
        let digits = numbers.map(|x| x.to_string().parse().unwrap_or(f64::NAN));
        Self(std::array::from_fn(|k| DVec2::new(digits[2 * k], digits[2 * k + 1])))
    }

    /// XYZ by linear RGB: columns (x, y, 1 − x − y) of the primaries, each scaled so that (1, 1, 1) is the white at
    /// luminance 1.
    fn to_xyz(self) -> Option<DMat3> {
        let [red, green, blue, white] = self.0.map(|c| DVec3::new(c.x, c.y, 1.0 - c.x - c.y));
        let unscaled = DMat3::from_cols(red, green, blue);
        let determinant = unscaled.determinant();
        // Written so that what isn't a number fails as well.
        if !(determinant.abs() > 1e-6 && white.y > 1e-6) {
            return None;
        }
        let scales = unscaled.inverse() * (white / white.y);
        (scales.min_element() > 1e-6 && scales.max_element() < 1e6).then(|| unscaled * DMat3::from_diagonal(scales))
    }

    /// Weights of R, G and B in the luminance; of white they add up to 1.
    pub(super) fn luminance_weights(self) -> Result<DVec3, SceneError> {
        self.to_xyz().map(|matrix| matrix.row(1)).ok_or_else(|| self.degenerate())
    }

    /// Linear Rec. 709 by linear RGB of these primaries; `None` where they are the same.
    ///
    /// M709⁻¹ · B⁻¹ · diag(B w709 / B w) · B · M with M to XYZ, white points w and the cone responses B of Bradford, so
    /// that white stays white.
    pub(super) fn to_rec709(self) -> Result<Option<DMat3>, SceneError> {
        let same = |(a, b): (&DVec2, &DVec2)| (a - b).abs().max_element() < SAME;
        if self.0.iter().zip(&Self::REC709.0).all(same) {
            return Ok(None);
        }
        let matrix = || {
            let (from, to) = (self.to_xyz()?, Self::REC709.to_xyz()?);
            let cones = [to, from].map(|matrix| BRADFORD * (matrix * DVec3::ONE));
            let adapted = BRADFORD.inverse() * DMat3::from_diagonal(cones[0] / cones[1]) * BRADFORD;
            let matrix = to.inverse() * adapted * from;
            (cones[1].min_element() > 0.0 && matrix.is_finite()).then_some(matrix)
        };
        matrix().map(Some).ok_or_else(|| self.degenerate())
    }

    fn degenerate(self) -> SceneError {
        let [red, green, blue, white] = self.0.map(|c| format!("({}, {})", c.x, c.y));
        SceneError::new(format!(
            "the primaries red {red}, green {green}, blue {blue} with white {white} span no colours"
        ))
        .with_remedy("correct them, or leave them out for those of Rec. 709")
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn primaries(c: [f64; 8]) -> Primaries {
        Primaries(std::array::from_fn(|k| DVec2::new(c[2 * k], c[2 * k + 1])))
    }

    /// Published matrices, adapted by Bradford: ACES2065-1 (the ACES configuration of OpenColorIO) and Rec. 2020, whose
    /// white is the same (ITU-R BT.2087, to four digits).
    #[test]
    fn published_matrices() {
        let close = |found: DMat3, rows: [[f64; 3]; 3], tolerance: f64| {
            for (row, expected) in rows.iter().enumerate() {
                assert!(found.row(row).abs_diff_eq(DVec3::from(*expected), tolerance), "{found:?}");
            }
        };
        let aces = primaries([0.7347, 0.2653, 0.0, 1.0, 0.0001, -0.077, 0.32168, 0.33767]);
        let expected = [
            [2.521_686_186_7, -1.134_130_988_2, -0.387_555_198_5],
            [-0.276_479_914_2, 1.372_719_087_7, -0.096_239_173_4],
            [-0.015_378_065_0, -0.152_975_335_9, 1.168_353_400_8],
        ];
        close(aces.to_rec709().unwrap().unwrap(), expected, 1e-6);
        let wide = primaries([0.708, 0.292, 0.17, 0.797, 0.131, 0.046, 0.3127, 0.329]);
        let expected = [[1.6605, -0.5876, -0.0728], [-0.1246, 1.1329, -0.0083], [-0.0182, -0.1006, 1.1187]];
        close(wide.to_rec709().unwrap().unwrap(), expected, 6e-5);
        let weights = Primaries::REC709.luminance_weights().unwrap();
        assert!(weights.abs_diff_eq(DVec3::new(0.2126, 0.7152, 0.0722), 5e-5));
    }

    #[test]
    fn white_stays_white_and_its_own_primaries_stay() {
        for other in [Primaries::XYZ, primaries([0.64, 0.33, 0.29, 0.6, 0.15, 0.06, 0.3333, 0.3333])] {
            let white = other.to_rec709().unwrap().unwrap() * DVec3::ONE;
            assert!(white.abs_diff_eq(DVec3::ONE, 1e-12), "{white}");
        }
        assert_eq!(Primaries::REC709.to_rec709().unwrap(), None);
        assert_eq!(primaries([0.64, 0.33, 0.3, 0.6, 0.15, 0.06, 0.31271, 0.32902]).to_rec709().unwrap(), None);
    }

    #[test]
    fn zeros_stand_for_none() {
        assert_eq!(Primaries::read([0.0; 8]), Primaries::REC709);
        assert_eq!(Primaries::read([0.64, 0.33, 0.3, 0.6, 0.15, 0.06, 0.3127, 0.329]), Primaries::REC709);
    }

    #[test]
    fn what_spans_nothing_is_refused() {
        let nan = f64::NAN;
        for bad in [
            [0.0; 8],
            [0.64, 0.33, 0.64, 0.33, 0.15, 0.06, 0.3127, 0.329],
            [0.1, 0.1, 0.2, 0.2, 0.3, 0.3, 0.2, 0.2],
            [0.64, 0.33, 0.3, 0.6, 0.15, 0.06, 0.3127, 0.0],
            [0.64, 0.33, 0.3, 0.6, 0.15, 0.06, 0.9, 0.05],
            [0.64, 0.33, 0.3, nan, 0.15, 0.06, 0.3127, 0.329],
            [1e30, 0.33, 0.3, 0.6, 0.15, 0.06, 0.3127, 0.329],
            [0.64, 0.33, 0.3, 0.6, 0.15, 0.06, f64::INFINITY, 0.329],
        ] {
            let error = primaries(bad).to_rec709().unwrap_err().to_string();
            assert!(error.contains("span no colours") && error.contains("leave them out"), "{error}");
            assert!(primaries(bad).luminance_weights().is_err());
        }
    }
}
