//! Light at the extremes.

use crate::random::Random;
use glam::Vec3;
use halfshade_scene::{
    Environment, Motion, Pose, Scene, SphereLight,
    light::{EnvironmentMap, Sun},
};

/// Lights a scene of about unit size about the origin: an environment, lamps, both or nothing.
pub(crate) fn draw(scene: &mut Scene, random: &mut Random) {
    let kind = random.below(10);
    if kind != 0 {
        scene.environment = match random.below(6) {
            0 | 1 => Environment::constant(radiance(random)),
            2 => Environment::map(one_bright_texel(random)),
            3 => Environment::map(map(random)),
            4 => Environment::map(black(random)),
            _ => Environment::constant(Vec3::ZERO),
        };
        if random.chance(0.5) {
            scene.environment.sun = Some(sun(random));
        }
    }
    if kind < 4 {
        for _ in 0..=random.below(3) {
            let lamp = lamp(random);
            let motion = if random.chance(0.2) {
                let end = Pose { scale: random.log_between(0.1, 10.0), ..Pose::from_translation(random.direction()) };
                Motion::Keyframes(vec![(0.0, Pose::IDENTITY), (1.0, end)])
            } else {
                Motion::Still(Pose::IDENTITY)
            };
            scene.lights.push((lamp, motion));
        }
    }
    if random.chance(0.2) {
        scene.environment_turn_per_sec = random.between(-3.0, 3.0);
    }
    // All of it brighter or dimmer than anything that anybody has seen.
    if random.chance(0.3) {
        let factor = random.log_between(1e-34, 1e26);
        scene.environment = scene.environment.scaled(factor);
        scene.lights.iter_mut().for_each(|(lamp, _)| lamp.radiance *= factor);
    }
}

fn radiance(random: &mut Random) -> Vec3 {
    let strength = if random.chance(0.5) { 1.0 } else { random.log_between(1e-4, 1e4) };
    if random.chance(0.5) {
        return Vec3::splat(strength);
    }
    strength * Vec3::new(random.between(0.0, 1.0), random.between(0.0, 1.0), random.between(0.0, 1.0))
}

fn sized(random: &mut Random, texel: impl FnMut(usize) -> Vec3) -> EnvironmentMap {
    let height = random.pick(&[1, 2, 4, 16]);
    let texels = (0..2 * height * height).map(texel).collect();
    EnvironmentMap::new(2 * height, height, texels).expect("as many texels as there are")
}

fn one_bright_texel(random: &mut Random) -> EnvironmentMap {
    let (place, bright, base) = (random.below(512), radiance(random), random.pick(&[0.0, 1e-3, 1.0]));
    let height = random.pick(&[1, 4, 16]);
    let count = 2 * height * height;
    let texel = |i| if i == place % count { 1e3 * bright } else { Vec3::splat(base) };
    EnvironmentMap::new(2 * height, height, (0..count).map(texel).collect()).expect("as many texels as there are")
}

fn map(random: &mut Random) -> EnvironmentMap {
    let texels: Vec<Vec3> = (0..512).map(|_| random.log_between(1e-3, 1e2) * random.color()).collect();
    sized(random, |i| texels[i])
}

fn black(random: &mut Random) -> EnvironmentMap {
    sized(random, |_| Vec3::ZERO)
}

/// A sun as bright as a constant sky of some radiance, whatever its size.
fn sun(random: &mut Random) -> Sun {
    let angular_radius = random.pick(&[0.01_f32, 0.265, 5.0, 45.0, 90.0]).to_radians();
    let strength = radiance(random);
    let direction = if random.chance(0.2) { Vec3::Y } else { random.direction() };
    Sun { direction, angular_radius, radiance: strength / angular_radius.sin().powi(2) }
}

fn lamp(random: &mut Random) -> SphereLight {
    let (center, radius) = match random.below(5) {
        // A speck.
        0 => (1.5 * random.direction(), random.log_between(1e-4, 1e-2)),
        // Far and huge.
        1 => (random.direction() * 1e4, random.log_between(1e2, 9e3)),
        // Around everything.
        2 => (0.1 * random.direction(), random.log_between(10.0, 1e4)),
        // Among the objects, around some of them.
        3 => (random.between(0.0, 1.0) * random.direction(), random.between(0.05, 1.0)),
        _ => (random.between(1.5, 4.0) * random.direction(), random.between(0.1, 1.0)),
    };
    SphereLight { center, radius, radiance: radiance(random) }
}
