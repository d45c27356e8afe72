//! Light scales what is seen, and nothing else does: not its strength, nor the unit of length.

use super::scenes::{apart, fields_and_lobes, lights, mean, models, some_vertices, variants};
use glam::Vec3;
use halfshade_scene::{Motion, RadianceBuffer, Scene};

fn times(radiance: &RadianceBuffer, factor: f32) -> RadianceBuffer {
    RadianceBuffer {
        channels: radiance.channels.each_ref().map(|channel| channel.iter().map(|x| x * factor).collect()),
    }
}

#[test]
fn linear_in_the_light() {
    let (unit, variants) = (lights(Vec3::ONE), variants());
    let scales = [1e-33_f32, 1e33].map(|strength| (strength, lights(Vec3::splat(strength))));
    // All together are a sum.
    for (number, (light, one)) in unit.iter().enumerate().take(5) {
        let receivers = some_vertices(one, 197);
        // By turns, so that sky and lamps are seen at both ends.
        let (strength, scaled) = &scales[number % 2];
        for variant in variants.iter().filter(|variant| models(variant, one)) {
            let expected = variant.shade_lit(one, &receivers);
            let found = times(&variant.shade_lit(&scaled[number].1, &receivers), strength.recip());
            let [worst, _] = apart(&found, &expected);
            assert!(worst < 2e-3, "{} under {light} times {strength}: {worst}", variant.name());
        }
    }
}

/// A channel that is a thousand million times fainter than the others is as exact.
#[test]
fn channels_are_alike() {
    let variants = variants();
    for (light, scene) in lights(Vec3::new(1.0, 1e-9, 1e9)) {
        let receivers = some_vertices(&scene, 197);
        for variant in variants.iter().filter(|variant| models(variant, &scene) && variant.noise == 0.0) {
            let found = variant.shade_lit(&scene, &receivers);
            let [red, green, blue] = [1.0, 1e9, 1e-9_f32].map(|factor| times(&found, factor));
            for (other, channel) in [(green, 1), (blue, 2)] {
                let only = |radiance: &RadianceBuffer, channel: usize| RadianceBuffer {
                    channels: std::array::from_fn(|_| radiance.channels[channel].clone()),
                };
                let [worst, _] = apart(&only(&other, channel), &only(&red, 0));
                assert!(worst < 0.05, "{} under {light}, channel {channel}: {worst}", variant.name());
            }
        }
    }
}

/// `scene` in another unit of length.
fn rescaled(scene: &Scene, factor: f32) -> Scene {
    let mut scaled = scene.clone();
    for motion in scaled.objects.iter_mut().map(|object| &mut object.motion) {
        let Motion::Still(pose) = motion else { continue };
        pose.scale *= factor;
        pose.translation *= factor;
    }
    for (light, _) in &mut scaled.lights {
        light.center *= factor;
        light.radius *= factor;
    }
    scaled.camera.eye *= factor;
    scaled.camera.target *= factor;
    scaled
}

#[test]
fn the_unit_of_length_is_nobodys_business() {
    let variants = fields_and_lobes();
    for (light, scene) in lights(Vec3::ONE) {
        let receivers = some_vertices(&scene, 197);
        for variant in &variants {
            let expected = variant.shade_lit(&scene, &receivers);
            assert!(mean(&expected) > 0.0);
            for power in [-40, 40] {
                let scaled = rescaled(&scene, 2f32.powi(power));
                let found = variant.shade_lit(&scaled, &some_vertices(&scaled, 197));
                let [worst, _] = apart(&found, &expected);
                assert!(worst < 1e-3, "{} under {light} at 2^{power}: {worst}", variant.name());
            }
        }
    }
}
