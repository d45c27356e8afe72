//! Cosine lobes: what every reflectance model comes down to once the eye is known.

use glam::{DVec3, Vec3};
use std::f32::consts::FRAC_1_PI;
use std::f64::consts::TAU;
use std::ops::Deref;

/// Most lobes beside the diffuse one. \[Lafortune1997\] fits measured surfaces with at most three.
pub const MAX_LOBES: usize = 4;

/// One lobe of the reflectance towards a fixed eye, as [Meunier2009, eq. 30] writes it:
///
/// ```text
/// c(v) = scale · max(axis · v, 0)^exponent          (· max(n · v, 0) if times_cosine)
/// ```
///
/// for directions v above the receiver's horizon, n · v > 0, and 0 below it. The unit is 1/steradian; nothing is left
/// out, so that outgoing radiance is `∫ L(v) V(v) c(v) dv`. Where axis · v ≤ 0 the lobe is 0, also if the exponent is.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Lobe {
    /// Unit vector in world space, pointing away from the surface for ordinary lobes.
    pub axis: Vec3,
    /// At least 0.
    pub exponent: f32,
    /// Value along the axis (before any cosine), per channel.
    pub scale: Vec3,
    /// Whether the foreshortening cosine n · v is still to be multiplied: it is part of every model but the original
    /// Phong's.
    pub times_cosine: bool,
}

impl Lobe {
    /// The diffuse part of a surface as a lobe, `albedo/π · max(n · v, 0)` [Meunier2009, eq. 26].
    pub fn diffuse(albedo: Vec3, normal: Vec3) -> Self {
        Self { axis: normal, exponent: 1.0, scale: FRAC_1_PI * albedo, times_cosine: false }
    }

    /// `max(axis · v, 0)^exponent` for a unit `direction` v: neither cosine nor horizon. In [0, 1].
    ///
    /// The cosine is had from the distance of the two unit vectors: an axis whose length is off by a rounding of single
    /// precision would otherwise change a power of 10^5 by a percent.
    pub fn power(&self, direction: DVec3) -> f64 {
        let below_one = 0.5 * self.axis.as_dvec3().distance_squared(direction);
        if below_one < 1.0 { (f64::from(self.exponent) * (-below_one).ln_1p()).exp() } else { 0.0 }
    }

    /// Factor of `scale`: [`Self::power`] with its cosine if there is one, for unit `normal` and `direction`;
    /// 0 below the horizon. In [0, 1].
    pub fn shape(&self, normal: DVec3, direction: DVec3) -> f64 {
        let above = normal.dot(direction);
        match (above > 0.0, self.times_cosine) {
            (false, _) => 0.0,
            (true, false) => self.power(direction),
            (true, true) => above * self.power(direction),
        }
    }

    /// `∫ max(axis · v, 0)^exponent dv` over all directions, `2π/(exponent + 1)`: no horizon and no cosine.
    pub fn power_integral(&self) -> f64 {
        TAU / (f64::from(self.exponent) + 1.0)
    }
}

/// Most lobes that a list holds: the diffuse one may join.
const CAPACITY: usize = MAX_LOBES + 1;

/// The lobes of one receiver: a short list that needs no allocation.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Lobes {
    lobes: [Lobe; CAPACITY],
    count: usize,
}

impl Lobes {
    /// None: a diffuse receiver, or one that is turned away from the eye.
    pub const NONE: Self = Self {
        lobes: [Lobe { axis: Vec3::Y, exponent: 0.0, scale: Vec3::ZERO, times_cosine: false }; CAPACITY],
        count: 0,
    };

    /// Adds a lobe, unless it is black, isn't finite, or there are [`MAX_LOBES`] and a diffuse one already.
    pub fn push(&mut self, lobe: Lobe) {
        let sound = lobe.axis.is_finite() && lobe.scale.is_finite() && lobe.exponent.is_finite();
        if sound && lobe.scale != Vec3::ZERO && self.count < CAPACITY {
            self.lobes[self.count] = lobe;
            self.count += 1;
        }
    }

