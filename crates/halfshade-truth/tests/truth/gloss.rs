//! Glossy receivers against closed forms and against quadrature in double precision, with every model's formula written
//! out here once more.

use crate::scenes::{assert_agrees, ball, icosphere, normals_around, object, on_the_ground, run, scene, square};
use glam::{DVec3, Vec3};
use halfshade_scene::{
    Environment, LafortuneLobe, Material, Object, Pose, ReceiverBuffer, Reflectance, Scene, SphereLight,
    light::{EnvironmentMap, Sun},
    spheres::AdjustRule,
};
use halfshade_truth::{Geometry, Options, Transport};
use std::f64::consts::{PI, TAU};

const BLACK: Environment = Environment::constant(Vec3::ZERO);
const SPHERES: Geometry = Geometry::Spheres(AdjustRule::Continuous);

fn phong(specular: f64, exponent: f64) -> Reflectance {
    Reflectance::Phong { specular: Vec3::splat(specular as f32), exponent: exponent as f32 }
}

fn modified(specular: f64, exponent: f64) -> Reflectance {
    Reflectance::ModifiedPhong { specular: Vec3::splat(specular as f32), exponent: exponent as f32 }
}

/// Reflects as a diffuse surface of albedo π k does: `(C_z n·v n·v_o)^0` is 1.
fn diffuse_in_disguise(k: f64) -> Reflectance {
    let lobe = LafortuneLobe { scale: Vec3::splat(k as f32), axis: Vec3::Z, exponent: 0.0 };
    Reflectance::Lafortune { lobes: vec![lobe] }
}

fn with(object: Object, albedo: f32, reflectance: Reflectance) -> Object {
    object.material(Material { reflectance, ..Material::new(Vec3::splat(albedo)) })
}

/// A black speck far below that carries the material, seen from `eye`.
fn speck(reflectance: Reflectance, environment: Environment, lights: Vec<SphereLight>, eye: Vec3) -> Scene {
    let pose = Pose { scale: 1e-3, ..Pose::from_translation(Vec3::new(0.0, -60.0, 0.0)) };
    let mut scene = scene(vec![with(object(square(1), pose), 0.0, reflectance)], environment, lights);
    scene.camera.eye = eye;
    scene
}

/// Receivers at `places` that face along `normals`, without a diffuse part.
fn black(places: impl IntoIterator<Item = (Vec3, Vec3)>) -> ReceiverBuffer {
    let mut receivers = ReceiverBuffer::default();
    places.into_iter().for_each(|(place, normal)| receivers.push(place, normal, Vec3::ZERO, 0));
    receivers
}

fn samples(samples: usize) -> Options {
    Options { samples, ..Options::default() }
}

/// `max(r·v, 0)^e` as the papers write it.
fn mirrored_power(n: DVec3, o: DVec3, v: DVec3, e: f64) -> f64 {
    (2.0 * n.dot(o) * n - o).normalize().dot(v).clamp(0.0, 1.0).powf(e)
}

/// ∫ f over directions by the midpoint rule in equal steps of `∫ (axis·v)^e dv`, e the `focus`.
fn about(axis: DVec3, focus: f64, steps: usize, f: impl Fn(DVec3) -> f64) -> f64 {
    let (t, b) = axis.any_orthonormal_pair();
    let mut sum = 0.0;
    for ring in 0..steps {
        let part = (ring as f64 + 0.5) / steps as f64;
        let below = -(part.ln() / (focus + 1.0)).exp_m1();
        let (sine, cosine) = ((below * (2.0 - below)).sqrt(), 1.0 - below);
        let density = (focus + 1.0) / TAU * cosine.powf(focus);
        for spoke in 0..steps {
            let (y, x) = (TAU * ((spoke as f64 + 0.5) / steps as f64 + 0.618_034 * ring as f64)).sin_cos();
            sum += f(sine * (x * t + y * b) + cosine * axis) / density;
        }
    }
    sum / (steps * steps) as f64
}

