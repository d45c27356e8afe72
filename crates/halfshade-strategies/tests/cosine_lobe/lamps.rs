//! Cosine lobes against closed forms, against sampling of the light in double precision, and at the extremes.

use crate::{
    built_scenes::bounded,
    common::{self, baked, shade},
};
use glam::Vec3;
use halfshade_scene::{
    Environment, Frame, Material, Motion, Object, Pose, ReceiverBuffer, Reflectance, Scene, Sphere, SphereLight,
    SphereSet,
    builtin::{self, shapes},
    progress::Silent,
};
use halfshade_strategies::{CosineLobe, cosine_lobe::Stage};
use halfshade_strategy::{Detail, Strategy};
use std::f64::consts::{PI, TAU};

const LIGHT: SphereLight = SphereLight { center: Vec3::new(0.5, 3.0, -0.4), radius: 0.6, radiance: Vec3::splat(10.0) };

const PUBLISHED: &str = "order=published,leaves=aggressive,fit=least-squares,product=published";

fn object(material: Material, set: Option<SphereSet>) -> Object {
    let object = Object::new("object", shapes::plane(1)).material(material).cluster_count(1);
    if let Some(set) = set { object.spheres(set) } else { object }
}

/// Object 0 has no spheres, object 1 all of them.
fn scene(light: SphereLight, spheres: &[Sphere]) -> Scene {
    let set = SphereSet { spheres: spheres.to_vec(), ..SphereSet::default() };
    let objects = vec![object(Material::default(), None), object(Material::default(), Some(set))];
    let lights = vec![(light, Motion::Still(Pose::IDENTITY))];
    Scene { lights, ..Scene::at_rest("lobes", objects, Environment::constant(Vec3::ZERO)) }
}

/// Figures on a frame after it was shaded.
fn details(scene: &Scene, settings: &str, receivers: &ReceiverBuffer) -> Vec<Detail> {
    let mut baked = baked(&CosineLobe, scene, settings);
    shade(baked.as_mut(), &scene.frame(0), receivers);
    baked.details()
}

fn shaded(scene: &Scene, settings: &str, receivers: &ReceiverBuffer) -> Vec<f64> {
    let out = common::shaded(&CosineLobe, scene, &scene.frame(0), receivers, settings);
    (0..receivers.len()).map(|i| f64::from(out.at(i).x)).collect()
}

/// White receivers of object 0 on the x axis, facing up.
fn line(count: usize, from: f32, to: f32) -> ReceiverBuffer {
    let mut buffer = ReceiverBuffer::default();
    for i in 0..count {
        let x = from + (to - from) * i as f32 / (count - 1) as f32;
        buffer.push(Vec3::new(x, 0.0, 0.0), Vec3::Y, Vec3::ONE, 0);
    }
    buffer
}

/// Radiance of a receiver by a fine grid of directions over the light.
fn sampled(frame: &Frame<'_>, position: Vec3, normal: Vec3) -> f64 {
    let mut radiance = 0.0;
    for light in &frame.lights {
        let offset = (light.center - position).as_dvec3();
        let (axis, sine) = (offset.normalize(), f64::from(light.radius) / offset.length());
        let height = 1.0 - (1.0 - sine * sine).sqrt();
        let (t, b) = axis.any_orthonormal_pair();
        let (rings, spokes) = (200, 400);
        for sample in 0..rings * spokes {
            let below = height * (f64::from(sample / spokes) + 0.5) / f64::from(rings);
            let (y, x) = (TAU * (f64::from(sample % spokes) / f64::from(spokes))).sin_cos();
            let direction = (below * (2.0 - below)).sqrt() * (x * t + y * b) + (1.0 - below) * axis;
            let is_blocked = frame.scene.objects.iter().flat_map(|object| &object.spheres).any(|set| {
                set.spheres.iter().any(|sphere| {
                    let center = (sphere.center - position).as_dvec3();
                    let along = center.dot(direction);
                    along > 0.0 && center.length_squared() - along * along < f64::from(sphere.radius).powi(2)
                })
            });
            let cosine = direction.dot(normal.as_dvec3()).max(0.0);
            if !is_blocked {
                radiance += cosine * f64::from(light.radiance.x) * TAU * height / f64::from(rings * spokes) / PI;
            }
        }
    }
    radiance
}

