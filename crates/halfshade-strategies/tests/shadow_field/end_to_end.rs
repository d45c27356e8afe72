//! Shadow fields from end to end: against closed forms, against rays, at the extremes, from a damaged cache.

use crate::{cached_fields::shadow_fields, common};
use glam::{Quat, Vec3};
use halfshade_scene::{
    Cache, Environment, Mesh, Motion, Object, Pose, Progress, ReceiverBuffer, Scene, SphereLight, builtin::shapes,
};
use halfshade_strategies::ShadowField;
use halfshade_strategy::{Baked, Strategy};
use std::sync::{Arc, Mutex};

/// Small fields of either basis.
const SMALL: [&str; 2] = ["shells=12,resolution=16,map=32", "basis=haar,face=16,shells=12,resolution=16"];

/// The smallest that still have several of everything.
const SMALLEST: [&str; 2] = ["shells=6,resolution=8,map=16", "basis=haar,face=8,shells=6,resolution=8"];

fn object(name: &str, mesh: Mesh, pose: Pose) -> Object {
    Object::new(name, mesh).pose(pose)
}

fn at(translation: Vec3) -> Pose {
    Pose { translation, ..Pose::IDENTITY }
}

/// A ball of radius 1 over a plane of 4 by 4, its middle 2 above.
fn ball_over_plane() -> Scene {
    let plane = object("plane", shapes::plane(10), Pose { scale: 2.0, ..Pose::IDENTITY });
    let ball = object("ball", shapes::sphere(16), at(2.0 * Vec3::Y));
    Scene::at_rest("ball over plane", vec![plane, ball], Environment::constant(Vec3::ONE))
}

fn baked(scene: &Scene, settings: &str) -> Box<dyn Baked> {
    common::baked(&shadow_fields(), scene, settings)
}

fn shade(baked: &mut dyn Baked, scene: &Scene, receivers: &ReceiverBuffer) -> Vec<f32> {
    let [red, ..] = common::shade(baked, &scene.frame(0), receivers).channels;
    red
}

/// The vertices of the first object.
fn first_object(scene: &Scene) -> ReceiverBuffer {
    let all = ReceiverBuffer::vertices(&scene.frame(0));
    let mut first = ReceiverBuffer::default();
    for i in (0..all.len()).filter(|&i| all.object[i] == 0) {
        first.push(all.view().position_at(i), all.view().normal_at(i), Vec3::ONE, 0);
    }
    first
}

fn rms(a: &[f32], b: &[f32]) -> f64 {
    let squares: f64 = a.iter().zip(b).map(|(a, b)| f64::from(a - b).powi(2)).sum();
    (squares / a.len() as f64).sqrt()
}

/// Constant light that a ball wholly above the horizon leaves: `1 - sin²θ cos γ`.
fn closed_form(receivers: &ReceiverBuffer) -> Vec<f32> {
    let visible = |i| {
        let offset = 2.0 * Vec3::Y - receivers.view().position_at(i);
        1.0 - offset.length_squared().recip() * offset.normalize().y
    };
    (0..receivers.len()).map(visible).collect()
}

#[test]
fn a_ball_shades_a_plane_as_the_closed_form_says() {
    let scene = ball_over_plane();
    let receivers = first_object(&scene);
    let exact = closed_form(&receivers);
    // Without products nothing is left but the map's cells; four bands cut the cosine off, wavelets cut nothing off.
    for (settings, bound) in [
        ("sampling=together,map=128", 2e-3),
        ("sampling=traced,map=128", 0.02),
        ("shells=16,resolution=16,map=64", 0.02),
        ("basis=haar,sampling=together", 5e-3),
        ("basis=haar,sampling=traced", 5e-3),
        ("basis=haar,shells=16,resolution=16", 5e-3),
        ("basis=haar,shells=16,resolution=16,product=wavelets", 5e-3),
    ] {
        let off = rms(&shade(baked(&scene, settings).as_mut(), &scene, &receivers), &exact);
        assert!(off < bound, "{settings}: {off}");
    }
}

