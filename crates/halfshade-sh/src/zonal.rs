//! Zonal harmonics: functions symmetric about the z axis, one coefficient per band.

use crate::basis;
use std::f64::consts::PI;

/// Zonal coefficients of the indicator of a cap: 1 within angle θ of +z, 0 elsewhere; `cos_radius` = cos θ.
///
/// `g_0 = sqrt(π)·(1 - cos θ)`, `g_l = sqrt(π/(2l+1))·(P_{l-1}(cos θ) - P_{l+1}(cos θ))`, in closed form from
/// `∫ P_l = (P_{l+1} - P_{l-1})/(2l+1)`.
pub fn cap(bands: usize, cos_radius: f64) -> Vec<f64> {
    cap_from_versine(bands, 1.0 - cos_radius)
}

/// [`cap`] from `u = 1 - cos θ`, which keeps its relative accuracy for a tiny cap.
pub fn cap_from_versine(bands: usize, u: f64) -> Vec<f64> {
    let c = 1.0 - u;
    // (P_{l-1} - P_{l+1})/(1 - c²) satisfies the recurrence of P', which avoids the cancellation for small caps:
    // P_{l-1} - P_{l+1} = (2l+1)/(l(l+1)) (1-c²) P_l'.
    let sine_squared = u * (2.0 - u);
    let mut legendre = (1.0, c);
    let mut derivative = (0.0, 1.0);
    (0..bands)
        .map(|l| {
            let degree = l as f64;
            if l == 0 {
                return PI.sqrt() * u;
            }
            if l > 1 {
                let next = ((2.0 * degree - 1.0) * c * legendre.1 - (degree - 1.0) * legendre.0) / degree;
                // P_l' = P_{l-2}' + (2l-1) P_{l-1}
                let next_derivative = derivative.0 + (2.0 * degree - 1.0) * legendre.1;
                legendre = (legendre.1, next);
                derivative = (derivative.1, next_derivative);
            }
            (PI * (2.0 * degree + 1.0)).sqrt() / (degree * (degree + 1.0)) * sine_squared * derivative.1
        })
        .collect()
}

/// Zonal coefficients of a blocker of angular radius θ: 0 inside the cap, 1 outside: `1 - cap`
/// [Guerrero2007, eq. 4.3 and 4.2 Precomputation].
pub fn blocker(bands: usize, cos_radius: f64) -> Vec<f64> {
    let mut coefficients = cap(bands, cos_radius);
    coefficients.iter_mut().for_each(|g| *g = -*g);
    if let Some(constant) = coefficients.first_mut() {
        *constant += (4.0 * PI).sqrt();
    }
    coefficients
}

/// Zonal coefficients of the clamped cosine max(cos θ, 0), without 1/π, in closed form.
///
/// `g_0 = sqrt(π)/2`, `g_1 = sqrt(π/3)`, odd l > 1: 0, even l:
/// `g_l = sqrt(π(2l+1))·(-1)^{l/2-1}/((l+2)(l-1))·l!/(2^l ((l/2)!)²)`. `∫ max(cos θ, 0) dω = π`.
pub fn clamped_cosine(bands: usize) -> Vec<f64> {
    (0..bands)
        .map(|l| {
            let degree = l as f64;
            match l {
                1 => (PI / 3.0).sqrt(),
                _ if l % 2 == 1 => 0.0,
                _ => {
                    // l!/(2^l ((l/2)!)²) = Π (2k-1)/(2k)
                    let central: f64 = (1..=l / 2).map(|k| (2 * k - 1) as f64 / (2 * k) as f64).product();
                    let sign = if (l / 2) % 2 == 0 { -1.0 } else { 1.0 };
                    sign * (PI * (2.0 * degree + 1.0)).sqrt() * central / ((degree + 2.0) * (degree - 1.0))
                }
            }
        })
        .collect()
}

/// `sqrt(4π/(2l+1))`: what a zonal coefficient of band `l` is multiplied by when it is rotated to an axis
/// [Guerrero2007, eq. 3.17].
pub fn rotation_scale(l: usize) -> f64 {
    (4.0 * PI / (2 * l + 1) as f64).sqrt()
}