/// ∫ f over a cap by the midpoint rule.
fn over_cap(axis: DVec3, sine: f64, steps: usize, f: impl Fn(DVec3) -> f64) -> f64 {
    let (t, b) = axis.any_orthonormal_pair();
    let height = sine * sine / (1.0 + (1.0 - sine * sine).sqrt());
    let mut sum = 0.0;
    for ring in 0..steps {
        let below = height * (ring as f64 + 0.5) / steps as f64;
        let across = (below * (2.0 - below)).sqrt();
        for spoke in 0..steps {
            let (y, x) = (TAU * ((spoke as f64 + 0.5) / steps as f64 + 0.618_034 * ring as f64)).sin_cos();
            sum += f(across * (x * t + y * b) + (1.0 - below) * axis);
        }
    }
    sum * TAU * height / (steps * steps) as f64
}

#[test]
fn facing_the_eye_under_constant_light_lobes_have_their_closed_form() {
    let eye = Vec3::new(0.3, 2.0, -0.4);
    let around: Vec<_> = normals_around(DVec3::Y, 3.0, 40);
    for exponent in [0.0, 1.0, 17.0, 1e3, 1e5] {
        for (model, expected) in [(phong(0.7, exponent), 0.7 * TAU / (exponent + 1.0)), (modified(0.7, exponent), 0.7)]
        {
            let scene = speck(model, Environment::constant(Vec3::splat(2.0)), vec![], eye);
            let receivers = black(around.iter().map(|n| (eye - 1.5 * n.as_vec3(), n.as_vec3())));
            for transport in [Transport::Shadowed, Transport::Unshadowed] {
                let estimate = run(&scene, &receivers, &Options { transport, ..samples(1024) });
                let relative = 2.0 * expected;
                assert_agrees(&estimate, |_| 2.0 * expected, 2e-3 * relative, 2e-5 * relative);
                assert!((estimate.unshadowed_mean / relative - 1.0).abs() < 2e-3);
            }
        }
    }
}

/// Receivers at the origin from which the eye at (1, 2, 0.5) is seen under all angles, a few from below.
fn tilted(count: usize) -> (Vec<DVec3>, DVec3, Vec3) {
    let eye = Vec3::new(1.0, 2.0, 0.5);
    let to_eye = eye.as_dvec3().normalize();
    (normals_around(to_eye, 1.7, count).iter().map(|n| n.as_vec3().as_dvec3()).collect(), to_eye, eye)
}

#[test]
fn under_constant_light_the_horizon_cuts_lobes_as_quadrature_says() {
    let (normals, o, eye) = tilted(24);
    for exponent in [0.5, 12.0, 900.0] {
        for with_cosine in [false, true] {
            let scale = if with_cosine { (exponent + 2.0) / TAU } else { 1.0 };
            let model = if with_cosine { modified(1.0, exponent) } else { phong(1.0, exponent) };
            let scene = speck(model, Environment::constant(Vec3::ONE), vec![], eye);
            let receivers = black(normals.iter().map(|n| (Vec3::ZERO, n.as_vec3())));
            let expected: Vec<f64> = normals
                .iter()
                .map(|&n| {
                    let cosine = |v: DVec3| if with_cosine { n.dot(v) } else { 1.0 };
                    let f = |v: DVec3| if n.dot(v) > 0.0 { cosine(v) * mirrored_power(n, o, v, exponent) } else { 0.0 };
                    let sees = n.dot(o) > 0.0;
                    if sees { scale * about((2.0 * n.dot(o) * n - o).normalize(), exponent, 700, f) } else { 0.0 }
                })
                .collect();
            let largest = expected.iter().copied().fold(0.0, f64::max);
            assert_agrees(&run(&scene, &receivers, &samples(1024)), |i| expected[i], 6e-3 * largest, 2e-4 * largest);
        }
    }
}

