//! Translucent objects against closed forms and the truth.

use crate::prt::{
    convergence::assert_converged,
    scenes::{limited_light, torus_over_ground, vertices},
};
use glam::Vec3;
use halfshade_scene::{
    Environment, Material, Motion, Object, Pose, ReceiverBuffer, Reflectance, Scene, Subsurface, builtin::shapes,
    progress::Silent,
};
use halfshade_strategies::Prt;
use halfshade_strategy::{Strategy, StrategyError};
use halfshade_truth::{Options, Tracer, estimate};

fn medium(absorption: Vec3, reduced_scattering: Vec3, refractive_index: f32) -> Subsurface {
    Subsurface { absorption, reduced_scattering, refractive_index }
}

fn translucent(medium: Subsurface, albedo: Vec3) -> Material {
    Material { subsurface: Some(medium), ..Material::new(albedo) }
}

/// A torus of soap over the ground.
fn soap_over_ground(environment: Environment, bounces: usize) -> Scene {
    let mut scene = torus_over_ground(environment, [Vec3::new(0.7, 0.5, 0.3), Vec3::ONE]);
    let soap = medium(Vec3::new(0.1, 0.3, 0.9), Vec3::new(12.0, 9.0, 7.0), 1.4);
    scene.objects[1].material = translucent(soap, Vec3::new(1.0, 0.9, 0.8));
    Scene { bounces, ..scene }
}

/// Total reflectance of an endless plane [Jensen2001, 2.4].
fn total(medium: &Subsurface) -> [f64; 3] {
    std::array::from_fn(|channel| {
        let [absorption, scattering] = [medium.absorption, medium.reduced_scattering].map(|of| f64::from(of[channel]));
        let (alpha, eta) = (scattering / (absorption + scattering), f64::from(medium.refractive_index));
        let inner = -1.440 / (eta * eta) + 0.710 / eta + 0.668 + 0.0636 * eta;
        let root = (3.0 * (1.0 - alpha)).sqrt();
        0.5 * alpha * (1.0 + (-4.0 / 3.0 * (1.0 + inner) / (1.0 - inner) * root).exp()) * (-root).exp()
    })
}

/// Share of light from all directions that enters, ∫ 2 F_t(x) x dx, by Fresnel's amplitudes for angles.
fn entering(eta: f64) -> f64 {
    let steps = 200_000;
    let step = std::f64::consts::FRAC_PI_2 / f64::from(steps);
    let share = |k: i32| {
        let incident = (f64::from(k) + 0.5) * step;
        let refracted = (incident.sin() / eta).asin();
        let [less, more] = [incident - refracted, incident + refracted];
        let reflected = 0.5 * ((less.sin() / more.sin()).powi(2) + (less.tan() / more.tan()).powi(2));
        step * (2.0 * incident).sin() * (1.0 - reflected)
    };
    (0..steps).map(share).sum()
}

/// Under a white sky the middle of a wide plane is as bright as what enters times what comes back.
#[test]
fn a_plane_under_a_white_sky_is_the_closed_form() {
    let stone = medium(Vec3::new(0.5, 2.0, 8.0), Vec3::new(200.0, 100.0, 60.0), 1.5);
    let albedo = Vec3::new(1.0, 0.8, 0.5);
    let plane = Object::new("plane", shapes::plane(16)).material(translucent(stone, albedo));
    let scene = Scene::at_rest("plane", vec![plane], Environment::constant(Vec3::ONE));
    for settings in ["directions=64", "transfer=unshadowed,bands=2"] {
        let (receivers, found) = vertices(&scene, settings);
        let middle = (0..receivers.len()).find(|&i| receivers.view().position_at(i) == Vec3::ZERO).unwrap();
        for channel in 0..3 {
            let exact = f64::from(albedo[channel]) * entering(1.5) * total(&stone)[channel];
            let found = f64::from(found.at(middle)[channel]);
            assert!((found - exact).abs() < 5e-3 * exact, "{settings} {channel}: {found} {exact}");
        }
    }
}

/// Where paths of light are short, nothing spreads: a surface of the medium's reflectance, but for what is mirrored.
#[test]
fn short_paths_are_a_diffuse_surface() {
    let light = limited_light(3, 51);
    let dense = medium(Vec3::splat(2e4), Vec3::new(3e5, 1e5, 2e4), 1.0);
    let mut scene = torus_over_ground(light, [Vec3::splat(0.5), Vec3::ONE]);
    let colour = Vec3::from(total(&dense).map(|x| x as f32));
    scene.objects[1].material = Material::new(colour);
    let settings = "directions=256";
    let (_, diffuse) = vertices(&scene, settings);
    scene.objects[1].material = translucent(dense, Vec3::ONE);
    let (receivers, found) = vertices(&scene, settings);
    for i in 0..receivers.len() {
        let (found, expected) = (found.at(i), diffuse.at(i));
        assert!((found - expected).abs().max_element() < 0.01 * expected.max_element(), "{i}: {found} {expected}");
    }
}

