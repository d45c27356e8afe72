//! Compressed transfer beside transfer as it is.

use crate::{
    common::{baked, shade},
    prt::scenes::{in_batches, limited_light, torus_over_ground},
};
use glam::Vec3;
use halfshade_scene::{
    Environment, Frame, Material, RadianceBuffer, ReceiverBuffer, ReceiverPoint, Scene, SurfacePoint,
};
use halfshade_strategies::Prt;

fn scene(colour: Vec3) -> Scene {
    Scene { bounces: 1, ..torus_over_ground(limited_light(4, 21), [colour, Vec3::splat(0.6)]) }
}

/// The vertices, points on triangles from both sides, and a point that lies nowhere.
fn receivers(frame: &Frame<'_>) -> ReceiverBuffer {
    let mut receivers = ReceiverBuffer::vertices(frame);
    for i in 0..60 {
        let first = receivers.view().at(7 * i);
        let triangle = (i % 30) as u32;
        let surface = SurfacePoint::Triangle { triangle, barycentric: [0.2, 0.3, 0.5], from_behind: i % 2 == 0 };
        receivers.add(&ReceiverPoint { surface, ..first });
    }
    receivers.push(Vec3::Y, Vec3::new(0.6, 0.8, 0.0), Vec3::ONE, 0);
    receivers
}

/// Root of the mean square of a difference, over that of what it should be.
fn error(found: &RadianceBuffer, exact: &RadianceBuffer) -> f64 {
    let sum = |value: &dyn Fn(usize) -> Vec3| -> f64 {
        (0..exact.channels[0].len()).map(|i| f64::from(value(i).length_squared())).sum()
    };
    (sum(&|i| found.at(i) - exact.at(i)) / sum(&|i| exact.at(i))).sqrt()
}

#[test]
fn radiance_is_that_of_decoded_vectors() {
    for colour in [Vec3::splat(0.5), Vec3::new(0.8, 0.5, 0.2)] {
        let scene = scene(colour);
        let frame = scene.frame(0);
        let receivers = receivers(&frame);
        let radiance = |settings: &str| {
            shade(baked(&Prt::default(), &scene, &format!("directions=32{settings}")).as_mut(), &frame, &receivers)
        };
        let exact = radiance("");
        // As many components as rows can have, or as many clusters.
        for settings in ["pca,components=192", "cpca,clusters=20,components=192", "vq,clusters=4096"] {
            let error = error(&radiance(&format!(",compression={settings}")), &exact);
            assert!(error < 1e-5, "{settings}: {error}");
        }
        let [pca, vq, cpca] = ["pca,components=4", "vq,clusters=64", "cpca,clusters=64,components=4"]
            .map(|settings| error(&radiance(&format!(",compression={settings}")), &exact));
        assert!(cpca < 0.03 && cpca < 0.5 * pca.min(vq), "{cpca} {pca} {vq}");
    }
}

#[test]
fn bytes_are_told_exactly() {
    let scene = scene(Vec3::new(0.8, 0.5, 0.2));
    let part = |settings: &str, part: &str| {
        let footprint = baked(&Prt::default(), &scene, settings).footprint();
        footprint.parts.iter().find(|(name, _)| *name == part).map_or(0, |(_, bytes)| *bytes)
    };
    let settings = "bands=3,directions=16,compression=cpca,clusters=10,components=2";
    let rows = part("bands=3,directions=16", "transfer vectors") / (4 * 27);
    // Means, two axes, and what lets eight numbers be read anywhere.
    assert_eq!(part(settings, "means and axes of clusters"), 4 * (10 * 3 * 27 + 7));
    assert_eq!(part(settings, "weights"), 4 * 2 * rows);
    assert_eq!(part(settings, "clusters of rows"), 2 * rows);
    assert_eq!(part(settings, "transfer vectors"), 0);
}

#[test]
fn batches_change_no_bit() {
    let scene = scene(Vec3::new(0.8, 0.5, 0.2));
    let frame = scene.frame(0);
    let receivers = receivers(&frame);
    let mut baked = baked(&Prt::default(), &scene, "directions=16,compression=cpca,clusters=30,components=3");
    let whole = shade(baked.as_mut(), &frame, &receivers);
    let prepared = baked.prepare(&frame).unwrap();
    for size in [1, 3, 8, 13] {
        let out = in_batches(&*prepared, &receivers, size);
        assert_eq!(out.channels, whole.channels, "{size}");
    }
}

/// One vertex, none, black surfaces: finite, and dark where nothing is reflected.
#[test]
fn ends_are_finite() {
    for settings in ["pca", "vq", "cpca,clusters=4096,components=0", "cpca,clusters=1,components=192"] {
        let settings = format!("directions=16,compression={settings}");
        let mut black = scene(Vec3::ZERO);
        black
            .objects
            .iter_mut()
            .for_each(|object| object.material = Material { albedo: Vec3::ZERO, ..object.material.clone() });
        let mut one = black.clone();
        one.objects.truncate(1);
        one.objects[0].mesh =
            halfshade_scene::Mesh { positions: vec![Vec3::ONE], normals: vec![Vec3::Y], ..Default::default() }.into();
        let none = Scene::at_rest("none", Vec::new(), Environment::constant(Vec3::ONE));
        for scene in [black, one, none] {
            let frame = scene.frame(0);
            let receivers = ReceiverBuffer::vertices(&frame);
            let found = shade(baked(&Prt::default(), &scene, &settings).as_mut(), &frame, &receivers);
            assert!((0..receivers.len()).all(|i| found.at(i) == Vec3::ZERO), "{settings}");
        }
    }
}