/// Interpolated fields converge to what rays find at the receivers themselves as the sampling grows.
#[test]
fn fields_converge_to_rays() {
    let scene = ball_over_plane();
    let receivers = first_object(&scene);
    // Down to between one and two thousandths, where cells of the maps begin to show.
    for basis in ["map=96", "basis=haar,face=32,kept=1"] {
        let rays = shade(baked(&scene, &format!("{basis},sampling=traced")).as_mut(), &scene, &receivers);
        let errors = [(4, 0.8), (8, 0.4), (16, 0.2)].map(|(size, spacing)| {
            let fixed = format!("sampling=fixed,storage=f32,shells={size},resolution={size},spacing={spacing}");
            rms(&shade(baked(&scene, &format!("{basis},{fixed}")).as_mut(), &scene, &receivers), &rays)
        });
        assert!(errors[1] < 0.4 * errors[0] && errors[1] < 2e-3 && errors[2] < 2e-3, "{basis}: {errors:?}");
    }
}

/// Products of Haar wavelets cut nothing off: occluder by occluder is the same as all at once, for a light too.
#[test]
fn wavelet_products_are_exact() {
    let mut scene = ball_over_plane();
    scene.objects.push(object("second", shapes::torus(0.5, 0.2, 24, 12), at(Vec3::new(0.8, 0.9, 0.3))));
    let light = SphereLight { center: Vec3::new(1.0, 5.0, 1.0), radius: 0.5, radiance: 20.0 * Vec3::ONE };
    scene.lights.push((light, Motion::Still(Pose::IDENTITY)));
    let receivers = first_object(&scene);
    for product in ["texels", "wavelets"] {
        let [one_by_one, together] = ["traced", "together"].map(|sampling| {
            let settings = format!("basis=haar,face=16,kept=1,product={product},sampling={sampling}");
            shade(baked(&scene, &settings).as_mut(), &scene, &receivers)
        });
        let off = rms(&one_by_one, &together);
        assert!(off < 1e-5, "{product}: {off}");
    }
}

/// Receivers at the centre of an occluder, within its shells, on the axis of its poles, on the seam, far outside.
fn odd_receivers() -> ReceiverBuffer {
    let mut receivers = ReceiverBuffer::default();
    let places = [
        2.0 * Vec3::Y,
        2.1 * Vec3::Y,
        Vec3::new(0.0, 5.0, 0.0),
        Vec3::new(0.0, -7.0, 0.0),
        Vec3::new(-2.0, 2.0, 0.0),
        Vec3::new(-2.0, 2.0, -1e-30),
        Vec3::new(3.0, 2.0, 0.0),
        Vec3::new(1e8, 2.0, 0.0),
        Vec3::splat(-1e18),
    ];
    for place in places {
        for normal in [Vec3::Y, -Vec3::Y, Vec3::X] {
            receivers.push(place, normal, Vec3::ONE, 0);
        }
    }
    receivers
}

#[test]
fn every_end_is_finite() {
    let triangle = Mesh {
        positions: vec![Vec3::ZERO, Vec3::X, Vec3::Z],
        normals: vec![Vec3::Y; 3],
        triangles: vec![[0, 1, 2]],
        ..Mesh::default()
    };
    let one_point = Mesh {
        positions: vec![Vec3::ONE; 3],
        normals: vec![Vec3::Y; 3],
        triangles: vec![[0, 1, 2]],
        ..Mesh::default()
    };
    let overlapping = [at(2.0 * Vec3::Y), at(Vec3::new(0.3, 2.2, 0.1))];
    let mut scene = ball_over_plane();
    scene.objects.truncate(1);
    scene.objects.push(object("triangle", triangle, Pose { rotation: Quat::from_rotation_x(1.0), ..at(Vec3::Y) }));
    scene.objects.push(object("one point", one_point, Pose::IDENTITY));
    scene.objects.push(object("nothing", Mesh::default(), Pose::IDENTITY));
    let ball = Arc::new(shapes::sphere(6));
    scene
        .objects
        .extend(overlapping.map(|pose| Object { mesh: ball.clone(), ..object("ball", Mesh::default(), pose) }));
    let lamp = |center, radius| SphereLight { center, radius, radiance: Vec3::ONE };
    let lights = [
        lamp(2.0 * Vec3::Y, 0.1),
        lamp(Vec3::new(0.0, 3.5, 0.0), 0.3),
        lamp(Vec3::new(50.0, 1.0, 0.0), 1e-6),
        lamp(Vec3::ZERO, 100.0),
    ];
    let receivers = odd_receivers();
    for extremes in [
        "",
        ",threshold=0",
        ",threshold=1",
        ",threshold=1,sampling=adaptive-shells",
        ",shells=1,resolution=1",
        ",shells=1",
        ",resolution=1,sampling=fixed,storage=f16",
        ",sampling=traced",
        ",sampling=together",
        ",bands=1,map=8",
        ",bands=8,storage=f32",
        ",face=1,kept=0",
        ",kept=0.001,storage=f16",
        ",product=wavelets",
        ",own=projected",
    ] {
        for basis in SMALLEST {
            // Later settings would name a parameter twice.
            let basis = basis.split(',').filter(|pair| !extremes.contains(pair.split('=').next().unwrap_or("")));
            let settings = format!("{}{extremes}", basis.collect::<Vec<_>>().join(","));
            scene.lights.clear();
            let mut baked = baked(&scene, settings.trim_start_matches(','));
            for some in [0, lights.len()] {
                scene.lights = lights[..some].iter().map(|light| (*light, Motion::Still(Pose::IDENTITY))).collect();
                let found = shade(baked.as_mut(), &scene, &receivers);
                assert!(found.iter().all(|value| value.is_finite() && value.abs() < 20.0), "{settings}: {found:?}");
            }
        }
    }
}

