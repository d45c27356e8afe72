//! Suns, small bright parts of a map and spherical lights: by how much of their discs spheres leave uncovered.
//!
//! A vector of few bands blurs the shadow of a small light to the width of its last band. Here no light passes through
//! harmonics: each lamp is a cap of directions with [`POINTS`] points of equal solid angle, and every sphere covers those
//! within its own cap. Of a point at an angle δ from the middle of a sphere of angular radius θ it covers
//!
//! ```text
//! m = clamp((θ - δ)/s + 1/2, 0, 1) · min(1, θ²/s²)        s² = (angular radius of the lamp)²/POINTS
//! ```
//!
//! in chords instead of angles: a point stands for a disc of angular radius s, so that nothing steps as a sphere moves, and a
//! sphere smaller than that covers its own area. Of several spheres the one that covers most counts, which is right where
//! one hides behind another and too little only within an edge's width. What is left of the points, weighted by the
//! receiver's cosine, is the share of the exact irradiance that arrives.

use super::{Blockers, Receivers8, blocker::versine};
use crate::shared::{
    placed_lamps::{Lamp, LampPlace},
    vector::dot,
};
use glam::Vec3;
use halfshade_scene::light::cap_irradiance;
use halfshade_sh::kernel::{ExposedShares, SphericalCap8};
use std::f32::consts::FRAC_1_PI;
use wide::f32x8;

/// Points per lamp.
pub const POINTS: usize = 16;

/// Memory for one batch of receivers.
#[derive(Debug)]
pub(crate) struct LampViews {
    views: Vec<LampView>,
    /// Where the points lie on any cap.
    fan: Vec<[f32; 3]>,
}

/// A lamp as eight receivers see it.
#[derive(Debug)]
struct LampView {
    radiance: Vec3,
    direction: [f32x8; 3],
    /// Irradiance for radiance 1 over π, if nothing is in the way.
    reflected: f32x8,
    /// To its nearest point; infinite of distant ones.
    distance: f32x8,
    /// Chord of its angular radius.
    chord: f32x8,
    /// Chord from a point to the rim of what it stands for.
    spacing: f32x8,
    points: [[f32x8; 3]; POINTS],
    /// How much of each point is left.
    open: [f32x8; POINTS],
}

impl LampViews {
    pub(crate) fn new() -> Self {
        Self { views: Vec::new(), fan: ExposedShares::fan(POINTS).collect() }
    }

    /// Outgoing radiance of white receivers by channel under all `lamps`; `own` tells how much of a light along a direction the
    /// receivers' own object leaves, for lanes that know, and `constant` the share of constant light that they see: that is
    /// what a lamp is to whom it surrounds.
    #[inline(never)]
    pub(crate) fn radiance(
        &mut self,
        lamps: &[Lamp],
        blockers: &Blockers<'_>,
        receivers: &Receivers8,
        own: impl Fn(&[f32x8; 3]) -> f32x8,
        constant: impl Fn() -> f32x8,
    ) -> [f32x8; 3] {
        let Self { views, fan } = self;
        views.clear();
        views.extend(lamps.iter().filter_map(|lamp| LampView::new(lamp, receivers, fan)));
        let mut radiance = [f32x8::ZERO; 3];
        for lamp in lamps {
            let surrounds = surrounds(lamp, &receivers.position);
            if surrounds.any() {
                let share = surrounds.select(constant(), f32x8::ZERO);
                for (sum, channel) in radiance.iter_mut().zip(lamp.radiance.to_array()) {
                    *sum = share.mul_add(f32x8::splat(channel), *sum);
                }
            }
        }
        if views.is_empty() {
            return radiance;
        }
        for blocker in blockers.list {
            let Some(seen) = blockers.hiding(blocker, receivers) else { continue };
            let chord = (f32x8::splat(2.0) * versine(seen.sin_squared)).sqrt();
            let offset: [f32x8; 3] =
                std::array::from_fn(|axis| f32x8::splat(blocker.center[axis]) - receivers.position[axis]);
            for view in views.iter_mut() {
                view.cover(&seen.direction, chord, |distance| {
                    // From before the lamp to behind it over a diameter.
                    let before = (distance - dot(&offset, &offset).sqrt()) * f32x8::splat(0.5 / blocker.radius);
                    (before + f32x8::splat(0.5)).fast_max(f32x8::ZERO).fast_min(f32x8::ONE)
                });
            }
        }
        for view in views {
            let share = view.open_share(&receivers.normal) * own(&view.direction) * view.reflected;
            for (sum, channel) in radiance.iter_mut().zip(view.radiance.to_array()) {
                *sum = share.mul_add(f32x8::splat(channel), *sum);
            }
        }
        radiance
    }
}