#[test]
fn an_unblocked_diffuse_receiver_gets_the_closed_form() {
    let mut receivers = ReceiverBuffer::default();
    for i in 0..60 {
        let y = 1.0 - i as f32 / 29.5;
        let normal = Vec3::new((1.0 - y * y).max(0.0).sqrt(), y, 0.0);
        receivers.push(Vec3::new(0.1 * i as f32, 0.0, 0.3), normal, Vec3::ONE, 0);
    }
    let scene = scene(LIGHT, &[]);
    let (found, published) = (shaded(&scene, "", &receivers), shaded(&scene, PUBLISHED, &receivers));
    for i in 0..receivers.len() {
        let view = receivers.view();
        let exact = f64::from(LIGHT.irradiance(view.position_at(i), view.normal_at(i)).x) / PI;
        assert!((found[i] - exact).abs() < 1e-5 * exact.max(0.01), "{i}: {} {exact}", found[i]);
        // A light's lobe has up to 4 % more solid angle than its cap, and reaches below the horizon.
        let peak = f64::from(LIGHT.irradiance(view.position_at(i), (LIGHT.center - view.position_at(i)).normalize()).x);
        assert!((published[i] - exact).abs() < 0.06 * peak / PI, "{i}: {} {exact}", published[i]);
    }
}

/// Mean and largest error over a line through a sphere's shadow, as fractions of the unblocked radiance.
fn errors(settings: &str, spheres: &[Sphere]) -> (f64, f64) {
    let scene = scene(LIGHT, spheres);
    let receivers = line(81, -1.6, 1.6);
    let frame = scene.frame(0);
    let found = shaded(&scene, settings, &receivers);
    let errors: Vec<f64> = (0..receivers.len())
        .map(|i| {
            let position = receivers.view().position_at(i);
            let unblocked = f64::from(LIGHT.irradiance(position, Vec3::Y).x) / PI;
            (found[i] - sampled(&frame, position, Vec3::Y)).abs() / unblocked
        })
        .collect();
    (errors.iter().sum::<f64>() / errors.len() as f64, errors.iter().copied().fold(0.0, f64::max))
}

#[test]
fn penumbras_are_near_sampling_and_nearer_the_deeper_the_mask() {
    let one = [Sphere { center: Vec3::new(0.1, 1.0, 0.0), radius: 0.4 }];
    let three = [
        Sphere { center: Vec3::new(-0.5, 1.2, 0.1), radius: 0.35 },
        Sphere { center: Vec3::new(-0.1, 0.9, -0.2), radius: 0.3 },
        Sphere { center: Vec3::new(0.6, 0.6, 0.1), radius: 0.2 },
    ];
    for (settings, mean, largest) in [
        ("", 0.002, 0.008),
        ("depth=3", 0.005, 0.02),
        ("leaves=aggressive", 0.02, 0.06),
        ("leaves=conservative", 0.02, 0.06),
        ("leaves=aggressive,depth=3", 0.08, 0.25),
        (PUBLISHED, 0.08, 0.25),
        ("order=published,leaves=fraction", 0.08, 0.25),
    ] {
        for spheres in [&one[..], &three[..]] {
            let found = errors(settings, spheres);
            assert!(found.0 < mean && found.1 < largest, "{settings}, {} spheres: {found:?}", spheres.len());
        }
    }
}

#[test]
fn an_umbra_is_black_and_shadows_deepen_steadily() {
    let scene = scene(LIGHT, &[Sphere { center: Vec3::new(0.1, 1.0, 0.0), radius: 0.7 }]);
    let receivers = line(400, -2.5, 0.0);
    for settings in ["", "leaves=aggressive", "leaves=conservative", PUBLISHED] {
        let found = shaded(&scene, settings, &receivers);
        assert!(found[0] > 0.1 && found[399] == 0.0, "{settings}");
        // Light grows towards the lamp; the shadow may not let it grow again.
        let darkest = found.iter().position(|value| *value == 0.0).unwrap();
        let peak = (0..darkest).max_by(|&a, &b| found[a].total_cmp(&found[b])).unwrap();
        let rise = (peak..399).map(|i| found[i + 1] - found[i]).fold(0.0, f64::max);
        let allowed = if settings.is_empty() { 0.005 } else { 0.1 };
        assert!(rise < allowed * found[peak], "{settings}: {rise}");
    }
}