/// A receiver that moves through everything: no step, for either basis.
#[test]
fn continuous_as_a_receiver_moves() {
    let scene = ball_over_plane();
    let paths: [fn(f32) -> Vec3; 3] = [
        // Past the pole and through the ball.
        |t| Vec3::new(1e-3, 8.0 - 7.9 * t, 2e-3),
        // Around, over the seam, between shells.
        |t| 2.0 * Vec3::Y + (1.2 + t) * Vec3::new((9.0 * t).cos(), 0.3, (9.0 * t).sin()),
        // Past the last shell.
        |t| Vec3::new(1.0 + 9.0 * t, 2.5, 0.5),
    ];
    for settings in SMALL {
        let mut baked = baked(&scene, settings);
        for (number, path) in paths.iter().enumerate() {
            let mut receivers = ReceiverBuffer::default();
            for i in 0..=2_000 {
                receivers.push(path(i as f32 / 2_000.0), Vec3::new(0.6, -0.8, 0.0), Vec3::ONE, 0);
            }
            // Numbers past the plane's vertices: nothing of its own is known for sure.
            receivers.index.iter_mut().for_each(|index| *index = u32::MAX);
            let found = shade(baked.as_mut(), &scene, &receivers);
            let step = found.windows(2).map(|pair| (pair[1] - pair[0]).abs()).fold(0.0, f32::max);
            assert!(step < 0.03, "{settings}, path {number}: {step}");
        }
    }
}

#[derive(Default)]
struct Notes(Mutex<Vec<String>>);

impl Progress for Notes {
    fn start(&self, _: &str, _: u64) {}
    fn advance(&self, _: u64) {}
    fn note(&self, text: &str) {
        self.0.lock().unwrap().push(text.into());
    }
}

#[test]
fn a_damaged_cache_is_refused_and_rebuilt() {
    let folder = std::env::temp_dir().join(format!("halfshade-shadow-field-{}", std::process::id()));
    let scene = ball_over_plane();
    let receivers = first_object(&scene);
    for settings in SMALLEST {
        let strategy = ShadowField::new(Cache::open(Some(folder.clone())));
        let params = strategy.info().parse(settings).unwrap();
        let run = || {
            let notes = Notes::default();
            let mut baked = strategy.bake(&scene, &params, &notes).unwrap();
            (shade(baked.as_mut(), &scene, &receivers), notes.0.into_inner().unwrap())
        };
        let (computed, quiet) = run();
        assert_eq!((run().0, quiet), (computed.clone(), vec![]), "{settings}");
        for entry in std::fs::read_dir(&folder).unwrap() {
            let path = entry.unwrap().path();
            let mut bytes = std::fs::read(&path).unwrap();
            let middle = bytes.len() / 2;
            bytes[middle] ^= 1;
            std::fs::write(&path, bytes).unwrap();
        }
        let (rebuilt, notes) = run();
        assert_eq!(rebuilt, computed, "{settings}");
        assert!(!notes.is_empty() && notes.iter().all(|note| note.contains("refused")), "{notes:?}");
        assert_eq!(run(), (computed, vec![]), "{settings}");
        std::fs::remove_dir_all(&folder).unwrap();
    }
}