impl LampView {
    /// `None` if no receiver is lit by it.
    #[inline(always)]
    fn new(lamp: &Lamp, Receivers8 { position, normal, .. }: &Receivers8, fan: &[[f32; 3]]) -> Option<Self> {
        let (direction, sine, distance) = match lamp.place {
            LampPlace::Far { direction, sine } => {
                (direction.map(f32x8::splat), f32x8::splat(sine), f32x8::splat(f32::INFINITY))
            }
            LampPlace::Near { center, radius } => {
                let offset: [f32x8; 3] = std::array::from_fn(|axis| f32x8::splat(center[axis]) - position[axis]);
                let distance = dot(&offset, &offset).sqrt();
                let inverse = f32x8::ONE / distance.fast_max(f32x8::splat(f32::MIN_POSITIVE));
                let sine = (f32x8::splat(radius) * inverse).fast_min(f32x8::ONE);
                // Whom it surrounds sees no disc.
                let sine = surrounds(lamp, position).select(f32x8::ZERO, sine);
                (offset.map(|axis| axis * inverse), sine, distance - f32x8::splat(radius))
            }
        };
        let reflected = f32x8::splat(FRAC_1_PI) * irradiance(dot(&direction, normal), sine);
        if !reflected.simd_gt(f32x8::ZERO).any() {
            return None;
        }
        let versine = versine(sine * sine);
        let chord = (f32x8::splat(2.0) * versine).sqrt();
        let spacing = (chord * f32x8::splat(1.0 / (POINTS as f32).sqrt())).fast_max(f32x8::splat(1e-12));
        let mut points = [direction; POINTS];
        points
            .iter_mut()
            .zip(SphericalCap8 { direction, versine }.points(fan))
            .for_each(|(place, point)| *place = point);
        let open = [f32x8::ONE; POINTS];
        Some(Self { radiance: lamp.radiance, direction, reflected, distance, chord, spacing, points, open })
    }

    /// Takes what a sphere of this chord about `middle` covers; `before` is how much of it lies nearer than the lamp's distance.
    #[inline(always)]
    fn cover(&mut self, middle: &[f32x8; 3], chord: f32x8, before: impl Fn(f32x8) -> f32x8) {
        let reach = chord + self.chord + self.spacing;
        let is_near = squared_distance(middle, &self.direction).simd_lt(reach * reach) & chord.simd_gt(f32x8::ZERO);
        if !is_near.any() {
            return;
        }
        let per_spacing = f32x8::ONE / self.spacing;
        let area = (chord * per_spacing).fast_min(f32x8::ONE);
        let factor = is_near.select(area * area * before(self.distance), f32x8::ZERO);
        for (open, point) in self.open.iter_mut().zip(&self.points) {
            let inside = (chord - squared_distance(middle, point).sqrt()) * per_spacing;
            let covered = (inside + f32x8::splat(0.5)).fast_max(f32x8::ZERO).fast_min(f32x8::ONE) * factor;
            *open = open.fast_min(f32x8::ONE - covered);
        }
    }

    /// The mean over all points of what is left, weighted by the cosine.
    #[inline(always)]
    fn open_share(&self, normal: &[f32x8; 3]) -> f32x8 {
        // So that a lamp of which no point is above the horizon has a mean, too.
        let least = f32x8::splat(1e-6);
        let (mut sum, mut weights) = (f32x8::ZERO, f32x8::ZERO);
        for (open, point) in self.open.iter().zip(&self.points) {
            let weight = dot(point, normal).fast_max(least);
            sum = open.mul_add(weight, sum);
            weights += weight;
        }
        sum / weights
    }
}

