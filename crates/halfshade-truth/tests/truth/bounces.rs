//! Reflected light against closed forms.

use crate::scenes::{ball, icosphere, object, on_the_ground, run, scene};
use glam::Vec3;
use halfshade_scene::{Environment, Material, Object, Pose, ReceiverBuffer, Scene, SphereLight, builtin::shapes};
use halfshade_truth::{Estimate, Geometry, Options};

fn with_albedo(object: Object, albedo: Vec3) -> Object {
    Object { material: Material::new(albedo), ..object }
}

/// Every channel of every receiver within `sigmas` standard errors and `slack` of `expected`.
fn assert_is(found: &Estimate, expected: impl Fn(usize) -> Vec3, slack: f32) {
    for i in 0..found.radiance.len() {
        let error = (found.radiance.at(i) - expected(i)).abs();
        let allowed = 4.0 * found.standard_error.at(i) + slack;
        assert!(error.cmple(allowed).all(), "{i}: {} instead of {}", found.radiance.at(i), expected(i));
    }
}

/// Nothing of a convex object sees any other part of it.
#[test]
fn a_convex_object_reflects_its_albedo_however_often() {
    let albedo = Vec3::new(0.9, 0.5, 0.1);
    for mesh in [shapes::sphere(12), shapes::box_mesh(4)] {
        let object = with_albedo(object(mesh, Pose::IDENTITY), albedo);
        let scene = scene(vec![object], Environment::constant(Vec3::new(1.0, 2.0, 3.0)), Vec::new());
        let receivers = ReceiverBuffer::vertices(&scene.frame(0));
        for bounces in [0, 1, 3] {
            let found = run(&scene, &receivers, &Options { bounces, samples: 64, ..Options::default() });
            // Facets lie a little below their vertices' horizon.
            assert_is(&found, |_| albedo * Vec3::new(1.0, 2.0, 3.0), 1e-3);
        }
    }
}

/// A hollow sphere of radius R around a small lamp: the same irradiance E everywhere, and of the light a·E/π that the wall
/// reflects every point receives a·E again.
#[test]
fn inside_a_sphere_bounces_are_a_geometric_series() {
    let light = SphereLight { center: Vec3::ZERO, radius: 0.05, radiance: Vec3::splat(400.0) };
    for scale in [1e-3f32, 1.0, 1e3] {
        let light = SphereLight { radius: scale * light.radius, ..light };
        for albedo in [0.0, 0.5, 1.0] {
            let pose = Pose { scale, ..Pose::IDENTITY };
            let wall = with_albedo(object(icosphere(4), pose), Vec3::splat(albedo));
            let scene = scene(vec![wall], Environment::constant(Vec3::ZERO), vec![light]);
            let mut receivers = ReceiverBuffer::default();
            // White patches that look inward from a little within the wall.
            for direction in [Vec3::X, Vec3::NEG_Y, Vec3::new(0.6, 0.0, 0.8), Vec3::new(-0.48, 0.64, 0.6)] {
                receivers.push(0.99 * scale * direction, -direction, Vec3::ONE, 0);
            }
            for bounces in 0..=4 {
                let options = Options { bounces, samples: 1024, ..Options::default() };
                let found = run(&scene, &receivers, &options);
                // E/π = L r²/d²: 0.99 from the lamp, and 1 from it where light is reflected.
                let on_wall = light.radiance.x * 0.05f32.powi(2);
                let series: f32 = (1..=bounces).map(|b| albedo.powi(b as i32)).sum();
                let expected = on_wall * (0.99f32.powi(-2) + series);
                // Facets of the wall lie up to a hundredth nearer to the lamp.
                assert_is(&found, |_| Vec3::splat(expected), 0.012 * on_wall * bounces as f32);
            }
        }
    }
}

