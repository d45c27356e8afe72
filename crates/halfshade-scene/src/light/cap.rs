//! Irradiance of a cap of constant radiance, cut by the horizon: suns and spherical lights in closed form.

use std::f64::consts::PI;

/// Irradiance of a cap of directions of radiance 1, in [0, π].
///
/// `sin_radius` is the sine of the cap's angular radius σ (at most π/2), `cos_angle` the cosine of the angle γ between
/// the receiver's normal and the cap's centre. A spherical light is such a cap as seen from a point outside it.
///
/// ```text
/// wholly above the horizon, cos γ ≥ sin σ:   E = π sin²σ cos γ
/// wholly below, cos γ ≤ -sin σ:              E = 0
/// cut by it, with q = √(sin²σ - cos²γ):      E = (β - q cos σ) + sin²σ cos γ · δ
///                                            β = atan2(q, cos σ)      δ = atan2(q, -cos γ cos σ)
/// ```
///
/// Source: contour integral of a constant source (Lambert's formula): the arc of the cap's rim above the horizon, whose
/// half angle about the cap's centre is δ, and the arc of the horizon inside the cap, of half angle β.
pub fn cap_irradiance(cos_angle: f64, sin_radius: f64) -> f64 {
    let sin_radius = sin_radius.clamp(0.0, 1.0);
    if cos_angle >= sin_radius {
        return PI * sin_radius * sin_radius * cos_angle.min(1.0);
    }
    if cos_angle <= -sin_radius {
        return 0.0;
    }
    let cos_radius = (1.0 - sin_radius * sin_radius).sqrt();
    let rim = ((sin_radius - cos_angle) * (sin_radius + cos_angle)).max(0.0).sqrt();
    let horizon = rim.atan2(cos_radius) - rim * cos_radius;
    (horizon + sin_radius * sin_radius * cos_angle * rim.atan2(-cos_angle * cos_radius)).max(0.0)
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Midpoint rule over the cap in polar angle about its centre and azimuth.
    fn quadrature(angle: f64, radius: f64) -> f64 {
        let (rings, spokes) = (800, 800);
        let mut sum = 0.0;
        for ring in 0..rings {
            let polar = radius * (f64::from(ring) + 0.5) / f64::from(rings);
            for spoke in 0..spokes {
                let azimuth = PI * (f64::from(spoke) + 0.5) / f64::from(spokes);
                let cosine = angle.cos() * polar.cos() + angle.sin() * polar.sin() * azimuth.cos();
                sum += cosine.max(0.0) * polar.sin();
            }
        }
        sum * 2.0 * PI / f64::from(spokes) * radius / f64::from(rings)
    }

    #[test]
    fn matches_quadrature_above_at_and_below_the_horizon() {
        for radius in [0.00465f64, 0.1, 0.5, 1.0, 1.5, PI / 2.0] {
            for offset in [-1.2, -1.0, -0.7, -0.2, 0.0, 0.3, 0.8, 0.99, 1.0, 1.4] {
                let angle = (PI / 2.0 + offset * radius).clamp(0.0, PI);
                let (exact, sum) = (cap_irradiance(angle.cos(), radius.sin()), quadrature(angle, radius));
                let scale = PI * radius.sin().powi(2);
                assert!((exact - sum).abs() < 2e-5 * scale, "{radius} {angle}: {exact} {sum}");
            }
        }
    }

    #[test]
    fn the_hemisphere_facing_up_gives_pi_and_sideways_half_of_it() {
        assert!((cap_irradiance(1.0, 1.0) - PI).abs() < 1e-15);
        assert!((cap_irradiance(0.0, 1.0) - PI / 2.0).abs() < 1e-15);
        assert_eq!(cap_irradiance(-1.0, 1.0), 0.0);
    }
}