/// The receivers that are within a lamp.
#[inline(always)]
fn surrounds(lamp: &Lamp, position: &[f32x8; 3]) -> f32x8 {
    let LampPlace::Near { center, radius } = lamp.place else { return f32x8::ZERO };
    let offset: [f32x8; 3] = std::array::from_fn(|axis| f32x8::splat(center[axis]) - position[axis]);
    dot(&offset, &offset).sqrt().simd_le(f32x8::splat(radius))
}

/// [`cap_irradiance`] of eight caps: the closed form where the horizon cuts one.
#[inline(always)]
fn irradiance(cosine: f32x8, sine: f32x8) -> f32x8 {
    let full = f32x8::splat(std::f32::consts::PI) * sine * sine;
    // Wider than the radius by f32's rounding, so that both forms agree where they meet.
    let is_cut = cosine.abs().simd_lt(sine * f32x8::splat(1.000_001));
    let above = full * cosine.fast_max(f32x8::ZERO).fast_min(f32x8::ONE);
    if !is_cut.any() {
        return above;
    }
    let (cosines, sines) = (cosine.to_array(), sine.to_array());
    let cut = std::array::from_fn::<f32, 8, _>(|k| cap_irradiance(f64::from(cosines[k]), f64::from(sines[k])) as f32);
    is_cut.select(f32x8::from(cut), above)
}

