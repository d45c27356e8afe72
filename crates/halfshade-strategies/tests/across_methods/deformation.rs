//! Objects that a skeleton deforms: strategies and the truth against what is the same without one.

use crate::{
    built_scenes::{HAND, VASES},
    common,
};
use glam::{Affine3A, Vec3};
use halfshade_scene::{Frame, Joint, Object, Pose, RadianceBuffer, ReceiverBuffer, Scene, Skin, progress::Silent};
use halfshade_strategies::{ray_traced::RayTraced, sh_exp::ShExp};
use halfshade_strategy::Strategy;
use halfshade_truth::{Geometry, Options, Tracer, estimate};

/// The same scene, in which every object stays and a skeleton of one joint moves its mesh.
fn by_skeletons(scene: &Scene) -> Scene {
    let by_skeleton = |object: &Object| {
        let joint = Joint { parent: None, motion: object.motion.clone(), joint_from_rest: Affine3A::IDENTITY };
        let influences = vec![[(0, 1.0), (0, 0.0), (0, 0.0), (0, 0.0)]; object.mesh.positions.len()];
        object.clone().pose(Pose::IDENTITY).skin(Skin { joints: vec![joint], influences, ..Skin::default() })
    };
    Scene { objects: scene.objects.iter().map(by_skeleton).collect(), ..scene.clone() }
}

fn shade(strategy: &dyn Strategy, scene: &Scene, frame: &Frame<'_>, settings: &str) -> RadianceBuffer {
    let mut baked = common::baked(strategy, scene, settings);
    // From another frame to this one: nothing of the other may stay.
    baked.prepare(&scene.frame(0)).unwrap();
    common::shade(baked.as_mut(), frame, &ReceiverBuffer::vertices(frame))
}

/// Root mean square of the differences, and the largest.
fn differences(a: &RadianceBuffer, b: &RadianceBuffer) -> (f64, f64) {
    let pairs = a.channels.iter().flatten().zip(b.channels.iter().flatten());
    let (squares, most) = pairs
        .map(|(a, b)| f64::from((a - b).abs()))
        .fold((0.0, 0.0_f64), |(sum, most), difference| (sum + difference * difference, most.max(difference)));
    ((squares / (3 * a.len()) as f64).sqrt(), most)
}

#[test]
fn one_joint_moves_an_object_as_its_pose_does() {
    let posed = &*VASES;
    let skinned = by_skeletons(posed);
    let frames = [posed.frame(40), skinned.frame(40)];
    // Objects that deform have own occlusion from their spheres, others from their meshes; and the ground is seen at rest.
    for settings in [
        "spheres-alone",
        "spheres-alone,intersections=precomputed,projection=product",
        "spheres-alone,levels=cluster,branching=2,cut-angle=25",
    ] {
        let [a, b] = frames.each_ref().map(|frame| shade(&ShExp, frame.scene, frame, settings));
        let (rms, most) = differences(&a, &b);
        // A receiver between two clusters, or a cluster on the edge of a level, may go either way.
        let bound = if settings.contains("cluster") { (2e-3, 0.05) } else { (2e-5, 2e-3) };
        assert!(rms < bound.0 && most < bound.1, "{settings}: {rms} {most}");
    }
    let [a, b] = frames.each_ref().map(|frame| shade(&RayTraced, frame.scene, frame, "samples=4"));
    // Rounding moves a ray past an edge now and then.
    assert!(differences(&a, &b).0 < 0.01, "{:?}", differences(&a, &b));
    let spheres = frames.each_ref().map(|frame| Tracer::new(frame).sphere_count());
    assert_eq!(spheres[0], spheres[1]);
    for geometry in [Geometry::Mesh, Geometry::Spheres(Default::default())] {
        let [a, b] = frames.each_ref().map(|frame| {
            let all = ReceiverBuffer::vertices(frame);
            let some: Vec<u32> = (0..all.len() as u32).step_by(97).collect();
            let receivers = ReceiverBuffer::gathered(all.view(), &some);
            let options = Options { samples: 64, bounces: 1, geometry, ..Options::default() };
            estimate(&Tracer::new(frame), receivers.view(), &options, &Silent).radiance
        });
        assert!(differences(&a, &b).0 < 0.01, "{geometry:?}: {:?}", differences(&a, &b));
    }
}

/// Against the truth over the same spheres, a bent hand is shaded as well as an open one; and what doesn't follow isn't.
#[test]
fn a_bent_hand_is_shaded_as_well_as_an_open_one() {
    let scene = &*HAND;
    let error = |index: usize, blockers_at: usize| {
        let frame = scene.frame(index);
        let all = ReceiverBuffer::vertices(&frame);
        let some: Vec<u32> = (0..all.len() as u32).step_by(23).collect();
        let receivers = ReceiverBuffer::gathered(all.view(), &some);
        let geometry = Geometry::Spheres(Default::default());
        let options = Options { samples: 256, bounces: 1, geometry, ..Options::default() };
        let truth = estimate(&Tracer::new(&frame), receivers.view(), &options, &Silent);
        let shape_of_another = Frame { deformed: scene.frame(blockers_at).deformed, ..scene.frame(index) };
        let radiance =
            common::shaded(&ShExp, scene, &shape_of_another, &receivers, "spheres-alone,overlap=independent");
        differences(&radiance, &truth.radiance).0 / truth.unshadowed_mean
    };
    let (open, bent, left_behind) = (error(0, 0), error(60, 60), error(60, 0));
    assert!(open < 0.1 && bent < 1.15 * open && left_behind > 1.5 * bent, "{open} {bent} {left_behind}");
}

#[test]
fn at_rest_in_a_frame_of_its_own_nothing_is_prepared_again() {
    let scene = &*HAND;
    let receivers = ReceiverBuffer::vertices(&scene.frame(60));
    let mut baked = common::baked(&ShExp, scene, "");
    let mut shade = |frame: &Frame<'_>| common::shade(baked.as_mut(), frame, &receivers);
    let first = shade(&scene.frame(60));
    assert_ne!(first, shade(&scene.frame(20)));
    assert_eq!(first, shade(&scene.frame(60)));
    assert!(first.channels.iter().flatten().all(|value| value.is_finite()) && first.at(0) != Vec3::ZERO);
}