#[test]
fn translucent_transfer_is_the_truth_under_limited_light() {
    for (bounces, seed) in [(0, 52), (1, 53)] {
        let scene = soap_over_ground(limited_light(3, seed), bounces);
        let all = ReceiverBuffer::vertices(&scene.frame(0));
        let some: Vec<u32> = (0..all.len() as u32).step_by(5).collect();
        let (_, radiance) = vertices(&scene, "bands=3,directions=2048");
        let mut found = halfshade_scene::RadianceBuffer::zeros(some.len());
        some.iter().enumerate().for_each(|(i, &place)| found.view_mut().set(i, radiance.at(place as usize)));
        let receivers = ReceiverBuffer::gathered(all.view(), &some);
        assert_converged(&format!("{bounces} bounces"), &scene, &receivers, &found);
    }
}

/// Unshadowed, a ball of few triangles shows what linear light between vertices costs: little.
#[test]
fn unshadowed_transfer_is_the_unshadowed_truth() {
    let wax = medium(Vec3::splat(0.2), Vec3::new(9.0, 6.0, 4.0), 1.4);
    let ball = Object::new("ball", shapes::sphere(16)).material(translucent(wax, Vec3::ONE));
    let scene = Scene::at_rest("ball", vec![ball], limited_light(3, 54));
    let (all, found) = vertices(&scene, "bands=3,transfer=unshadowed");
    let some: Vec<u32> = (0..all.len() as u32).step_by(4).collect();
    let receivers = ReceiverBuffer::gathered(all.view(), &some);
    let options = Options { samples: 256, transport: halfshade_truth::Transport::Unshadowed, ..Options::default() };
    let truth = estimate(&Tracer::new(&scene.frame(0)), receivers.view(), &options, &Silent);
    assert!(truth.rms_standard_error < 0.05 * truth.unshadowed_mean);
    let apart = |i: usize| (found.at(some[i] as usize) - truth.radiance.at(i)).as_dvec3();
    let mean = (0..receivers.len()).map(apart).sum::<glam::DVec3>() / receivers.len() as f64;
    assert!(mean.abs().max_element() < 0.01 * truth.unshadowed_mean, "{mean} of {}", truth.unshadowed_mean);
}

#[test]
fn ends_are_finite_and_bounded() {
    let media = [
        medium(Vec3::splat(1e6), Vec3::splat(1e6), 2.5),
        medium(Vec3::ZERO, Vec3::splat(1e6), 1.0),
        medium(Vec3::ZERO, Vec3::splat(1e-6), 1.3),
        medium(Vec3::splat(3.0), Vec3::ZERO, 1.3),
    ];
    for (medium, bounces) in media.into_iter().zip([0, 2, 2, 1]) {
        for albedo in [Vec3::ZERO, Vec3::ONE] {
            let mut material = translucent(medium, albedo);
            material.reflectance = Reflectance::ModifiedPhong { specular: Vec3::splat(0.2), exponent: 5.0 };
            let ball = Object::new("ball", shapes::sphere(4)).material(material);
            let objects = vec![Object::new("ground", shapes::plane(2)).albedo(albedo), ball];
            let mut scene = Scene::at_rest("ends", objects, Environment::constant(Vec3::ONE));
            scene.camera.eye = Vec3::new(1.5, 3.0, 2.5);
            scene.bounces = bounces;
            let (receivers, found) = vertices(&scene, "bands=2,directions=64");
            for i in 0..receivers.len() {
                let radiance = found.at(i);
                assert!(radiance.min_element() > -0.05 && radiance.max_element() < 1.4, "{medium:?}: {radiance}");
            }
            let options = Options { samples: 16, bounces, ..Options::default() };
            let truth = estimate(&Tracer::new(&scene.frame(0)), receivers.view(), &options, &Silent);
            assert!((0..receivers.len()).all(|i| truth.radiance.at(i).is_finite()));
        }
    }
}

#[test]
fn what_moves_is_refused() {
    let mut scene = soap_over_ground(Environment::constant(Vec3::ONE), 0);
    let pose = Pose::from_translation(2.0 * Vec3::Y);
    scene.objects[1].motion = Motion::Keyframes(vec![(0.0, Pose::IDENTITY), (1.0, pose)]);
    scene.frame_count = 31;
    let strategy = Prt::default();
    let params = strategy.info().parse("moving=volume").unwrap();
    let error = strategy.bake(&scene, &params, &Silent).err().expect("refused");
    assert!(matches!(&error, StrategyError::Unsupported(reason) if reason.contains("`torus`")), "{error}");
}
