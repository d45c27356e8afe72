//! Light below surfaces against closed forms: a plane far from its edges gives back a known part of what enters.

use glam::Vec3;
use halfshade_scene::{
    Environment, Material, Object, Pose, ReceiverBuffer, Scene, Subsurface, SurfacePoint, builtin::shapes,
    progress::Silent,
};
use halfshade_truth::{Estimate, Options, Tracer, Transport, estimate};

const ALBEDO: Vec3 = Vec3::new(1.0, 0.8, 0.5);

fn stone() -> Subsurface {
    Subsurface {
        absorption: Vec3::new(0.5, 2.0, 8.0),
        reduced_scattering: Vec3::new(200.0, 100.0, 60.0),
        refractive_index: 1.5,
    }
}

fn plane() -> Object {
    let material = Material { subsurface: Some(stone()), ..Material::new(ALBEDO) };
    Object::new("plane", shapes::plane(6)).material(material)
}

/// Radiance of the plane under a white sky: albedo times the dipole's total reflectance [Jensen2001, 2.4] times the share that enters,
/// `∫ 2 F_t(x) x dx`.
fn exact() -> [f64; 3] {
    let medium = stone();
    let eta = f64::from(medium.refractive_index);
    let steps = 100_000;
    let share = |k: i32| {
        let cosine = (f64::from(k) + 0.5) / f64::from(steps);
        let refracted = (1.0 - (1.0 - cosine * cosine) / (eta * eta)).sqrt();
        let across = (cosine - eta * refracted) / (cosine + eta * refracted);
        let along = (eta * cosine - refracted) / (eta * cosine + refracted);
        2.0 * cosine * (1.0 - 0.5 * (across * across + along * along)) / f64::from(steps)
    };
    let entering: f64 = (0..steps).map(share).sum();
    std::array::from_fn(|channel| {
        let [absorption, scattering] = [medium.absorption, medium.reduced_scattering].map(|of| f64::from(of[channel]));
        let alpha = scattering / (absorption + scattering);
        let inner = -1.440 / (eta * eta) + 0.710 / eta + 0.668 + 0.0636 * eta;
        let root = (3.0 * (1.0 - alpha)).sqrt();
        let total = 0.5 * alpha * (1.0 + (-4.0 / 3.0 * (1.0 + inner) / (1.0 - inner) * root).exp()) * (-root).exp();
        f64::from(ALBEDO[channel]) * entering * total
    })
}

/// Whether values scatter about `expected` as their standard errors say.
fn assert_known(truth: &Estimate, expected: [f64; 3]) {
    let (mut squares, mut sum, mut count) = (0.0, 0.0, 0.0);
    for (channel, expected) in expected.into_iter().enumerate() {
        for i in 0..truth.radiance.len() {
            let error = f64::from(truth.standard_error.channels[channel][i]);
            let z = (f64::from(truth.radiance.channels[channel][i]) - expected) / error;
            assert!(
                error > 0.0 && error < 0.2 * expected && z.abs() < 6.0,
                "{channel} {i}: {z}, {error} of {expected}"
            );
            squares += z * z;
            sum += z;
            count += 1.0;
        }
    }
    let (spread, mean) = ((squares / count).sqrt(), sum / count);
    assert!((0.6..1.5).contains(&spread) && mean.abs() < 0.35, "{mean} {spread}");
}

/// Receivers on the plane, far from its edges.
fn on_plane(scene: &Scene) -> ReceiverBuffer {
    let tracer = Tracer::new(&scene.frame(0));
    let mut receivers = ReceiverBuffer::default();
    for i in 0..48 {
        let place = Vec3::new(0.4 * (0.618 * i as f32).fract() - 0.2, 1.0, 0.4 * (0.755 * i as f32).fract() - 0.2);
        let hit = tracer.closest_hit(place, Vec3::NEG_Y).expect("the plane is below");
        receivers.add(&tracer.receiver_at(&hit, Vec3::NEG_Y));
    }
    receivers
}

#[test]
fn a_plane_gives_back_the_closed_form() {
    let scene = Scene::at_rest("plane", vec![plane()], Environment::constant(Vec3::ONE));
    let receivers = on_plane(&scene);
    let tracer = Tracer::new(&scene.frame(0));
    for (transport, bounces) in [(Transport::Shadowed, 0), (Transport::Unshadowed, 0), (Transport::Shadowed, 2)] {
        let options = Options { samples: 256, transport, bounces, ..Options::default() };
        let truth = estimate(&tracer, receivers.view(), &options, &Silent);
        assert_known(&truth, exact());
        let unshadowed = exact().iter().sum::<f64>() / 3.0;
        assert!((truth.unshadowed_mean / unshadowed - 1.0).abs() < 0.02, "{} {unshadowed}", truth.unshadowed_mean);
        // The same seed, the same bits, however receivers are split.
        let some: Vec<u32> = (0..48).step_by(5).collect();
        let part = estimate(&tracer, ReceiverBuffer::gathered(receivers.view(), &some).view(), &options, &Silent);
        assert!(some.iter().enumerate().all(|(i, &place)| part.radiance.at(i) == truth.radiance.at(place as usize)));
    }
}

/// A speck that looks down sees nothing but the plane.
#[test]
fn others_see_what_leaves() {
    let mut speck = ReceiverBuffer::default();
    (0..24).for_each(|i| speck.push(Vec3::new(0.01 * i as f32 - 0.12, 0.02, 0.0), Vec3::NEG_Y, Vec3::splat(0.5), 1));
    let nothing =
        Object::new("speck", shapes::plane(1)).pose(Pose { scale: 1e-6, ..Pose::from_translation(9.0 * Vec3::Y) });
    let objects = vec![plane(), nothing];
    let scene = Scene { bounces: 1, ..Scene::at_rest("speck", objects, Environment::constant(Vec3::ONE)) };
    let options = Options { samples: 512, bounces: 1, ..Options::default() };
    let truth = estimate(&Tracer::new(&scene.frame(0)), speck.view(), &options, &Silent);
    assert_known(&truth, exact().map(|radiance| 0.5 * radiance));
}

/// From behind, and where there is no light or nothing scatters, it is black.
#[test]
fn ends_are_black() {
    let mut scene = Scene::at_rest("plane", vec![plane()], Environment::constant(Vec3::ONE));
    let mut receivers = on_plane(&scene);
    let options = Options { samples: 32, bounces: 1, ..Options::default() };
    let all_black = |scene: &Scene, receivers: &ReceiverBuffer| {
        let truth = estimate(&Tracer::new(&scene.frame(0)), receivers.view(), &options, &Silent);
        (0..receivers.len()).all(|i| truth.radiance.at(i) == Vec3::ZERO && truth.standard_error.at(i) == Vec3::ZERO)
    };
    assert!(!all_black(&scene, &receivers));
    scene.objects[0].material.subsurface = Some(Subsurface { reduced_scattering: Vec3::ZERO, ..stone() });
    assert!(all_black(&scene, &receivers));
    scene.objects[0].material.subsurface = Some(stone());
    let dark = Scene { environment: Environment::constant(Vec3::ZERO), ..scene.clone() };
    assert!(all_black(&dark, &receivers));
    for surface in &mut receivers.surface {
        let SurfacePoint::Triangle { from_behind, .. } = surface else { panic!("between vertices") };
        *from_behind = true;
    }
    assert!(all_black(&scene, &receivers));
}
