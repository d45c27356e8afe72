//! Small bright parts of a map, such as the sun in a captured sky: lights of their own, infinitely far away.
//!
//! Whoever knows a map by a few lobes, cells or directions smears the shadow of anything smaller than those. Light that stands out of its
//! surroundings within [`REACH`] of the brightest texel becomes a cap of the same flux and middle, of constant radiance, with the
//! solid angle `(∫ L dω)²/∫ L² dω`, which for a cap is its own. It is taken out of the map if it is small and has a share of the
//! map's light that is worth a mask; and so on with what is left.

use glam::{DVec3, Vec3};
use halfshade_scene::light::{EnvironmentMap, Sun};
use std::f64::consts::{PI, TAU};

/// How far from its middle a lamp reaches, in radians: its surroundings reach twice as far.
const REACH: f64 = 0.07;

/// Largest angular radius of a lamp: half a cell of the grid of lobes, and a part of a direction's cell of a mask, either of
/// which has room for what is wider.
const LARGEST: f64 = 0.049;

/// Share of the map's flux: lamps with less stay in the map.
const LEAST_SHARE: f64 = 0.02;

/// At most `count` lamps of a map, and what is left of its texels.
pub(crate) fn split(map: &EnvironmentMap, count: usize) -> (Vec<Sun>, Vec<[f32; 3]>) {
    let mut rest = Rest::new(map);
    let lamps = (0..count).map_while(|_| rest.take_brightest()).collect();
    (lamps, rest.texels.iter().map(|texel| texel.to_array()).collect())
}

struct Rest<'a> {
    map: &'a EnvironmentMap,
    texels: Vec<Vec3>,
    /// The flux of all channels of the whole map.
    flux: f64,
}

impl<'a> Rest<'a> {
    fn new(map: &'a EnvironmentMap) -> Self {
        // Light that isn't finite is none, as for lobes.
        let finite = |texel: &Vec3| if texel.is_finite() { texel.max(Vec3::ZERO) } else { Vec3::ZERO };
        let texels: Vec<Vec3> = map.texels().iter().map(finite).collect();
        let flux = texels.iter().enumerate().map(|(i, texel)| brightness(*texel) * solid_angle(map, i)).sum();
        Self { map, texels, flux }
    }

    /// The lamp about the brightest texel, taken out; `None` if it is none.
    fn take_brightest(&mut self) -> Option<Sun> {
        let brightest = (0..self.texels.len())
            .max_by(|&a, &b| brightness(self.texels[a]).total_cmp(&brightness(self.texels[b])))?;
        let mut middle = self.direction(brightest);
        // Once more about the middle of what was found.
        middle = self.standing_out(middle).middle.unwrap_or(middle);
        let found = self.standing_out(middle);
        let angular_radius = (1.0 - found.solid_angle() / TAU).clamp(-1.0, 1.0).acos();
        let is_lamp = angular_radius > 0.0 && angular_radius <= LARGEST && found.brightness >= LEAST_SHARE * self.flux;
        let direction = found.middle.filter(|_| is_lamp)?.as_vec3();
        for &(i, excess) in &found.texels {
            self.texels[i] -= excess;
        }
        let radiance = (found.flux / found.solid_angle()).as_vec3();
        Some(Sun { direction, angular_radius: angular_radius as f32, radiance })
    }

    /// Light near a direction that is brighter than its surroundings' mean.
    fn standing_out(&self, middle: DVec3) -> StandingOut {
        let (near, far) = (REACH.cos(), (2.0 * REACH).cos());
        let (mut around, mut weight) = (DVec3::ZERO, 0.0);
        let mut within = Vec::new();
        let (width, height) = (self.map.width(), self.map.height());
        // Rows farther from the pole or nearer to it than the surroundings reach have no texel there.
        let polar = middle.y.clamp(-1.0, 1.0).acos();
        let row_at = |polar: f64| (polar.clamp(0.0, PI) / PI * height as f64) as usize;
        let rows = row_at(polar - 2.0 * REACH).saturating_sub(1)..(row_at(polar + 2.0 * REACH) + 2).min(height);
        for i in rows.start * width..rows.end * width {
            let cosine = self.direction(i).dot(middle);
            let part = solid_angle(self.map, i);
            if cosine >= near {
                within.push((i, part));
            } else if cosine >= far {
                around += part * self.texels[i].as_dvec3();
                weight += part;
            }
        }
        let around = (around / weight.max(f64::MIN_POSITIVE)).as_vec3();
        let mut found = StandingOut::default();
        let mut sum = DVec3::ZERO;
        for (i, part) in within {
            let excess = (self.texels[i] - around).max(Vec3::ZERO);
            let bright = brightness(excess);
            found.flux += part * excess.as_dvec3();
            found.brightness += part * bright;
            found.squares += part * bright * bright;
            sum += part * bright * self.direction(i);
            found.texels.push((i, excess));
        }
        found.middle = sum.try_normalize();
        found
    }

