//! Directions drawn where a glossy receiver reflects.

use crate::ray_traced::prepare::light_sampler::about;
use glam::DVec3;
use halfshade_scene::{Lobe, Lobes};

/// The lobes of a receiver, its diffuse one among them, each drawn by its power and as often as it reflects: in proportion
/// to `scale · 2π/(e + 1)`, summed over the channels.
pub(crate) struct Reflector {
    lobes: Lobes,
    total: f64,
    normal: DVec3,
}

fn strength(lobe: &Lobe) -> f64 {
    lobe.scale.as_dvec3().element_sum() * lobe.power_integral()
}

impl Reflector {
    pub(crate) fn new(mut lobes: Lobes, diffuse: Lobe, normal: DVec3) -> Self {
        lobes.push(diffuse);
        Self { lobes, total: lobes.iter().map(strength).sum(), normal }
    }

    /// A direction; it may lie below the horizon.
    pub(crate) fn sample(&self, [choice, u, v]: [f64; 3]) -> DVec3 {
        let mut left = choice * self.total;
        let mut chosen = None;
        for lobe in self.lobes.iter() {
            chosen = Some(lobe);
            left -= strength(lobe);
            if left < 0.0 {
                break;
            }
        }
        let Some(lobe) = chosen else { return self.normal };
        // The cosine is (1 - u)^(1/(e + 1)); what it lacks of 1 keeps its digits for high exponents.
        let one_minus_cosine = -((-u).ln_1p() / (f64::from(lobe.exponent) + 1.0)).exp_m1();
        about(lobe.axis.as_dvec3().normalize_or(self.normal), one_minus_cosine, v)
    }

    /// Reflectance with its cosines, 1/steradian, and density per steradian of [`Self::sample`] along unit `direction`.
    pub(crate) fn evaluate(&self, direction: DVec3) -> (DVec3, f64) {
        let density = self.lobes.iter().map(|l| l.scale.as_dvec3().element_sum() * l.power(direction)).sum::<f64>();
        (self.lobes.value(self.normal, direction), density / self.total)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use glam::Vec3;
    use std::f64::consts::TAU;

    /// A sum over directions that are drawn, each over its density, is an integral: that of every lobe's power is known.
    #[test]
    fn drawn_directions_integrate_every_lobe() {
        let mut lobes = Lobes::NONE;
        lobes.push(Lobe { axis: Vec3::new(0.6, 0.8, 0.0), exponent: 2e4, scale: Vec3::splat(9e3), times_cosine: true });
        lobes.push(Lobe { axis: Vec3::Z, exponent: 0.5, scale: Vec3::new(0.0, 0.1, 0.2), times_cosine: false });
        let reflector = Reflector::new(lobes, Lobe::diffuse(Vec3::splat(0.6), Vec3::Y), DVec3::Y);
        let points = crate::ray_traced::shade::points::Points::<3>::new(9);
        let count = 400_000;
        let mut sums = [0.0; 3];
        for i in 0..count {
            let direction = reflector.sample(points.at(i));
            let (_, density) = reflector.evaluate(direction);
            reflector.lobes.iter().zip(&mut sums).for_each(|(lobe, sum)| *sum += lobe.power(direction) / density);
        }
        for (lobe, sum) in reflector.lobes.iter().zip(sums) {
            let relative = sum / f64::from(count) * (f64::from(lobe.exponent) + 1.0) / TAU - 1.0;
            assert!(relative.abs() < 3e-3, "{lobe:?}: {relative}");
        }
    }
}
