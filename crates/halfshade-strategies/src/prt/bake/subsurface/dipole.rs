//! Diffuse reflectance by a dipole of sources and Fresnel's transmittance \[Jensen2001, eq. 4 and 5\], as `halfshade_scene::Subsurface`
//! states them.

use halfshade_scene::Subsurface;
use std::f64::consts::FRAC_1_PI;

/// The dipole of one channel of a medium.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Dipole {
    /// Reduced albedo α'.
    albedo: f64,
    /// Effective transport coefficient σ_tr, 1/m.
    transport: f64,
    /// Depth of the real source, z_r: a mean free path.
    pub(crate) depth: f64,
    /// Height of the virtual one, z_v.
    height: f64,
}

impl Dipole {
    /// Those of all channels.
    pub(crate) fn of(medium: &Subsurface) -> [Self; 3] {
        let absorption = medium.absorption.as_dvec3();
        let scattering = medium.reduced_scattering.as_dvec3();
        let eta = f64::from(medium.refractive_index);
        // Diffuse reflectance from within, by its fit.
        let inner = -1.440 / (eta * eta) + 0.710 / eta + 0.668 + 0.0636 * eta;
        std::array::from_fn(|channel| {
            let extinction = absorption[channel] + scattering[channel];
            let depth = 1.0 / extinction;
            Self {
                albedo: scattering[channel] / extinction,
                transport: (3.0 * absorption[channel] * extinction).sqrt(),
                depth,
                height: depth + 4.0 / 3.0 * depth * (1.0 + inner) / (1.0 - inner),
            }
        })
    }

    /// R_d at a squared distance, 1/m².
    pub(crate) fn reflectance(&self, squared: f64) -> f64 {
        let Self { albedo, transport, depth, height } = *self;
        let source = |z: f64| {
            let squared = squared + z * z;
            let distance = squared.sqrt();
            z * (1.0 + transport * distance) * (-transport * distance).exp() / (squared * distance)
        };
        0.25 * FRAC_1_PI * albedo * (source(depth) + source(height))
    }

    /// Share of flux that an endless plane gives back, `∫ R_d dA`.
    pub(crate) fn total(&self) -> f64 {
        0.5 * self.albedo * ((-self.transport * self.depth).exp() + (-self.transport * self.height).exp())
    }
}

/// Share of unpolarized light that enters a medium of index `eta` at a cosine in [0, 1], by the angle of refraction.
pub(crate) fn transmittance(eta: f64, cosine: f64) -> f64 {
    if eta == 1.0 {
        return 1.0;
    }
    let sine_squared = (1.0 - cosine * cosine).max(0.0) / (eta * eta);
    let refracted = (1.0 - sine_squared).max(0.0).sqrt();
    let across = (cosine - eta * refracted) / (cosine + eta * refracted);
    let along = (eta * cosine - refracted) / (eta * cosine + refracted);
    1.0 - (across * across + along * along) / 2.0
}

#[cfg(test)]
mod tests {
    use super::*;
    use glam::Vec3;
    use std::f64::consts::TAU;

    /// The share of flux that is given back, by quadrature of R_d over the plane and by the closed form [Jensen2001, 2.4].
    #[test]
    fn the_reflectance_adds_up() {
        let absorption = Vec3::new(0.05, 1.0, 20.0);
        for (scattering, eta) in [(40.0_f32, 1.5_f32), (1.0, 1.3), (0.0, 1.0), (3e4, 2.0)] {
            let medium = Subsurface { absorption, reduced_scattering: Vec3::splat(scattering), refractive_index: eta };
            for (channel, dipole) in Dipole::of(&medium).into_iter().enumerate() {
                let [scattering, eta, absorption] = [scattering, eta, absorption[channel]].map(f64::from);
                let alpha = scattering / (scattering + absorption);
                let inner = -1.440 / (eta * eta) + 0.710 / eta + 0.668 + 0.0636 * eta;
                let (a, root) = ((1.0 + inner) / (1.0 - inner), (3.0 * (1.0 - alpha)).sqrt());
                let exact = alpha / 2.0 * (1.0 + (-4.0 / 3.0 * a * root).exp()) * (-root).exp();
                // r = z_r sinh t, by the midpoint rule.
                let (steps, end) = (20_000, 40.0);
                let step = end / f64::from(steps);
                let ring = |k: i32| {
                    let t = (f64::from(k) + 0.5) * step;
                    let (radius, slope) = (dipole.depth * t.sinh(), dipole.depth * t.cosh());
                    TAU * radius * slope * step * dipole.reflectance(radius * radius)
                };
                let sum: f64 = (0..steps).map(ring).sum();
                for found in [sum, dipole.total()] {
                    assert!((found - exact).abs() <= 1e-5 * exact, "{channel} {scattering} {eta}: {found} {exact}");
                }
            }
        }
    }

    #[test]
    fn grazing_light_stays_outside() {
        for eta in [1.0001, 1.3, 2.5] {
            assert!((transmittance(eta, 1.0) - 4.0 * eta / (1.0 + eta).powi(2)).abs() < 1e-12);
            assert!(transmittance(eta, 0.0).abs() < 1e-12);
            let rises = (0..100).all(|k| {
                let at = |k: i32| transmittance(eta, f64::from(k) / 100.0);
                at(k + 1) > at(k) - 1e-3 && at(k) >= 0.0 && at(k) <= 1.0
            });
            assert!(rises, "{eta}");
        }
        assert_eq!(transmittance(1.0, 0.0), 1.0);
    }
}