    /// The sum of all lobes, each with its scale and, where it has one, its cosine: 1/steradian.
    pub fn value(&self, normal: DVec3, direction: DVec3) -> DVec3 {
        self.iter().map(|lobe| lobe.shape(normal, direction) * lobe.scale.as_dvec3()).sum()
    }
}

impl Deref for Lobes {
    type Target = [Lobe];

    fn deref(&self) -> &[Lobe] {
        &self.lobes[..self.count]
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Midpoint rule over the sphere, rings around the axis so thin that a power of 10^5 is resolved.
    fn integral(lobe: &Lobe, normal: DVec3) -> f64 {
        let (rings, spokes) = (4000, 64);
        let (t, b) = lobe.axis.as_dvec3().any_orthonormal_pair();
        let widest = if lobe.exponent > 1e3 { 20.0 / f64::from(lobe.exponent).sqrt() } else { 0.5 * TAU };
        let mut sum = 0.0;
        for ring in 0..rings {
            let (sine, cosine) = (widest * (f64::from(ring) + 0.5) / f64::from(rings)).sin_cos();
            for spoke in 0..spokes {
                let (y, x) = (TAU * f64::from(spoke) / f64::from(spokes)).sin_cos();
                sum += sine * lobe.shape(normal, sine * (x * t + y * b) + cosine * lobe.axis.as_dvec3());
            }
        }
        sum * widest / f64::from(rings) * TAU / f64::from(spokes)
    }

    #[test]
    fn lobes_around_the_normal_have_their_closed_form() {
        let axis = Vec3::new(0.48, 0.6, 0.64);
        for exponent in [0.0, 1.0, 7.5, 300.0, 1e5] {
            let plain = Lobe { axis, exponent, scale: Vec3::ONE, times_cosine: false };
            let normal = axis.as_dvec3().normalize();
            // The hemisphere around the axis holds the whole lobe.
            let found = integral(&plain, normal) / plain.power_integral();
            assert!((found - 1.0).abs() < 2e-3, "{exponent}: {found}");
            let with_cosine = Lobe { times_cosine: true, ..plain };
            let found = integral(&with_cosine, normal) * (f64::from(exponent) + 2.0) / TAU;
            assert!((found - 1.0).abs() < 2e-3, "{exponent}: {found}");
        }
    }

    #[test]
    fn an_axis_of_rounded_length_keeps_a_high_power() {
        // Lengths that are off by a few units in the last place.
        for length in [1.0 - 3e-7, 1.0, 1.0 + 3e-7] {
            let lobe = Lobe { axis: Vec3::new(0.0, length, 0.0), exponent: 1e5, scale: Vec3::ONE, times_cosine: false };
            assert!((lobe.shape(DVec3::Y, DVec3::Y) - 1.0).abs() < 1e-6);
            let aside = DVec3::new(0.003, (1.0_f64 - 9e-6).sqrt(), 0.0);
            let exact = aside.y.powf(1e5);
            assert!((lobe.shape(DVec3::Y, aside) / exact - 1.0).abs() < 1e-4);
        }
    }

    #[test]
    fn nothing_is_reflected_from_below_the_horizon_and_bad_lobes_are_dropped() {
        let lobe = Lobe { axis: Vec3::X, exponent: 0.0, scale: Vec3::ONE, times_cosine: false };
        assert_eq!(lobe.shape(DVec3::Y, DVec3::new(0.8, -0.6, 0.0)), 0.0);
        assert_eq!(lobe.shape(DVec3::Y, DVec3::new(-0.8, 0.6, 0.0)), 0.0);
        assert_eq!(lobe.shape(DVec3::Y, DVec3::new(0.8, 0.6, 0.0)), 1.0);
        let mut lobes = Lobes::NONE;
        lobes.push(Lobe { scale: Vec3::ZERO, ..lobe });
        lobes.push(Lobe { scale: Vec3::splat(f32::INFINITY), ..lobe });
        assert!(lobes.is_empty());
        (0..CAPACITY + 1).for_each(|_| lobes.push(lobe));
        assert_eq!(lobes.len(), CAPACITY);
        assert_eq!(lobes.value(DVec3::Y, DVec3::new(0.8, 0.6, 0.0)), DVec3::splat(CAPACITY as f64));
    }
}
