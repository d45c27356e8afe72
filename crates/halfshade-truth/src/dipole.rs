//! The dipole's diffuse reflectance [Jensen2001, eq. 4 and 5], channel by channel, as [`Subsurface`] states it.

use glam::DVec3;
use halfshade_scene::Subsurface;
use std::f64::consts::PI;

/// A medium as light that was scattered often sees it.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Dipole {
    channels: [Channel; 3],
    refractive_index: f64,
}

#[derive(Debug, Clone, Copy)]
struct Channel {
    /// α'/(4π).
    strength: f64,
    /// σ_tr.
    transport: f64,
    /// Depth of the source below the surface, and height of its image above.
    depths: [f64; 2],
}

impl Dipole {
    pub(crate) fn new(medium: &Subsurface) -> Self {
        let eta = f64::from(medium.refractive_index);
        let inner = 0.668 + 0.0636 * eta + (0.710 - 1.440 / eta) / eta;
        let mismatch = (1.0 + inner) / (1.0 - inner);
        let channel = |channel: usize| {
            let absorption = f64::from(medium.absorption[channel]);
            let scattering = f64::from(medium.reduced_scattering[channel]);
            let extinction = absorption + scattering;
            let depth = extinction.recip();
            Channel {
                strength: scattering / extinction / (4.0 * PI),
                transport: (3.0 * absorption * extinction).sqrt(),
                depths: [depth, depth * (1.0 + 4.0 / 3.0 * mismatch)],
            }
        };
        Self { channels: std::array::from_fn(channel), refractive_index: eta }
    }

    /// R_d at a distance: exitance per flux that enters, 1/m².
    pub(crate) fn reflectance(&self, distance: f64) -> DVec3 {
        let of = |Channel { strength, transport, depths }: Channel| {
            let source = |depth: f64| {
                let apart = distance.hypot(depth);
                depth * (transport + apart.recip()) * (-transport * apart).exp() / apart.powi(2)
            };
            strength * (source(depths[0]) + source(depths[1]))
        };
        DVec3::from(self.channels.map(of))
    }

    /// `∫ R_d dA` over an endless plane.
    pub(crate) fn total(&self) -> DVec3 {
        let of = |Channel { strength, transport, depths }: Channel| {
            2.0 * PI * strength * depths.map(|depth| (-transport * depth).exp()).into_iter().sum::<f64>()
        };
        DVec3::from(self.channels.map(of))
    }

    /// The length over which R_d doesn't change: the smallest depth of a source.
    pub(crate) fn shortest_depth(&self) -> f64 {
        self.channels.map(|channel| channel.depths[0]).into_iter().fold(f64::INFINITY, f64::min)
    }

    /// Share of unpolarized light that enters at this cosine: 1 less Fresnel's reflectance.
    pub(crate) fn transmittance(&self, cosine: f64) -> f64 {
        let eta = self.refractive_index;
        if cosine <= 0.0 {
            return 0.0;
        }
        // η cos of the refracted direction.
        let refracted = (eta * eta - 1.0 + cosine * cosine).max(0.0).sqrt();
        let across = (cosine - refracted) / (cosine + refracted);
        let along = (eta * eta * cosine - refracted) / (eta * eta * cosine + refracted);
        1.0 - 0.5 * (across * across + along * along)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use glam::Vec3;

    fn medium(absorption: f32, scattering: f32, refractive_index: f32) -> Dipole {
        Dipole::new(&Subsurface {
            absorption: Vec3::splat(absorption),
            reduced_scattering: Vec3::new(0.0, scattering, 2.0 * scattering),
            refractive_index,
        })
    }

    /// ∫ 2π r R_d dr has a closed form [Jensen2001, 2.4].
    #[test]
    fn an_endless_plane_gives_back_the_closed_form() {
        for (absorption, scattering, eta) in [(0.1_f32, 5.0, 1.5), (1.0, 1.0, 1.3), (1e-3, 1e4, 1.0), (20.0, 0.1, 2.2)]
        {
            let dipole = medium(absorption, scattering, eta);
            // In equal steps of the logarithm, from a ten-thousandth of the depth to where nothing is left.
            let steps = 40_000;
            let (low, high) = (1e-4 / f64::from(absorption + 2.0 * scattering), 1e4 / f64::from(absorption));
            let step = (high / low).ln() / f64::from(steps);
            let radius = |k: i32| low * ((f64::from(k) + 0.5) * step).exp();
            let sum: DVec3 =
                (0..steps).map(|k| step * 2.0 * PI * radius(k).powi(2) * dipole.reflectance(radius(k))).sum();
            for channel in 0..3 {
                let [a, s] = [absorption, [0.0, scattering, 2.0 * scattering][channel]].map(f64::from);
                let (albedo, eta) = (s / (a + s), f64::from(eta));
                let inner = -1.440 / eta.powi(2) + 0.710 / eta + 0.668 + 0.0636 * eta;
                let mismatch = (1.0 + inner) / (1.0 - inner);
                let root = (3.0 * (1.0 - albedo)).sqrt();
                let exact = 0.5 * albedo * (1.0 + (-4.0 / 3.0 * mismatch * root).exp()) * (-root).exp();
                let found = [sum[channel], dipole.total()[channel]];
                assert!(
                    found.iter().all(|x| (x - exact).abs() < 1e-5 * exact.max(1e-3)),
                    "{channel}: {found:?} {exact}"
                );
            }
        }
    }

    #[test]
    fn fresnel_has_its_known_values() {
        let dipole = medium(1.0, 1.0, 1.5);
        assert!((dipole.transmittance(1.0) - 0.96).abs() < 1e-12);
        // At Brewster's angle what is polarized along the plane enters whole.
        let brewster = (1.0 + 1.5_f64.powi(2)).sqrt().recip();
        let across = ((1.5_f64.powi(2) - 1.0) / (1.5_f64.powi(2) + 1.0)).powi(2);
        assert!((dipole.transmittance(brewster) - (1.0 - 0.5 * across)).abs() < 1e-12);
        assert_eq!([dipole.transmittance(0.0), dipole.transmittance(-0.3)], [0.0; 2]);
        assert!(dipole.transmittance(1e-6) < 1e-5);
        assert_eq!(medium(1.0, 1.0, 1.0).transmittance(1e-3), 1.0);
    }
}