#[test]
fn two_spheres_hide_together_what_neither_hides() {
    // Each covers more than half of the light, as seen from the origin.
    let light = SphereLight { center: Vec3::new(0.0, 4.0, 0.0), ..LIGHT };
    let halves = [-1.0, 1.0].map(|side| Sphere { center: Vec3::new(0.9 * side, 2.0, 0.0), radius: 1.0 });
    let mut receivers = ReceiverBuffer::default();
    receivers.push(Vec3::ZERO, Vec3::Y, Vec3::ONE, 0);
    for settings in ["", "leaves=aggressive", "leaves=conservative", "order=published,leaves=conservative"] {
        let open = shaded(&scene(light, &halves[..1]), settings, &receivers)[0];
        let closed = shaded(&scene(light, &halves), settings, &receivers)[0];
        assert!(open > 0.005 && closed < 0.35 * open, "{settings}: {closed} of {open}");
    }
}

#[test]
fn everything_is_finite_and_not_negative_at_the_extremes() {
    let many: Vec<Sphere> = (0..3000)
        .map(|i| {
            let place = [0.754_877_7, 0.569_840_3, 0.430_159_7].map(|step: f64| (f64::from(i) * step).fract() as f32);
            Sphere { center: 2.0 * Vec3::from(place) - Vec3::new(1.0, 0.0, 1.0), radius: 0.02 + 0.1 * place[0] }
        })
        .collect();
    let huge = [
        Sphere { center: Vec3::new(0.0, -1e5, 0.0), radius: 1e5 },
        Sphere { center: Vec3::new(0.0, 1.0, 0.0), radius: 30.0 },
        Sphere { center: Vec3::ONE, radius: 1e-9 },
    ];
    let mut receivers = line(33, -4.0, 4.0);
    for direction in [Vec3::X, Vec3::Y, Vec3::NEG_Y, Vec3::new(0.6, 0.0, -0.8)] {
        for distance in [0.0, 0.3, 0.6, 0.600_001, 0.7] {
            receivers.push(LIGHT.center + distance * direction, direction, Vec3::ONE, 0);
            receivers.push(LIGHT.center + distance * direction, -direction, Vec3::ONE, 1);
        }
    }
    for light in [
        LIGHT,
        SphereLight { radius: 0.0, ..LIGHT },
        SphereLight { radius: 1e-6, ..LIGHT },
        SphereLight { radius: 2.999_999, ..LIGHT },
        SphereLight { radius: 1e4, ..LIGHT },
        SphereLight { center: Vec3::new(0.0, -3.0, 0.0), ..LIGHT },
        SphereLight { center: Vec3::new(1e6, 1e6, 0.0), radius: 1e5, ..LIGHT },
    ] {
        for spheres in [&many[..], &huge[..], &huge[..1], &[]] {
            for settings in
                ["", PUBLISHED, "rule=covering,leaves=conservative,depth=6", "depth=0,rule=published", "share=0.5"]
            {
                let mut scene = scene(light, spheres);
                scene.objects[0].material.reflectance =
                    Reflectance::Phong { specular: Vec3::splat(0.4), exponent: 1e5 };
                scene.objects[1].material.reflectance =
                    Reflectance::ModifiedPhong { specular: Vec3::splat(0.4), exponent: 0.0 };
                scene.camera.eye = Vec3::new(1.0, 2.0, 3.0);
                let found = shaded(&scene, settings, &receivers);
                let bad = found.iter().position(|value| !(value.is_finite() && *value >= 0.0));
                assert_eq!(bad, None, "{settings}, {light:?}, {} spheres", spheres.len());
            }
        }
    }
}

