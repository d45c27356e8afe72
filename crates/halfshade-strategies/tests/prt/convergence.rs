//! Transfer against the truth, under light that has no more bands than transfer.

use crate::{
    common,
    prt::scenes::{limited_light, torus_over_ground, vertices},
};
use glam::Vec3;
use halfshade_scene::{Environment, RadianceBuffer, ReceiverBuffer, Scene, progress::Silent};
use halfshade_strategies::Prt;
use halfshade_truth::{Options, Tracer, estimate};

const GREY: [Vec3; 2] = [Vec3::splat(0.8), Vec3::splat(0.6)];
const COLOURED: [Vec3; 2] = [Vec3::new(0.9, 0.3, 0.2), Vec3::new(0.2, 0.6, 0.9)];

/// Whether the error is that of the truth: its root mean square that of the standard errors, its mean nothing, and its share beyond
/// three standard errors that of Student's t with 15 degrees of freedom, 0.9 %, and what the truth's heavy tails add where few of
/// its samples find what hides the light.
pub(crate) fn assert_converged(what: &str, scene: &Scene, receivers: &ReceiverBuffer, found: &RadianceBuffer) {
    let options = Options { samples: 256, bounces: scene.bounces, ..Options::default() };
    let truth = estimate(&Tracer::new(&scene.frame(0)), receivers.view(), &options, &Silent);
    let (mut squares, mut expected, mut sum, mut beyond, mut count) = (0.0, 0.0, 0.0, 0.0, 0.0);
    for channel in 0..3 {
        for i in 0..receivers.len() {
            let [found, exact, error] = [&found.channels, &truth.radiance.channels, &truth.standard_error.channels]
                .map(|of| f64::from(of[channel][i]));
            // Rounding, and the steps of the map.
            let error = error.max(1e-4 * exact).max(1e-6);
            squares += (found - exact).powi(2);
            expected += error.powi(2);
            sum += (found - exact) / error;
            beyond += f64::from((found - exact).abs() > 3.0 * error);
            count += 1.0;
        }
    }
    let [ratio, mean, beyond] = [(squares / expected).sqrt(), sum / count, beyond / count];
    let figures = format!("{what}: {ratio} of the standard error, mean {mean}, {beyond} beyond 3");
    assert!(ratio < 1.3 && mean.abs() < 0.25 && beyond < 0.04, "{figures}");
}

#[test]
fn shadowed_transfer_is_the_truth_under_limited_light() {
    for (bands, seed) in [(2, 1), (4, 2), (6, 3)] {
        let scene = torus_over_ground(limited_light(bands, seed), GREY);
        let (receivers, found) = vertices(&scene, &format!("bands={bands},directions=4096"));
        assert_converged(&format!("{bands} bands"), &scene, &receivers, &found);
    }
}

#[test]
fn interreflected_transfer_is_the_truth_with_as_many_bounces() {
    for (bounces, albedo) in [(1, COLOURED), (2, GREY), (3, COLOURED)] {
        let scene = Scene { bounces, ..torus_over_ground(limited_light(4, 7), albedo) };
        let (receivers, found) = vertices(&scene, "directions=4096");
        assert_converged(&format!("{bounces} bounces"), &scene, &receivers, &found);
    }
}

/// Pixels interpolate vectors; their error is that of a mesh's vertices.
#[test]
fn pixels_are_interpolated() {
    let mut scene = Scene { bounces: 1, ..torus_over_ground(limited_light(3, 5), COLOURED) };
    scene.camera.eye = Vec3::new(0.5, 2.0, 4.0);
    scene.camera.resolution = [48, 36];
    let frame = scene.frame(0);
    let tracer = Tracer::new(&frame);
    let mut receivers = ReceiverBuffer::default();
    for (pixel, hit) in tracer.primary_hits(&scene.camera).iter().enumerate() {
        let [column, row] = [pixel % 48, pixel / 48].map(|place| place as f32 + 0.5);
        let direction = scene.camera.ray_direction(column, row);
        if let Some(hit) = hit {
            receivers.add(&tracer.receiver_at(hit, direction));
        }
    }
    assert!(receivers.len() > 500);
    let found = common::shaded(&Prt::default(), &scene, &frame, &receivers, "bands=3");
    let options = Options { samples: 256, bounces: 1, ..Options::default() };
    let truth = estimate(&tracer, receivers.view(), &options, &Silent);
    let error = |i: usize| f64::from((found.at(i) - truth.radiance.at(i)).length_squared());
    let rms = ((0..receivers.len()).map(error).sum::<f64>() / receivers.len() as f64).sqrt();
    assert!(rms < 0.04 * truth.unshadowed_mean, "{rms} of {}", truth.unshadowed_mean);
}

/// Twice as many rays, less error: of many rays it is that of the boundary of what is hidden, which falls faster than chance.
#[test]
fn more_rays_err_less() {
    let scene = torus_over_ground(Environment::constant(Vec3::ONE), GREY);
    let (_, exact) = vertices(&scene, "bands=1,directions=16384");
    let errors = [64, 256, 1024].map(|directions| {
        let (receivers, found) = vertices(&scene, &format!("bands=1,directions={directions}"));
        let error = |i: usize| f64::from(found.channels[0][i] - exact.channels[0][i]).powi(2);
        ((0..receivers.len()).map(error).sum::<f64>() / receivers.len() as f64).sqrt()
    });
    assert!(errors[1] < 0.4 * errors[0] && errors[2] < 0.4 * errors[1] && errors[2] < 3e-3, "{errors:?}");
}
