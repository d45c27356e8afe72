//! A receiver's number says where it may lie on its mesh, and nothing else: pixels are not vertices.

use super::scenes::{apart, lights, mean, models, some_vertices, variants};
use halfshade_scene::{ReceiverBuffer, Scene, progress::Silent};
use halfshade_truth::{Options, Tracer, estimate};

/// The same receivers, numbered as pixels are, or so that each has the number of some vertex elsewhere.
fn renumbered(receivers: &ReceiverBuffer, number: impl Fn(u32) -> u32) -> ReceiverBuffer {
    let mut same = receivers.clone();
    same.index = (0..same.len() as u32).map(number).collect();
    same
}

#[test]
fn a_pixel_at_a_vertex_is_what_the_vertex_is() {
    let variants = variants();
    for (light, scene) in lights(glam::Vec3::ONE) {
        let receivers = some_vertices(&scene, 5);
        let count = scene.vertex_count() as u32;
        for variant in variants.iter().filter(|variant| models(variant, &scene)) {
            let vertices = variant.shade_lit(&scene, &receivers);
            let numberings: [&dyn Fn(u32) -> u32; 3] = [&|i| i, &|i| (i * 977 + 13) % count, &|i| count + i];
            for (numbering, number) in numberings.into_iter().enumerate() {
                let pixels = variant.shade_lit(&scene, &renumbered(&receivers, number));
                let [worst, rms] = apart(&pixels, &vertices);
                let place = format!("{} under {light}, numbering {numbering}: {worst} {rms}", variant.name());
                // Weights of the three vertices are rounded; rays are drawn by number.
                if variant.noise == 0.0 {
                    assert!(worst < 1e-3, "{place}")
                } else {
                    assert!(rms < variant.noise, "{place}")
                }
            }
        }
    }
}

/// The receivers that a camera sees through the centres of its pixels.
fn pixels(scene: &Scene, resolution: [u32; 2]) -> ReceiverBuffer {
    let frame = scene.frame(0);
    let tracer = Tracer::new(&frame);
    let camera = halfshade_scene::Camera { resolution, ..scene.camera };
    let mut receivers = ReceiverBuffer::default();
    for (pixel, hit) in tracer.primary_hits(&camera).iter().enumerate() {
        let (column, row) = (pixel as u32 % resolution[0], pixel as u32 / resolution[0]);
        let direction = camera.ray_direction(column as f32 + 0.5, row as f32 + 0.5);
        if let Some(hit) = hit {
            receivers.add(&tracer.receiver_at(hit, direction));
        }
    }
    receivers
}

#[test]
fn pictures_agree_with_the_truth_at_every_resolution_alike() {
    let variants = variants();
    for (light, scene) in lights(glam::Vec3::ONE) {
        let tracer = Tracer::new(&scene.frame(0));
        let pictures = [[32, 24], [48, 36], [64, 48]].map(|resolution| {
            let receivers = pixels(&scene, resolution);
            let options = Options { samples: 256, ..Options::default() };
            let truth = estimate(&tracer, receivers.view(), &options, &Silent).radiance;
            (receivers, truth)
        });
        for variant in variants.iter().filter(|variant| models(variant, &scene)) {
            let errors = pictures.each_ref().map(|(receivers, truth)| {
                assert!(mean(truth) > 0.0);
                apart(&variant.shade_lit(&scene, receivers), truth)[1]
            });
            let (least, most) = errors.iter().fold((f32::MAX, 0.0_f32), |(a, b), &e| (a.min(e), b.max(e)));
            assert!(most < 1.5 * least + 0.02, "{} under {light}: {errors:?}", variant.name());
        }
    }
}