#[test]
fn spherical_lights_from_small_to_all_around_agree_with_quadrature() {
    let (normals, o, eye) = tilted(20);
    for (center, radius) in [
        (DVec3::new(0.5, 3.0, 1.0), 0.05),
        (DVec3::new(0.5, 3.0, 1.0), 1.2),
        (DVec3::new(0.3, 1.0, 0.0), 0.9),
        (DVec3::new(0.1, 0.2, 0.0), 4.0),
    ] {
        let light = SphereLight { center: center.as_vec3(), radius: radius as f32, radiance: Vec3::splat(3.0) };
        for exponent in [1.0, 40.0, 3000.0] {
            let scene = speck(phong(1.0, exponent), BLACK, vec![light], eye);
            let receivers = black(normals.iter().map(|n| (Vec3::ZERO, n.as_vec3())));
            let sine = f64::from(light.radius) / light.center.as_dvec3().length();
            let expected: Vec<f64> = normals
                .iter()
                .map(|&n| {
                    let r = (2.0 * n.dot(o) * n - o).normalize();
                    let f = |v: DVec3| if n.dot(v) > 0.0 { 3.0 * mirrored_power(n, o, v, exponent) } else { 0.0 };
                    let axis = light.center.as_dvec3().normalize();
                    match (n.dot(o) > 0.0, sine >= 1.0, exponent > 100.0 && sine > 0.1) {
                        (false, _, _) => 0.0,
                        (_, true, _) => about(r, exponent, 700, f),
                        (_, _, false) => over_cap(axis, sine, 700, f),
                        (_, _, true) => about(r, exponent, 1000, |v| {
                            if v.dot(axis) > 0.0 && v.cross(axis).length() < sine { f(v) } else { 0.0 }
                        }),
                    }
                })
                .collect();
            let largest = expected.iter().copied().fold(0.0, f64::max);
            let estimate = run(&scene, &receivers, &samples(1024));
            assert_agrees(&estimate, |i| expected[i], 6e-3 * largest + 1e-9, 3e-4 * largest + 1e-9);
        }
    }
}

/// A lobe of 10^5 whose integral is 1 shows what it mirrors: a light's own radiance, however bright, and nothing beside
/// it.
#[test]
fn a_sharp_lobe_is_a_mirror() {
    let exponent = 1e5;
    let eye = Vec3::new(0.0, 2.0, 2.0);
    for radiance in [1.0, 1e6] {
        let light = SphereLight { center: Vec3::new(0.0, 2.0, -2.0), radius: 0.4, radiance: Vec3::splat(radiance) };
        let scene = speck(phong((exponent + 1.0) / TAU, exponent), BLACK, vec![light], eye);
        // Mirrored in the ground the eye looks from (0, -2, 2): through points near the origin it sees the light's
        // middle.
        let middle = black((0..40).map(|i| (Vec3::new(0.002 * i as f32 - 0.04, 0.0, 0.0), Vec3::Y)));
        let estimate = run(&scene, &middle, &samples(256));
        assert_agrees(&estimate, |_| f64::from(radiance), 8e-3 * f64::from(radiance), 2e-5 * f64::from(radiance));
        let beside = black((0..40).map(|i| (Vec3::new(0.5 + 0.01 * i as f32, 0.0, 0.0), Vec3::Y)));
        let estimate = run(&scene, &beside, &samples(256));
        assert!(estimate.radiance.channels[0].iter().all(|&value| value < 1e-6 * radiance));
        // Not even the rim, where some samples see the light, has a value that stands out.
        let rim = black((0..400).map(|i| (Vec3::new(0.001 * i as f32, 0.0, 0.0), Vec3::Y)));
        let estimate = run(&scene, &rim, &samples(256));
        assert!(estimate.radiance.channels[0].iter().all(|&value| value < 1.05 * radiance));
        assert!(estimate.rms_standard_error < 1e-2 * f64::from(radiance));
    }
}

#[test]
fn maps_and_suns_agree_with_quadrature() {
    let (normals, o, eye) = tilted(20);
    let texels = (0..16 * 8).map(|i| Vec3::splat(if i % 13 == 0 { 20.0 } else { 0.3 + (i % 5) as f32 * 0.2 }));
    let map = EnvironmentMap::new(16, 8, texels.collect()).unwrap();
    let sun =
        Sun { direction: Vec3::new(-0.3, 0.8, 0.4).normalize(), angular_radius: 0.1, radiance: Vec3::splat(400.0) };
    let environment = Environment { sun: Some(sun), ..Environment::map(map.clone()) };
    for exponent in [1.0, 30.0, 5000.0] {
        let scene = speck(modified(1.0, exponent), environment.clone(), vec![], eye);
        let receivers = black(normals.iter().map(|n| (Vec3::ZERO, n.as_vec3())));
        let scale = (exponent + 2.0) / TAU;
        let expected: Vec<f64> = normals
            .iter()
            .map(|&n| {
                if n.dot(o) <= 0.0 {
                    return 0.0;
                }
                let r = (2.0 * n.dot(o) * n - o).normalize();
                let f = |v: DVec3| scale * n.dot(v).max(0.0) * mirrored_power(n, o, v, exponent);
                let from_map = about(r, exponent, 1500, |v| f(v) * f64::from(map.radiance(v.as_vec3()).x));
                let sine = f64::from(sun.angular_radius).sin();
                from_map + 400.0 * over_cap(sun.direction.as_dvec3().normalize(), sine, 900, f)
            })
            .collect();
        let largest = expected.iter().copied().fold(0.0, f64::max);
        assert_agrees(&run(&scene, &receivers, &samples(4096)), |i| expected[i], 4e-3 * largest, 1e-3 * largest);
    }
}

