//! A few rays tell more than none, in every built-in scene; a filter makes more of them.

use crate::common::shaded;
use halfshade_scene::{RadianceBuffer, ReceiverBuffer, builtin};
use halfshade_strategies::{RayTraced, Unshadowed};

/// Receivers whose light is found by many rays.
const COUNT: usize = 200;

/// Root of the mean squared difference over all channels; of `all` the receivers at `places`.
fn difference(all: &RadianceBuffer, places: &[u32], reference: &RadianceBuffer) -> f64 {
    let apart = |(i, place): (usize, &u32)| (all.at(*place as usize) - reference.at(i)).as_dvec3().length_squared();
    (places.iter().enumerate().map(apart).sum::<f64>() / places.len() as f64).sqrt()
}

#[test]
fn four_rays_are_better_than_none_in_every_scene() {
    for (name, _) in builtin::SCENES {
        let scene = builtin::scene(name).unwrap();
        if scene.is_glossy() || scene.is_translucent() {
            continue;
        }
        let frame = scene.frame(60);
        let all = ReceiverBuffer::vertices(&frame);
        let places: Vec<u32> = (0..all.len() as u32).step_by(all.len().div_ceil(COUNT)).collect();
        let some = ReceiverBuffer::gathered(all.view(), &places);
        let reference = shaded(&RayTraced, &scene, &frame, &some, "plain,samples=1024");
        let off = |radiance: &RadianceBuffer| difference(radiance, &places, &reference);
        let by = |settings: &str| off(&shaded(&RayTraced, &scene, &frame, &all, settings));
        let unshadowed = off(&shaded(&Unshadowed, &scene, &frame, &all, ""));
        let [four, sixteen, filtered] = ["unfiltered,samples=4", "unfiltered,samples=16", "samples=4"].map(by);
        assert!(four <= unshadowed && sixteen <= four, "{name}: {unshadowed}, {four}, {sixteen}");
        assert!(filtered <= four, "{name}: {four}, {filtered}");
    }
}
