//! Directions drawn where a receiver reflects: a mixture of its cosine lobes.

use crate::directions::tangents;
use glam::{DVec3, Vec3};
use halfshade_scene::{Lobe, Lobes, lobe::MAX_LOBES};
use std::f64::consts::{FRAC_1_PI, TAU};

/// The lobes of one receiver, made ready for sampling.
///
/// Each lobe is drawn by its power, `(e + 1)/(2π) · max(axis·v, 0)^e` per steradian, as often as its share of
/// `Σ scale · 2π/(e + 1)`, summed over the channels. Wherever any lobe reflects, the density is at least in proportion:
/// reflectance over density never exceeds that sum, so that no sample stands out, however high the exponent.
#[derive(Debug)]
pub(crate) struct Mixture {
    lobes: Lobes,
    /// Cumulative shares, the last one 1.
    shares: [f64; MAX_LOBES + 1],
    normal: DVec3,
}

impl Mixture {
    pub(crate) fn new(lobes: Lobes, normal: DVec3) -> Self {
        let weight = |lobe: &Lobe| lobe.power_integral() * lobe.scale.as_dvec3().element_sum();
        let total: f64 = lobes.iter().map(weight).sum();
        let mut shares = [1.0; MAX_LOBES + 1];
        let mut sum = 0.0;
        for (share, lobe) in shares.iter_mut().zip(lobes.iter()) {
            sum += weight(lobe) / total;
            *share = sum;
        }
        if let Some(last) = lobes.len().checked_sub(1) {
            shares[last] = 1.0;
        }
        Self { lobes, shares, normal }
    }

    /// The same with a diffuse lobe.
    pub(crate) fn with_diffuse(mut lobes: Lobes, albedo: DVec3, normal: DVec3) -> Self {
        lobes.push(Lobe::diffuse(albedo.as_vec3(), normal.as_vec3()));
        Self::new(lobes, normal)
    }

    /// A direction for a point of the open unit square. It may lie below the horizon, where nothing is reflected.
    pub(crate) fn sample(&self, [u, v]: [f64; 2]) -> Vec3 {
        let mut low = 0.0;
        for (lobe, &high) in self.lobes.iter().zip(&self.shares) {
            if u < high {
                let rest = ((u - low) / (high - low)).clamp(f64::MIN_POSITIVE, 1.0);
                // 1 - cos, by which narrow lobes keep their digits: cos = rest^(1/(e + 1)).
                let height = -(rest.ln() / (f64::from(lobe.exponent) + 1.0)).exp_m1();
                let sine = (height * (2.0 - height)).max(0.0).sqrt();
                let axis = lobe.axis.as_dvec3().normalize_or(self.normal);
                let ([t, b], (y, x)) = (tangents(axis), (TAU * v).sin_cos());
                return (sine * (x * t + y * b) + (1.0 - height) * axis).as_vec3();
            }
            low = high;
        }
        self.normal.as_vec3()
    }

    /// Reflectance with its cosines, 1/steradian, and density per steradian of [`Self::sample`], along a unit direction.
    pub(crate) fn evaluate(&self, direction: DVec3) -> (DVec3, f64) {
        let above = self.normal.dot(direction);
        let (mut value, mut density, mut low) = (DVec3::ZERO, 0.0, 0.0);
        for (lobe, &high) in self.lobes.iter().zip(&self.shares) {
            let power = lobe.power(direction);
            density += (high - low) * (f64::from(lobe.exponent) + 1.0) * 0.5 * FRAC_1_PI * power;
            if above > 0.0 {
                value += (if lobe.times_cosine { above * power } else { power }) * lobe.scale.as_dvec3();
            }
            low = high;
        }
        (value, density)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn lobes() -> Lobes {
        let mut lobes = Lobes::NONE;
        let mirrored = Vec3::new(0.6, 0.8, 0.0);
        lobes.push(Lobe { axis: mirrored, exponent: 1e5, scale: Vec3::new(2e4, 1e4, 0.0), times_cosine: true });
        lobes.push(Lobe { axis: Vec3::Z, exponent: 3.0, scale: Vec3::new(0.0, 0.1, 0.4), times_cosine: false });
        lobes
    }

    #[test]
    fn directions_follow_their_density() {
        // The mean of g/density is ∫ g, for g = each lobe's power: 2π/(e + 1).
        let mixture = Mixture::with_diffuse(lobes(), DVec3::splat(0.5), DVec3::Y);
        let (mut sums, side) = ([0.0; 3], 1200);
        let all = mixture.lobes;
        for i in 0..side * side {
            let point = [i / side, i % side].map(|j| (f64::from(j) + 0.5) / f64::from(side));
            let direction = mixture.sample(point).as_dvec3();
            let (_, density) = mixture.evaluate(direction);
            all.iter().zip(&mut sums).for_each(|(lobe, sum)| *sum += lobe.power(direction) / density);
        }
        for (lobe, sum) in all.iter().zip(sums) {
            let relative = sum / f64::from(side * side) / lobe.power_integral() - 1.0;
            assert!(relative.abs() < 2e-3, "{lobe:?}: {relative}");
        }
    }

    #[test]
    fn no_direction_weighs_more_than_all_lobes_together() {
        let mixture = Mixture::new(lobes(), DVec3::Y);
        let total: f64 = lobes().iter().map(|l| l.power_integral() * l.scale.as_dvec3().element_sum()).sum();
        for i in 0..10_000 {
            let point = [f64::from(i) * 0.754_877_7, f64::from(i) * 0.569_840_3].map(|x| x.fract().max(1e-12));
            let (value, density) = mixture.evaluate(mixture.sample(point).as_dvec3());
            assert!(density > 0.0 && value.max_element() <= total * density * (1.0 + 1e-9));
        }
    }

    #[test]
    fn without_lobes_there_is_nothing() {
        let mixture = Mixture::new(Lobes::NONE, DVec3::Y);
        assert_eq!(mixture.sample([0.5, 0.5]), Vec3::Y);
        assert_eq!(mixture.evaluate(DVec3::Y), (DVec3::ZERO, 0.0));
    }
}