#[test]
fn a_threshold_leaves_out_products_and_changes_no_more_than_it_says() {
    let spheres: Vec<Sphere> = (0..12)
        .map(|i| Sphere { center: Vec3::new(0.15 * i as f32 - 0.9, 1.0 + 0.1 * (i % 3) as f32, 0.1), radius: 0.12 })
        .collect();
    let mut scene = scene(LIGHT, &spheres);
    scene.objects[0].material.reflectance = Reflectance::ModifiedPhong { specular: Vec3::splat(0.5), exponent: 300.0 };
    scene.camera.eye = Vec3::new(-0.5, 3.0, 0.4);
    let receivers = line(101, -1.5, 1.5);
    let exact = shaded(&scene, "threshold=0", &receivers);
    let unblocked = shaded(&Scene { objects: vec![scene.objects[0].clone()], ..scene.clone() }, "", &receivers);
    for threshold in [1e-5, 1e-4, 1e-3] {
        let found = shaded(&scene, &format!("threshold={threshold}"), &receivers);
        for i in 0..receivers.len() {
            // At most as many products as the mask has cells, for each of two lobes.
            let allowed = threshold * 2048.0 * unblocked[i];
            assert!((found[i] - exact[i]).abs() <= allowed.min(0.1 * unblocked[i]), "{threshold}: {i}");
        }
    }
    let all = details(&scene, "threshold=1e-3", &receivers);
    let left_out = all.into_iter().find(|detail| detail.name.contains("left out")).unwrap();
    assert!(left_out.values[0] > 100.0, "{left_out:?}");
}

/// A blocker half way to the light moves before it by as much as the receiver, so that between neighbours that share a mask
/// radiance changes by about the cube's side over the light's width.
#[test]
fn sharing_finds_fewer_masks_and_errs_by_what_a_blocker_moves() {
    let scene = scene(LIGHT, &[Sphere { center: Vec3::new(0.1, 1.4, 0.0), radius: 0.4 }]);
    let receivers = line(2001, -1.6, 1.6);
    let count = |settings: &str| {
        details(&scene, settings, &receivers).into_iter().find(|detail| detail.name.contains("masks")).unwrap().values
            [0]
    };
    let (own, own_masks) = (shaded(&scene, "", &receivers), count(""));
    for share in [0.03125, 0.0625, 0.125, 0.25] {
        let settings = format!("share={share}");
        let found = shaded(&scene, &settings, &receivers);
        let largest = (0..receivers.len())
            .map(|i| {
                let view = receivers.view();
                (found[i] - own[i]).abs() * PI / f64::from(LIGHT.irradiance(view.position_at(i), Vec3::Y).x)
            })
            .fold(0.0, f64::max);
        let cubes = 3.2 / (share * f64::from(LIGHT.radius));
        assert!(largest > 0.05 * share && largest < share, "{settings}: {largest}");
        assert!(count(&settings) <= own_masks.min(cubes + 2.0), "{settings}");
    }
    assert!(own_masks > 500.0, "{own_masks}");
}

/// Every `step`th vertex of a built-in scene, which is made ready.
fn built_in(name: &str, step: usize) -> (Scene, ReceiverBuffer) {
    let scene = bounded(builtin::scene(name).unwrap());
    let all = ReceiverBuffer::vertices(&scene.frame(0));
    let places: Vec<u32> = (0..all.len() as u32).step_by(step).collect();
    let some = ReceiverBuffer::gathered(all.view(), &places);
    (scene, some)
}

/// The paper's figure is a mean difference of 0.003884 where the mean is 0.1279 [Meunier2009, 6].
#[test]
fn products_of_lobes_are_within_three_percent_of_sampling_the_same_sums() {
    for (name, step) in [("five-blockers", 13), ("glossy-sphere", 31)] {
        let (scene, receivers) = built_in(name, step);
        for (settings, bound) in [("", 0.002), (PUBLISHED, 0.03), ("order=published", 0.03)] {
            let products = shaded(&scene, settings, &receivers);
            let sampled = shaded(&scene, format!("{settings},integration=sampled").trim_start_matches(','), &receivers);
            let mean = sampled.iter().sum::<f64>() / sampled.len() as f64;
            let off: f64 =
                products.iter().zip(&sampled).map(|(a, b)| (a - b).abs()).sum::<f64>() / sampled.len() as f64;
            assert!(mean > 0.01 && off < bound * mean, "{name} {settings}: {off} of {mean}");
        }
    }
}