    fn direction(&self, texel: usize) -> DVec3 {
        self.map.texel_direction(texel).as_dvec3()
    }
}

#[derive(Default)]
struct StandingOut {
    texels: Vec<(usize, Vec3)>,
    middle: Option<DVec3>,
    /// `∫ L dω`, by channel and of all channels.
    flux: DVec3,
    brightness: f64,
    /// `∫ L² dω` of all channels.
    squares: f64,
}

impl StandingOut {
    fn solid_angle(&self) -> f64 {
        self.brightness * self.brightness / self.squares.max(f64::MIN_POSITIVE)
    }
}

fn brightness(radiance: Vec3) -> f64 {
    f64::from(radiance.element_sum())
}

fn solid_angle(map: &EnvironmentMap, texel: usize) -> f64 {
    map.texel_solid_angle(texel / map.width())
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A sky with caps of radiance in it.
    fn sky(caps: &[(Vec3, f32, Vec3)]) -> EnvironmentMap {
        let (width, height) = (512, 256);
        let blank = EnvironmentMap::new(width, height, vec![Vec3::ZERO; width * height]).unwrap();
        let texels = (0..width * height).map(|i| {
            let direction = blank.texel_direction(i);
            let held = caps.iter().filter(|(axis, radius, _)| axis.dot(direction) > radius.cos());
            Vec3::new(0.4, 0.5, 0.7) + held.map(|(.., radiance)| *radiance).sum::<Vec3>()
        });
        EnvironmentMap::new(width, height, texels.collect()).unwrap()
    }

    #[test]
    fn lamps_are_found_and_nothing_is_lost() {
        let axes = [Vec3::new(0.3, 0.8, -0.5).normalize(), Vec3::new(-0.7, 0.2, 0.4).normalize()];
        let caps = [(axes[0], 0.03, Vec3::new(900.0, 800.0, 600.0)), (axes[1], 0.04, Vec3::new(100.0, 150.0, 200.0))];
        let map = sky(&caps);
        let (lamps, rest) = split(&map, 4);
        assert_eq!(lamps.len(), 2);
        for (lamp, (axis, radius, radiance)) in lamps.iter().zip(caps) {
            assert!(lamp.direction.angle_between(axis) < 3e-3, "{lamp:?}");
            assert!((lamp.angular_radius / radius - 1.0).abs() < 0.05, "{lamp:?}");
            assert!((lamp.radiance / radiance - Vec3::ONE).length() < 0.05, "{lamp:?}");
        }
        let flux = |texel: &dyn Fn(usize) -> Vec3| {
            (0..rest.len()).map(|i| brightness(texel(i)) * solid_angle(&map, i)).sum::<f64>()
        };
        let of_lamps = lamps.iter().map(|lamp| {
            let solid_angle = TAU * (1.0 - f64::from(lamp.angular_radius).cos());
            brightness(lamp.radiance) * solid_angle
        });
        let (whole, left) = (flux(&|i| map.texels()[i]), flux(&|i| Vec3::from(rest[i])));
        assert!(((of_lamps.sum::<f64>() + left) / whole - 1.0).abs() < 1e-4);
        // The rest is the sky.
        assert!((left / (4.0 * PI * 1.6) - 1.0).abs() < 0.01, "{left}");
        assert_eq!(split(&map, 1).0.len(), 1);
    }

    #[test]
    fn wide_or_faint_lights_and_damaged_maps_have_no_lamps() {
        let wide = sky(&[(Vec3::Y, 0.2, Vec3::splat(50.0))]);
        let faint = sky(&[(Vec3::X, 0.02, Vec3::splat(5.0))]);
        let damaged = EnvironmentMap::new(4, 2, [Vec3::NAN, Vec3::INFINITY, -Vec3::ONE, Vec3::ONE].repeat(2));
        let black = EnvironmentMap::new(8, 4, vec![Vec3::ZERO; 32]);
        let one = EnvironmentMap::new(1, 1, vec![Vec3::splat(f32::MAX)]);
        for map in [wide, faint, damaged.unwrap(), black.unwrap(), one.unwrap()] {
            let (lamps, rest) = split(&map, 3);
            assert!(lamps.is_empty(), "{lamps:?}");
            assert!(rest.iter().flatten().all(|value| value.is_finite() && *value >= 0.0));
        }
    }
}
