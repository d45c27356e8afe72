//! Lights that have a square of their own: spherical ones, and a sun, which is one infinitely far away.

use crate::cosine_lobe::kernel::{spheres::BoundingSphere, square::Square};
use glam::{DVec3, Quat, Vec3};
use halfshade_scene::{SphereLight, light::Sun};

/// A spherical light about the frame's origin, or one infinitely far away.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Light {
    position: LightPosition,
    pub(crate) radiance: Vec3,
}

#[derive(Debug, Clone, Copy)]
enum LightPosition {
    Near(BoundingSphere),
    /// Unit direction, and the sine of the angular radius.
    Far([f32; 3], f32),
}

impl Light {
    /// A local light.
    pub(crate) fn near(light: &SphereLight, origin: DVec3) -> Self {
        let center = (light.center.as_dvec3() - origin).as_vec3().to_array();
        Self {
            position: LightPosition::Near(BoundingSphere { center, radius: light.radius }),
            radiance: light.radiance,
        }
    }

    /// A sun.
    pub(crate) fn far(sun: &Sun, world_from_environment: Quat) -> Self {
        let direction = (world_from_environment * sun.direction).normalize_or(Vec3::Y);
        let sine = sun.angular_radius.clamp(0.0, 0.49 * std::f32::consts::PI).sin();
        Self { position: LightPosition::Far(direction.to_array(), sine), radiance: sun.radiance }
    }

    /// The square before it as a receiver sees it; `None` from within it, or if it has no size.
    pub(crate) fn square(&self, position: [f32; 3]) -> Option<Square> {
        match self.position {
            LightPosition::Near(sphere) => {
                Square::new(std::array::from_fn(|axis| sphere.center[axis] - position[axis]), sphere.radius)
            }
            LightPosition::Far(direction, sine) => Square::far(direction, sine),
        }
    }

    /// Its centre from a point within it, and its radius; `None` from outside.
    pub(crate) fn around(&self, position: [f32; 3]) -> Option<BoundingSphere> {
        let LightPosition::Near(sphere) = self.position else { return None };
        let center = Vec3::from(sphere.center) - Vec3::from(position);
        let holds = sphere.radius > 0.0 && center.as_dvec3().length() <= f64::from(sphere.radius);
        holds.then_some(BoundingSphere { center: center.to_array(), ..sphere })
    }

    /// Its radius; for one infinitely far away, how wide its cone is where it has crossed `all`.
    pub(crate) fn half_width(&self, all: &BoundingSphere) -> f32 {
        match self.position {
            LightPosition::Near(sphere) => sphere.radius,
            LightPosition::Far(_, sine) => all.radius * sine,
        }
    }

    /// A sphere whose hull with that of the receivers holds whatever is in the way, of spheres that lie in `all`.
    pub(crate) fn bounds(&self, receivers: &BoundingSphere, all: &BoundingSphere) -> BoundingSphere {
        match self.position {
            LightPosition::Near(sphere) => sphere,
            LightPosition::Far(direction, sine) => {
                let [from, to] = [receivers.center, all.center].map(Vec3::from);
                // Past all of them, however wide the light.
                let distance = 2.0 * (from.distance(to) + all.radius + receivers.radius) / (1.0 - sine);
                let center = from + distance * Vec3::from(direction);
                BoundingSphere { center: center.to_array(), radius: receivers.radius + distance * sine }
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::{cosine_lobe::kernel::spheres::Spheres, shared::test_scenes::random};

    /// Whatever a ray towards the sun meets is kept.
    #[test]
    fn nobody_before_a_sun_is_left_out() {
        let mut random = random(7);
        let mut met = 0;
        for case in 0..60 {
            let direction = Vec3::new(random(), random(), random()).normalize_or(Vec3::Y);
            let sun = Sun { direction, angular_radius: 0.02 + 0.02 * case as f32, radiance: Vec3::ONE };
            let light = Light::far(&sun, Quat::IDENTITY);
            let receivers = BoundingSphere { center: std::array::from_fn(|_| random()), radius: 0.3 * random().abs() };
            let spheres: Vec<BoundingSphere> = (0..60)
                .map(|_| BoundingSphere {
                    center: std::array::from_fn(|_| 5.0 * random()),
                    radius: 0.1 + 0.2 * random().abs(),
                })
                .collect();
            let all = Spheres::from_list(&spheres);
            let mut kept = Spheres::default();
            all.keep_between(&receivers, &light.bounds(&receivers, &all.bounds()), &mut kept);
            for sphere in &spheres {
                let mut unit = || Vec3::new(random(), random(), random()).normalize_or(Vec3::Y);
                let is_met = (0..200).any(|_| {
                    let from = Vec3::from(receivers.center) + receivers.radius * unit();
                    let across = unit();
                    let aside = (across - across.dot(direction) * direction).normalize_or(direction);
                    let toward = sun.angular_radius.cos() * direction + sun.angular_radius.sin() * aside;
                    let offset = Vec3::from(sphere.center) - from;
                    let along = offset.dot(toward);
                    along > 0.0 && (offset - along * toward).length() < sphere.radius
                });
                met += usize::from(is_met);
                let is_kept = kept.groups().any(|(center, radius)| {
                    (0..8).any(|lane| {
                        radius.to_array()[lane] == sphere.radius && center[0].to_array()[lane] == sphere.center[0]
                    })
                });
                assert!(is_kept || !is_met, "{case} {sphere:?}");
            }
        }
        assert!(met > 100, "{met}");
    }
}