#[test]
fn what_is_done_twice_changes_no_bit() {
    let spheres = [Sphere { center: Vec3::new(0.1, 1.0, 0.0), radius: 0.4 }];
    let mut scene = scene(LIGHT, &spheres);
    scene.objects[0].material.reflectance = Reflectance::ModifiedPhong { specular: Vec3::splat(0.5), exponent: 30.0 };
    scene.camera.eye = Vec3::new(-0.5, 3.0, 0.4);
    let receivers = line(65, -1.5, 1.5);
    for order in ["light-first", "published"] {
        let settings = format!("order={order}");
        let once = shaded(&scene, &settings, &receivers);
        let params = CosineLobe.info().parse(&settings).unwrap();
        for stage in Stage::ALL {
            let mut baked = CosineLobe.bake_repeating(stage, &scene, &params, &Silent);
            let twice = shade(baked.as_mut(), &scene.frame(0), &receivers);
            let is_same = |i: usize| once[i].to_bits() == f64::from(twice.at(i).x).to_bits();
            assert!((0..receivers.len()).all(is_same), "{stage:?}");
        }
    }
}

/// Distance from the axis of one ball and a light above it where a tenth of the light arrives to where nine tenths do.
#[test]
fn penumbras_are_as_wide_as_the_truths_as_the_light_grows() {
    let ball = [Sphere { center: Vec3::Y, radius: 0.35 }];
    for radius in [1e-3f32, 0.05, 0.2, 0.4, 0.8] {
        let light = SphereLight { center: Vec3::new(0.0, 3.0, 0.0), radius, ..LIGHT };
        let scene = scene(light, &ball);
        // Where the light's centre vanishes.
        let edge = 3.0 * 0.35 / (4.0f32 - 0.35 * 0.35).sqrt();
        let receivers = line(121, (edge - 1.4 * radius).max(0.0), edge + 1.4 * radius);
        let position = |i: usize| receivers.view().position_at(i);
        let width = |radiance: &dyn Fn(usize) -> f64| {
            let visible: Vec<f64> = (0..receivers.len())
                .map(|i| radiance(i) * PI / f64::from(light.irradiance(position(i), Vec3::Y).x))
                .collect();
            let place = |part: f64| {
                let below = visible.iter().rposition(|value| *value < part).unwrap();
                let [a, b] = [below, below + 1].map(|i| f64::from(position(i).x));
                a + (b - a) * (part - visible[below]) / (visible[below + 1] - visible[below])
            };
            place(0.9) - place(0.1)
        };
        let frame = scene.frame(0);
        let exact = width(&|i| sampled(&frame, position(i), Vec3::Y));
        assert!((0.5..1.2).contains(&(exact / f64::from(radius))), "{exact} of a light of {radius}");
        for (settings, bound) in [("", 0.01), ("depth=3", 0.03), ("leaves=aggressive", 0.05), (PUBLISHED, 0.1)] {
            let values = shaded(&scene, settings, &receivers);
            let found = width(&|i| values[i]);
            assert!((found / exact - 1.0).abs() < bound, "{settings}, light of {radius}: {found} {exact}");
        }
    }
}

/// Receivers from which one ball, or only many together, hide the whole light.
#[test]
fn an_umbra_has_no_leaks() {
    let light = SphereLight { center: Vec3::new(0.0, 4.0, 0.0), ..LIGHT };
    // A layer of small balls that overlap just so far that it has no gaps.
    let many: Vec<Sphere> = (0..441)
        .map(|i| {
            let at = |place: usize| 0.05 * (place as f32 - 10.0);
            Sphere { center: Vec3::new(at(i % 21), 1.5, at(i / 21)), radius: 0.0375 }
        })
        .collect();
    let one = [Sphere { center: Vec3::new(0.0, 1.5, 0.0), radius: 0.9 }];
    let receivers = line(101, -0.35, 0.35);
    for (settings, bound) in [("", 0.001), ("leaves=aggressive", 0.15), ("leaves=conservative", 0.0), (PUBLISHED, 0.02)]
    {
        for spheres in [&one[..], &many[..]] {
            let scene = scene(light, spheres);
            let frame = scene.frame(0);
            let found = shaded(&scene, settings, &receivers);
            for (i, value) in found.iter().enumerate() {
                let position = receivers.view().position_at(i);
                let unblocked = f64::from(light.irradiance(position, Vec3::Y).x) / PI;
                if i % 20 == 0 {
                    assert!(sampled(&frame, position, Vec3::Y) < 1e-3 * unblocked, "not an umbra");
                }
                assert!(*value <= bound * unblocked, "{settings}, {} spheres: {}", spheres.len(), value / unblocked);
            }
        }
    }
}