/// A patch faces a disc of radius R at height h, lit from above by a constant sky that the disc hides from the patch:
/// one bounce gives albedo · E/π · R²/(R² + h²), the form factor from a small parallel patch to a coaxial disc.
#[test]
fn a_disc_lights_a_patch_by_its_form_factor() {
    let albedo = Vec3::new(0.8, 0.4, 0.2);
    let mut disc = shapes::plane(64);
    disc.positions.iter_mut().for_each(|p| {
        // The square onto the disc: its rings onto rings.
        let ring = p.x.abs().max(p.z.abs());
        *p *= if ring > 0.0 { ring / p.length() } else { 1.0 };
    });
    let disc = with_albedo(object(disc, Pose::IDENTITY), albedo);
    let scene = scene(vec![disc], Environment::constant(Vec3::ONE), Vec::new());
    let mut receivers = ReceiverBuffer::default();
    let heights = [0.25f32, 0.5, 1.0, 2.0];
    heights.iter().for_each(|&h| receivers.push(Vec3::new(0.0, h, 0.0), Vec3::NEG_Y, Vec3::ONE, 0));
    let found = run(&scene, &receivers, &Options { bounces: 1, samples: 4096, ..Options::default() });
    let factor = |i: usize| 1.0 / (1.0 + heights[i] * heights[i]);
    // What the disc doesn't hide of the sky below is seen directly.
    assert_is(&found, |i| albedo * factor(i) + Vec3::splat(1.0 - factor(i)), 2e-3);
}

fn ball_over_ground(albedo: Vec3) -> Scene {
    let ball = with_albedo(ball(Vec3::new(0.0, 1.5, 0.0), 1.0), albedo);
    scene(vec![ball], Environment::constant(Vec3::ONE), Vec::new())
}

/// A ball that is its own sphere: both references see the same, and the ground gets back the ball's albedo times what it
/// blocks.
#[test]
fn a_ball_gives_back_its_albedo_by_mesh_and_by_sphere() {
    let albedo = Vec3::new(1.0, 0.6, 0.2);
    let scene = ball_over_ground(albedo);
    let receivers = on_the_ground([(0.0, 0.0), (1.0, 0.0), (3.0, 1.0)]);
    for geometry in [Geometry::Mesh, Geometry::Spheres(Default::default())] {
        for bounces in [1, 2] {
            let options = Options { bounces, geometry, samples: 4096, ..Options::default() };
            let found = run(&scene, &receivers, &options);
            let blocked = |i: usize| {
                let distance_squared = [2.25f32, 3.25, 12.25][i];
                1.5 / distance_squared.powf(1.5)
            };
            assert_is(&found, |i| Vec3::ONE - (Vec3::ONE - albedo) * blocked(i), 2e-3);
        }
    }
}

/// Colours on a sphere come from the mesh that it stands for.
#[test]
fn spheres_carry_the_colours_of_their_mesh() {
    let mut scene = ball_over_ground(Vec3::ONE);
    let mesh = std::sync::Arc::make_mut(&mut scene.objects[0].mesh);
    mesh.colors = mesh.positions.iter().map(|p| if p.x > 0.0 { Vec3::X } else { Vec3::Z }).collect();
    let receivers = on_the_ground([(-2.0, 0.0), (0.0, 0.0), (2.0, 0.3)]);
    let of = |geometry| run(&scene, &receivers, &Options { bounces: 1, geometry, samples: 4096, ..Options::default() });
    let (mesh, spheres) = (of(Geometry::Mesh), of(Geometry::Spheres(Default::default())));
    assert_is(&spheres, |i| mesh.radiance.at(i), 5e-3);
    assert!(spheres.radiance.at(2).x > spheres.radiance.at(2).z + 0.05);
}

#[test]
fn black_surfaces_and_the_number_of_threads_change_nothing() {
    let receivers = on_the_ground([(0.0, 0.0), (1.0, 0.0), (3.0, 1.0)]);
    let black = ball_over_ground(Vec3::ZERO);
    let options = |bounces| Options { bounces, samples: 256, ..Options::default() };
    assert_eq!(run(&black, &receivers, &options(0)).radiance, run(&black, &receivers, &options(3)).radiance);
    let scene = ball_over_ground(Vec3::ONE);
    let on = |threads| {
        let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build().unwrap();
        pool.install(|| run(&scene, &receivers, &options(2)))
    };
    assert_eq!(on(1), on(3));
}
