//! Windows against ringing: one factor per band, 1 at band 0 and falling.

use std::f64::consts::PI;

/// A window over the bands of an SH vector, which blurs the function it stands for.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub enum Window {
    /// No window: all factors 1.
    #[default]
    None,
    /// `(1 + cos(π l/n))/2` \[Dachsbacher2017\].
    Hann,
    /// `sin(π l/n)/(π l/n)` \[Dachsbacher2017\].
    Lanczos,
    /// `1/(1 + λ l²(l+1)²)`: least squared Laplacian with weight λ >= 0.
    Laplacian {
        /// Weight of the squared Laplacian; 0 is no window.
        lambda: f64,
    },
}

impl Window {
    /// Factor of band `l` out of `bands`; `n` in the equations is `bands`, so that the last band keeps something.
    pub fn factor(self, l: usize, bands: usize) -> f64 {
        let t = PI * l as f64 / bands.max(1) as f64;
        match self {
            Self::None => 1.0,
            _ if l == 0 => 1.0,
            Self::Hann => 0.5 * (1.0 + t.cos()),
            Self::Lanczos => t.sin() / t,
            Self::Laplacian { lambda } => {
                let laplacian = (l * (l + 1)) as f64;
                1.0 / (1.0 + lambda * laplacian * laplacian)
            }
        }
    }

    /// Multiplies every band of `coefficients` by its factor.
    pub fn apply(self, coefficients: &mut [f64]) {
        let bands = coefficients.len().isqrt();
        for (i, value) in coefficients.iter_mut().enumerate() {
            *value *= self.factor(i.isqrt(), bands);
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::{basis, zonal};

    #[test]
    fn every_window_falls_from_one_and_stays_positive() {
        for window in [Window::None, Window::Hann, Window::Lanczos, Window::Laplacian { lambda: 0.01 }] {
            for bands in 1..=8 {
                let factors: Vec<f64> = (0..bands).map(|l| window.factor(l, bands)).collect();
                assert_eq!(factors[0], 1.0);
                assert!(factors.is_sorted_by(|a, b| a >= b) && factors.iter().all(|&f| f > 0.0), "{factors:?}");
            }
        }
    }

    #[test]
    fn windows_lessen_the_undershoot_of_a_cap() {
        let undershoot = |window: Window| {
            let mut cap = zonal::to_spherical(&zonal::cap(6, 0.8));
            window.apply(&mut cap);
            (0..=200)
                .map(|i| f64::cos(i as f64 / 200.0 * PI))
                .map(|z| basis::reconstruct(&cap, [(1.0 - z * z).max(0.0).sqrt(), 0.0, z]))
                .fold(f64::INFINITY, f64::min)
        };
        let bare = undershoot(Window::None);
        assert!(bare < -0.04, "{bare}");
        for window in [Window::Hann, Window::Lanczos] {
            assert!(undershoot(window) > 0.4 * bare, "{window:?} {} {bare}", undershoot(window));
        }
    }
}