#[inline(always)]
fn squared_distance(a: &[f32x8; 3], b: &[f32x8; 3]) -> f32x8 {
    let offset: [f32x8; 3] = std::array::from_fn(|axis| a[axis] - b[axis]);
    dot(&offset, &offset)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::sh_exp::kernel::{Blocker, OwnSpheres, blocker::UNSCALED};
    use glam::DVec3;
    use halfshade_scene::spheres::AdjustRule;
    use halfshade_sh::blocker_table::{BlockerTable, Quantity};
    use std::f64::consts::PI;

    const NORMAL: DVec3 = DVec3::Y;

    fn blocker([x, y, z, radius]: [f32; 4]) -> Blocker {
        Blocker { center: [x, y, z], radius, factors: UNSCALED, emitter: 0, reflection_factor: 1.0 }
    }

    /// By the kernel at the origin, on a surface that faces +Y.
    fn found(lamp: Lamp, spheres: &[[f32; 4]]) -> f64 {
        let list: Vec<Blocker> = spheres.iter().copied().map(blocker).collect();
        let table = BlockerTable::build(2, Quantity::BlockerMinusOne).unwrap();
        let blockers =
            Blockers { list: &list, table: &table, rule: AdjustRule::Continuous, own: OwnSpheres::default() };
        let normal = NORMAL.as_vec3().to_array().map(f32x8::splat);
        let receivers = Receivers8 { position: [f32x8::ZERO; 3], normal, knows_own: f32x8::ZERO };
        let radiance = LampViews::new().radiance(&[lamp], &blockers, &receivers, |_| f32x8::ONE, || f32x8::ONE);
        f64::from(radiance[1].to_array()[3])
    }

    /// Rays in f64 to points all over the lamp's cap.
    fn expected(lamp: Lamp, spheres: &[[f32; 4]]) -> f64 {
        let (axis, sine, distance) = match lamp.place {
            LampPlace::Far { direction, sine } => (Vec3::from(direction).as_dvec3(), f64::from(sine), f64::INFINITY),
            LampPlace::Near { center, radius } => {
                let center = Vec3::from(center).as_dvec3();
                (center.normalize(), f64::from(radius) / center.length(), center.length())
            }
        };
        let (u, v) = axis.any_orthonormal_pair();
        let (rings, spokes) = (120, 240);
        let mut sum = 0.0;
        for ring in 0..rings {
            let across = sine * ((f64::from(ring) + 0.5) / f64::from(rings)).sqrt();
            for spoke in 0..spokes {
                let (sin, cos) = (2.0 * PI * (f64::from(spoke) + 0.5) / f64::from(spokes)).sin_cos();
                let direction = (1.0 - across * across).sqrt() * axis + across * (cos * u + sin * v);
                let hides = |&[x, y, z, radius]: &[f32; 4]| {
                    let center = Vec3::new(x, y, z).as_dvec3();
                    let along = center.dot(direction);
                    along > 0.0
                        && center.length() < distance
                        && center.distance_squared(along * direction) < f64::from(radius * radius)
                };
                // Equal steps of the squared sine weigh directions by their cosine with the axis.
                let weight = direction.dot(NORMAL).max(0.0) / direction.dot(axis);
                sum += if spheres.iter().any(hides) { 0.0 } else { weight };
            }
        }
        sum * sine * sine / f64::from(rings * spokes) * f64::from(lamp.radiance.y)
    }

    /// Small suns, wide ones, near lights; spheres apart, one behind another, side by side, behind the lamp.
    #[test]
    fn covered_discs_agree_with_rays() {
        let far = |direction: Vec3, sine| Lamp {
            place: LampPlace::Far { direction: direction.normalize().to_array(), sine },
            radiance: Vec3::new(0.5, 2.0, 1.0),
        };
        let near = Lamp { place: LampPlace::Near { center: [1.0, 3.0, -1.0], radius: 0.4 }, radiance: Vec3::ONE };
        let up = Vec3::new(0.2, 1.0, -0.3);
        for (lamp, most) in [(far(up, 0.00465), 0.07), (far(up, 0.1), 0.07), (far(up, 0.5), 0.07), (near, 0.07)] {
            let axis = match lamp.place {
                LampPlace::Far { direction, .. } => Vec3::from(direction),
                LampPlace::Near { center, .. } => Vec3::from(center).normalize(),
            };
            let side = axis.any_orthonormal_vector();
            let size = match lamp.place {
                LampPlace::Far { sine, .. } => sine,
                LampPlace::Near { radius, .. } => radius / 3.3,
            };
            let sphere = |distance: f32, shift: f32, radius: f32| {
                let place = distance * (axis + shift * size * side);
                [place.x, place.y, place.z, radius * size * distance]
            };
            let full = expected(lamp, &[]);
            assert!((found(lamp, &[]) / full - 1.0).abs() < 1e-3, "{lamp:?}");
            for shift in 0..12 {
                let shift = 0.3 * shift as f32;
                let sets = [
                    vec![sphere(1.5, shift, 1.0)],
                    vec![sphere(1.5, shift, 0.4)],
                    vec![sphere(1.5, shift, 1.4), sphere(2.5, shift + 0.3, 1.1)],
                    vec![sphere(1.5, shift + 0.5, 0.9), sphere(2.0, -shift - 0.6, 0.8)],
                ];
                for spheres in sets {
                    let (found, expected) = (found(lamp, &spheres), expected(lamp, &spheres));
                    assert!((found - expected).abs() < most * full, "{lamp:?} {spheres:?}: {found} {expected}");
                }
            }
        }
        assert!((found(near, &[[2.0, 6.0, -2.0, 0.5]]) / expected(near, &[]) - 1.0).abs() < 1e-3);
    }

    /// A sphere that shrinks or passes by changes the light by little steps only.
    #[test]
    fn nothing_steps() {
        let lamp = Lamp { place: LampPlace::Far { direction: [0.0, 1.0, 0.0], sine: 0.02 }, radiance: Vec3::ONE };
        let full = found(lamp, &[]);
        let mut last = [full; 2];
        for step in (0..=400).rev() {
            let part = step as f32 / 400.0;
            let next =
                [found(lamp, &[[0.0, 2.0, 0.0, 0.08 * part]]), found(lamp, &[[0.1 * part - 0.05, 2.0, 0.0, 0.03]])];
            if step < 400 {
                for (next, last) in next.iter().zip(last) {
                    assert!((next - last).abs() < 0.03 * full, "{part}: {last} {next}");
                }
            }
            last = next;
        }
        assert!((last[0] / full - 1.0).abs() < 1e-6);
    }
}