#[test]
fn a_ball_hides_its_part_of_a_lobe_in_both_geometries() {
    let (center, radius) = (DVec3::new(0.2, 1.0, -0.6), 0.5);
    for exponent in [2.0, 50.0] {
        let ground = with(
            object(square(1), Pose { scale: 0.01, ..Pose::from_translation(Vec3::Y * -3.0) }),
            0.0,
            phong(1.0, exponent),
        );
        let mut scene =
            scene(vec![ground, ball(center.as_vec3(), radius as f32)], Environment::constant(Vec3::ONE), vec![]);
        scene.camera.eye = Vec3::new(0.0, 1.0, 1.5);
        let places: Vec<_> = (0..50).map(|i| (0.2 * (i % 10) as f32 - 1.0, 0.15 * (i / 10) as f32 - 0.5)).collect();
        let mut receivers = on_the_ground(places);
        receivers.albedo = std::array::from_fn(|_| vec![0.0; 50]);
        let expected: Vec<f64> = (0..50)
            .map(|i| {
                let position = receivers.view().position_at(i).as_dvec3();
                let o = (scene.camera.eye.as_dvec3() - position).normalize();
                let offset = center - position;
                let (axis, sine) = (offset.normalize(), radius / offset.length());
                about(DVec3::new(-o.x, o.y, -o.z), exponent, 900, |v| {
                    let hidden = v.dot(axis) > 0.0 && v.cross(axis).length() < sine;
                    if v.y > 0.0 && !hidden { mirrored_power(DVec3::Y, o, v, exponent) } else { 0.0 }
                })
            })
            .collect();
        for geometry in [Geometry::Mesh, SPHERES] {
            let estimate = run(&scene, &receivers, &Options { geometry, ..samples(1024) });
            assert_agrees(&estimate, |i| expected[i], 2e-3 * TAU, 5e-4);
        }
    }
}

#[test]
fn the_inside_of_a_disguised_diffuse_sphere_gives_the_geometric_series() {
    let k = 0.3 / PI;
    let mut walls = icosphere(5);
    walls.normals.iter_mut().for_each(|normal| *normal = -*normal);
    let walls = with(object(walls, Pose::IDENTITY), 0.2, diffuse_in_disguise(k));
    let light = SphereLight { center: Vec3::ZERO, radius: 0.1, radiance: Vec3::splat(100.0) };
    let mut scene = scene(vec![walls], BLACK, vec![light]);
    scene.camera.eye = Vec3::new(0.1, 0.2, 0.0);
    let mut receivers = ReceiverBuffer::default();
    for normal in normals_around(DVec3::Y, 3.1, 60) {
        receivers.push(0.999 * normal.as_vec3(), -normal.as_vec3(), Vec3::splat(0.7), 0);
    }
    let direct = (0.1_f64 / 0.999).powi(2) * 100.0;
    for bounces in 0..=3 {
        let series: f64 = (1..=bounces).map(|b| 0.5_f64.powi(b)).sum();
        let estimate = run(&scene, &receivers, &Options { bounces: bounces as usize, ..samples(1024) });
        // The receivers' albedo is 0.7, and 0.3 besides.
        assert_agrees(&estimate, |_| direct + series, 1e-2, 2e-3 + 5e-4 * series);
    }
}

