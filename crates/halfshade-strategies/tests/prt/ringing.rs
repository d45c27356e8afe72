//! Windows and zonal light beside a strong sun.

use crate::{
    common,
    prt::scenes::{torus_over_ground, vertices},
};
use glam::{DVec3, Vec3};
use halfshade_scene::{
    Environment, RadianceBuffer, ReceiverBuffer, Scene,
    light::{DistantLight, Sun},
};
use halfshade_strategies::Prt;

fn sunny() -> Scene {
    let sun = Sun {
        direction: DVec3::new(0.3, 0.5, -0.6).normalize().as_vec3(),
        angular_radius: 0.05,
        radiance: Vec3::new(600.0, 500.0, 400.0),
    };
    let environment = Environment { base: DistantLight::Constant(Vec3::splat(0.05)), sun: Some(sun) };
    torus_over_ground(environment, [Vec3::ONE; 2])
}

fn least(found: &RadianceBuffer) -> f32 {
    found.channels.iter().flatten().copied().fold(f32::INFINITY, f32::min)
}

fn mean(found: &RadianceBuffer) -> f32 {
    found.channels.iter().flatten().sum::<f32>() / (3 * found.channels[0].len()) as f32
}

/// Light that is nowhere negative leaves no vertex negative, whatever hides it; other light does.
#[test]
fn nonnegative_light_makes_nothing_negative() {
    let scene = sunny();
    for bands in [3, 4, 6] {
        let shade = |settings: &str| vertices(&scene, &format!("bands={bands},directions=256,{settings}")).1;
        let [bare, mended] = [shade("window=none"), shade("window=nonnegative")];
        assert!(least(&bare) < -0.02 * mean(&bare), "{bands}: {}", least(&bare));
        // The rays of a vertex aren't exact.
        assert!(least(&mended) > -2e-3 * mean(&mended), "{bands}: {} {}", least(&mended), mean(&mended));
        // Nothing is taken from the mean of light.
        assert!((mean(&mended) / mean(&bare) - 1.0).abs() < 0.15, "{bands}");
    }
}

/// Factors that are the same for all vectors may be on light or on transfer.
#[test]
fn fixed_windows_are_the_same_on_light_and_on_transfer() {
    let scene = sunny();
    for window in ["hann", "lanczos"] {
        let shade = |on: &str| vertices(&scene, &format!("bands=5,directions=64,window={window},window-on={on}")).1;
        let [light, transfer, both] = ["light", "transfer", "both"].map(shade);
        let room = 1e-5 * mean(&light);
        for (a, b) in light.channels.iter().flatten().zip(transfer.channels.iter().flatten()) {
            assert!((a - b).abs() < room.max(1e-5 * a.abs()), "{window}: {a} {b}");
        }
        assert!(least(&both) > least(&light), "{window}: twice is more");
    }
}

/// Transfer that is nowhere negative makes nothing negative of light that isn't cut off: here its last bands are in the transfer.
#[test]
fn nonnegative_transfer_rings_less() {
    let scene = sunny();
    let shade = |settings: &str| vertices(&scene, &format!("bands=4,directions=256,{settings}")).1;
    let [bare, mended] = [shade(""), shade("window=nonnegative,window-on=transfer")];
    assert!(least(&mended) > 0.7 * least(&bare) && mended.channels != bare.channels, "{}", least(&mended));
}

/// Light about one axis is itself in zonal light; other light isn't; a scene under it may turn.
#[test]
fn a_sun_alone_is_zonal() {
    let mut scene = sunny();
    scene.environment.base = DistantLight::Constant(Vec3::ZERO);
    let shade = |scene: &Scene, settings: &str| vertices(scene, &format!("directions=64,{settings}")).1;
    let [zonal, all] = [shade(&scene, "light=zh3,bands=6"), shade(&scene, "bands=3")];
    for (a, b) in zonal.channels.iter().flatten().zip(all.channels.iter().flatten()) {
        assert!((a - b).abs() < 1e-4 * mean(&all).max(b.abs()), "{a} {b}");
    }
    let guessed = shade(&scene, "light=guessed-zh3");
    assert!((mean(&guessed) / mean(&all) - 1.0).abs() < 0.1 && guessed.channels != all.channels);
    let frame = scene.frame(0);
    let receivers = ReceiverBuffer::vertices(&frame);
    let mut turned = frame.clone();
    turned.world_from_environment = glam::Quat::from_rotation_y(1.0);
    let mut baked = common::baked(&Prt::default(), &scene, "directions=64,light=zh3");
    let before = common::shade(baked.as_mut(), &turned, &receivers);
    let mut exact = common::baked(&Prt::default(), &scene, "directions=64,bands=3");
    let expected = common::shade(exact.as_mut(), &turned, &receivers);
    let pairs = before.channels.iter().flatten().zip(expected.channels.iter().flatten());
    assert!(pairs.into_iter().all(|(a, b)| (a - b).abs() < 1e-4 * mean(&all).max(b.abs())));
}