/// Diffuse reflectance ρ̂ without its albedo, the clamped cosine over π, by band and times [`rotation_scale`]: what basis
/// functions along a normal are multiplied by, see [`crate::kernel::times_bands`].
pub fn reflectance(bands: usize) -> Vec<f64> {
    clamped_cosine(bands).iter().enumerate().map(|(l, a)| a / PI * rotation_scale(l)).collect()
}

/// SH vector of the zonal function whose axis is turned from +z to unit `axis`:
/// `f_l^m = sqrt(4π/(2l+1)) g_l y_l^m(axis)` [Guerrero2007, eq. 3.17].
pub fn rotate_to_axis(zonal: &[f64], axis: [f64; 3]) -> Vec<f64> {
    let mut coefficients = basis::evaluate(zonal.len(), axis);
    for (i, value) in coefficients.iter_mut().enumerate() {
        let (l, _) = basis::degree_and_order(i);
        *value *= rotation_scale(l) * zonal[l];
    }
    coefficients
}

/// SH vector of a zonal function about +z: coefficient `g_l` at (l, 0), else 0.
pub fn to_spherical(zonal: &[f64]) -> Vec<f64> {
    let mut coefficients = vec![0.0; basis::coefficient_count(zonal.len())];
    for (l, value) in zonal.iter().enumerate() {
        coefficients[basis::index(l, 0)] = *value;
    }
    coefficients
}

/// The (l, 0) coefficients of an SH vector: its part that is symmetric about +z.
pub fn from_spherical(coefficients: &[f64]) -> Vec<f64> {
    let bands = coefficients.len().isqrt();
    (0..bands).map(|l| coefficients[basis::index(l, 0)]).collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::quadrature::{SphereQuadrature, gauss_legendre};

    /// `2π ∫ f(z) y_l^0(z) dz` over [from, 1], by quadrature.
    fn by_quadrature(bands: usize, from: f64, f: impl Fn(f64) -> f64) -> Vec<f64> {
        let mut zonal = vec![0.0; bands];
        for (z, weight) in gauss_legendre(32, from, 1.0) {
            let y = from_spherical(&basis::evaluate(bands, [(1.0 - z * z).sqrt(), 0.0, z]));
            zonal.iter_mut().zip(y).for_each(|(g, y)| *g += 2.0 * PI * weight * f(z) * y);
        }
        zonal
    }

    #[test]
    fn cap_agrees_with_quadrature() {
        for radius in [1e-3, 0.2, 0.8, 1.2, 1.57, 2.5, PI] {
            let cosine = f64::cos(radius);
            for (closed, integrated) in cap(8, cosine).iter().zip(by_quadrature(8, cosine, |_| 1.0)) {
                assert!((closed - integrated).abs() < 1e-13, "{radius}: {closed} {integrated}");
            }
        }
    }

    #[test]
    fn clamped_cosine_agrees_with_quadrature() {
        for (closed, integrated) in clamped_cosine(16).iter().zip(by_quadrature(16, 0.0, |z| z)) {
            assert!((closed - integrated).abs() < 1e-13, "{closed} {integrated}");
        }
    }

    #[test]
    fn rotation_to_an_axis_agrees_with_projection() {
        let axis = [0.36, -0.48, 0.8];
        let zonal = [0.3, -1.2, 0.7, 0.25, -0.4];
        let about_z = to_spherical(&zonal);
        let projected = SphereQuadrature::exact_to(8).project(5, |[x, y, z]| {
            let cosine = x * axis[0] + y * axis[1] + z * axis[2];
            basis::reconstruct(&about_z, [(1.0 - cosine * cosine).max(0.0).sqrt(), 0.0, cosine])
        });
        for (rotated, projected) in rotate_to_axis(&zonal, axis).iter().zip(projected) {
            assert!((rotated - projected).abs() < 1e-13);
        }
        assert_eq!(from_spherical(&about_z), zonal);
    }
}