#[test]
fn the_ends_of_the_issue_are_finite() {
    // 1,024 blockers of one light, all of which a receiver sees at once.
    let mask_of_all: Vec<Sphere> = (0..1024)
        .map(|i| {
            let (sin, cos) = (2.399_963 * i as f32).sin_cos();
            let out = 0.3 * (i as f32 / 1024.0).sqrt();
            Sphere { center: Vec3::new(out * cos, 1.0, out * sin), radius: 0.012 }
        })
        .collect();
    let around_light = [Sphere { center: Vec3::new(0.0, 3.0, 0.0), radius: 1.5 }];
    // Touching the receiver at the origin: from above, from below, and about it.
    let touching = [0.3f32, -0.3, 0.0].map(|y| Sphere { center: Vec3::new(0.0, y, 0.0), radius: 0.3 });
    let mut receivers = ReceiverBuffer::default();
    receivers.push(Vec3::ZERO, Vec3::Y, Vec3::ONE, 0);
    receivers.push(Vec3::new(0.01, 0.0, 0.0), Vec3::Y, Vec3::ONE, 1);
    // Radii from a point to all of a hemisphere.
    for radius in [1e-6f32, 0.5, 2.999_99] {
        let light = SphereLight { center: Vec3::new(0.0, 3.0, 0.0), radius, radiance: Vec3::splat(1.0) };
        for exponent in [0.0, 1e5] {
            for (what, spheres) in [
                ("1,024 in one mask", &mask_of_all[..]),
                ("light in a blocker", &around_light[..]),
                ("touching above", &touching[..1]),
                ("touching below", &touching[1..2]),
                ("within a blocker", &touching[2..]),
            ] {
                for settings in [
                    "",
                    PUBLISHED,
                    "leaves=conservative,depth=6",
                    "depth=1",
                    "depth=0",
                    "depth=0,order=published,leaves=conservative",
                    "share=1",
                    "integration=sampled,samples=1",
                ] {
                    let mut scene = scene(light, spheres);
                    for object in &mut scene.objects {
                        object.material.reflectance = Reflectance::Phong { specular: Vec3::splat(0.3), exponent };
                    }
                    scene.camera.eye = Vec3::new(0.5, 3.0, 0.0);
                    let found = shaded(&scene, settings, &receivers);
                    let fine = found.iter().all(|value| value.is_finite() && *value >= 0.0);
                    assert!(fine, "{what}, {settings}, light of {radius}, exponent {exponent}: {found:?}");
                }
            }
        }
    }
    // The whole mask: as many lobes as cells at most, and a light that many small balls hide in part.
    let light = SphereLight { center: Vec3::new(0.0, 3.0, 0.0), radius: 0.9, radiance: Vec3::splat(1.0) };
    let scene = scene(light, &mask_of_all);
    let truth = sampled(&scene.frame(0), Vec3::ZERO, Vec3::Y);
    let unblocked = f64::from(light.irradiance(Vec3::ZERO, Vec3::Y).x) / PI;
    let found = shaded(&scene, "", &receivers)[0];
    assert!((found - truth).abs() < 0.05 * unblocked, "{found} {truth} of {unblocked}");
}

#[test]
fn settings_out_of_range_are_refused() {
    for wrong in ["depth=-1", "depth=7", "share=2", "samples=0"] {
        assert!(CosineLobe.info().parse(wrong).is_err(), "{wrong}");
    }
}