#[test]
fn disguised_diffuse_spheres_reflect_in_the_sphere_geometry_too() {
    let image = |disguised: bool| {
        let (albedo, model) =
            if disguised { (0.5, diffuse_in_disguise(0.3 / PI)) } else { (0.8, Reflectance::Lambert) };
        let ball = with(ball(Vec3::new(0.0, 1.0, 0.0), 0.7), albedo, model);
        let ground = object(square(1), Pose { scale: 0.01, ..Pose::from_translation(Vec3::Y * -3.0) });
        let scene = scene(vec![ground, ball], Environment::constant(Vec3::ONE), vec![]);
        let receivers = on_the_ground((0..60).map(|i| (0.05 * i as f32 - 1.5, 0.2)));
        run(&scene, &receivers, &Options { geometry: SPHERES, bounces: 1, ..samples(4096) })
    };
    let plain = image(false);
    assert_agrees(&image(true), |i| f64::from(plain.radiance.at(i).x), 5e-3, 4e-3);
}

/// Sun at the zenith on a glossy plate: it shows receivers that look down on it where it mirrors the sun.
#[test]
fn a_glossy_plate_reflects_the_sun_onto_diffuse_receivers() {
    let (angular_radius, exponent) = (0.01, 20.0);
    let sun = Sun { direction: Vec3::Y, angular_radius, radiance: Vec3::splat(1e4) };
    let plate = with(object(square(3), Pose::IDENTITY), 0.0, phong(0.4, exponent));
    let scene = scene(vec![plate], Environment { sun: Some(sun), ..BLACK }, vec![]);
    let mut receivers = ReceiverBuffer::default();
    (0..36).for_each(|i| {
        let place = Vec3::new(-0.9 + 0.36 * (i % 6) as f32, 0.6, -0.9 + 0.36 * (i / 6) as f32);
        receivers.push(place, Vec3::NEG_Y, Vec3::ONE, 1);
    });
    let from_sun = 1e4 * TAU * (1.0 - f64::from(angular_radius).cos());
    let expected = |i: usize| {
        let at = receivers.view().position_at(i).as_dvec3();
        let (steps, mut sum) = (300, 0.0);
        for cell in 0..steps * steps {
            let place = |j: usize| -1.0 + 2.0 * (j as f64 + 0.5) / steps as f64;
            let offset = DVec3::new(place(cell % steps), 0.0, place(cell / steps)) - at;
            // The cosine to the plate's normal, to the receiver's, and to the mirrored sun are the same.
            let cosine = -offset.normalize().y;
            sum += 0.4 * cosine.powf(exponent) * cosine * cosine / offset.length_squared();
        }
        from_sun * sum * (2.0 / steps as f64).powi(2) / PI
    };
    let expected: Vec<f64> = (0..36).map(expected).collect();
    let estimate = run(&scene, &receivers, &Options { bounces: 1, ..samples(4096) });
    assert_agrees(&estimate, |i| expected[i], 6e-3 * expected[14], 1e-3 * expected[14]);
}

#[test]
fn extremes_stay_finite_and_the_eye_may_be_anywhere() {
    let light = SphereLight { center: Vec3::ZERO, radius: 1e-6, radiance: Vec3::splat(1e6) };
    let lobe = LafortuneLobe { scale: Vec3::splat(1e6), axis: Vec3::new(-1.0, 0.0, 1e-20), exponent: 1e5 };
    for model in [phong(1e6, 1e5), modified(1.0, 0.0), Reflectance::Lafortune { lobes: vec![lobe; 4] }] {
        for eye in [Vec3::ZERO, Vec3::Y, Vec3::splat(1e6), Vec3::NAN, Vec3::new(1.0, 1e-30, 0.0)] {
            let scene = speck(model.clone(), Environment::constant(Vec3::splat(1e6)), vec![light], eye);
            let receivers = black([(Vec3::ZERO, Vec3::Y), (Vec3::X, Vec3::NEG_X), (Vec3::splat(0.6e-6), Vec3::Y)]);
            let estimate = run(&scene, &receivers, &Options { bounces: 2, ..samples(64) });
            let all = estimate.radiance.channels.iter().chain(&estimate.standard_error.channels).flatten();
            assert!(all.into_iter().all(|value| value.is_finite()), "{model:?} {eye}");
        }
    }
}
