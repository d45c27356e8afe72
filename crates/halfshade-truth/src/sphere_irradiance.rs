//! Irradiance of a sphere or cap of constant radiance, in closed form.

use std::f64::consts::PI;

/// Irradiance of a sphere of radiance 1 seen under an angular radius with the given sine, its centre in a direction
/// with the given cosine to the receiver's normal; in [0, π].
///
/// A sphere wholly above the horizon gives π sin²θ cosγ. One that the horizon cuts gives the area of its projection
/// onto the unit disc of directions (Nusselt's analogue): part of an ellipse, part of a segment of the unit circle.
/// With s = sin θ, c = cos γ and k = s² - c² > 0:
///
/// ```text
/// E = s² c · acos(-(c/s) √((1 - s²)/(1 - c²))) - √(k (1 - s²)) + atan2(√k, √(1 - s²))
/// ```
///
/// Also the irradiance of a cap of directions of angular radius θ.
pub(crate) fn sphere_irradiance(sine: f64, cosine: f64) -> f64 {
    let sine = sine.clamp(0.0, 1.0);
    if cosine >= sine {
        return PI * sine * sine * cosine;
    }
    if cosine <= -sine {
        return 0.0;
    }
    let k = (sine * sine - cosine * cosine).max(0.0);
    let rest = (1.0 - sine * sine).max(0.0);
    let across = (1.0 - cosine * cosine).max(f64::MIN_POSITIVE);
    let angle = (-(cosine / sine) * (rest / across).sqrt()).clamp(-1.0, 1.0).acos();
    (sine * sine * cosine * angle - (k * rest).sqrt() + k.sqrt().atan2(rest.sqrt())).max(0.0)
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Midpoint quadrature over the cap.
    fn by_quadrature(theta: f64, gamma: f64) -> f64 {
        let (rings, spokes) = (1500, 1500);
        let mut sum = 0.0;
        for ring in 0..rings {
            let alpha = theta * (f64::from(ring) + 0.5) / f64::from(rings);
            for spoke in 0..spokes {
                let phi = 2.0 * PI * (f64::from(spoke) + 0.5) / f64::from(spokes);
                let cosine = gamma.cos() * alpha.cos() + gamma.sin() * alpha.sin() * phi.cos();
                sum += cosine.max(0.0) * alpha.sin();
            }
        }
        sum * theta / f64::from(rings) * 2.0 * PI / f64::from(spokes)
    }

    #[test]
    fn agrees_with_quadrature_above_across_and_below_the_horizon() {
        for theta in [0.05, 0.4, 1.0, 1.4, PI / 2.0] {
            for gamma in [0.0, 0.3, 0.9, 1.2, 1.5, PI / 2.0, 1.7, 2.2, 3.0, PI] {
                let (closed, quadrature) = (sphere_irradiance(theta.sin(), gamma.cos()), by_quadrature(theta, gamma));
                assert!((closed - quadrature).abs() < 2e-6, "θ {theta} γ {gamma}: {closed} {quadrature}");
            }
        }
    }

    #[test]
    fn is_continuous_where_the_horizon_touches() {
        for sine in [1e-6, 0.01, 0.5, 0.999_999] {
            for edge in [sine, -sine] {
                let (inside, outside) = (sphere_irradiance(sine, edge - 1e-12), sphere_irradiance(sine, edge + 1e-12));
                assert!((inside - outside).abs() < 1e-8 * sine, "{sine} {edge}: {inside} {outside}");
            }
        }
    }
}
