//! Scenes from text: values arrive, mistakes are named.

use super::*;
use crate::{LafortuneLobe, Reflectance, SphereFit, light::DistantLight};
use std::path::Path;

fn read(text: &str) -> Result<Scene> {
    let source = Source::new(Path::new("folder/s.toml"), text);
    scene(&source, source.parse()?)
}

const OBJECT: &str = "[[object]]\nshape = \"box\"\n";

#[test]
fn everything_a_file_can_say_arrives() {
    let scene = read(
        r#"
        name = "all"
        [[object]]
        shape = "sphere"
        name = "ball"
        albedo = [1, 0.5, 0]
        spheres = 7
        fit = "bounding"
        clusters = 3
        reflectance = { model = "modified-phong", specular = [0, 0.5, 0.25], exponent = 30 }
        subsurface = { absorption = [0, 1, 2], reduced_scattering = [30, 20, 10] }
        keyframe = [{ time = 0 }, { time = 2, translate = [0, 4, 0], rotate = [0, 2, 0, 90], scale = 4 }]
        [[object]]
        shape = "plane"
        translate = [0, -1, 0]
        scale = 5
        [object.reflectance]
        model = "lafortune"
        lobes = [
            { scale = [0.1, 0.2, 0.3], axis = [-1, -0.9, 0.95], exponent = 20 },
            { scale = [0.1, 0.1, 0.1], axis = [1, 1, 1], exponent = 0 },
        ]
        [environment]
        sky = { sun_elevation_degrees = 30, turbidity = 4, sun = false, resolution = 16 }
        turn_degrees_per_sec = 180
        [[light]]
        sphere = { center = [0, 3, 0], radius = 0.5 }
        radiance = [10, 20, 30]
        keyframe = [{ time = 0 }, { time = 1, translate = [1, 0, 0] }]
        [camera]
        eye = [0, 1, 4]
        target = [0, 0.5, 0]
        resolution = [80, 60]
        [animation]
        frames_per_sec = 10
        "#,
    )
    .unwrap();
    assert_eq!((scene.name.as_str(), scene.frame_count, scene.frames_per_sec), ("all", 21, 10.0));
    let (ball, floor) = (&scene.objects[0], &scene.objects[1]);
    assert_eq!((ball.name.as_str(), ball.sphere_count, ball.cluster_count), ("ball", 7, 3));
    assert_eq!((ball.fit, floor.fit), (SphereFit::Bounding, SphereFit::Shadow));
    assert_eq!((floor.name.as_str(), floor.sphere_count), ("plane", 0));
    assert_eq!(ball.material.albedo, Vec3::new(1.0, 0.5, 0.0));
    let specular = Vec3::new(0.0, 0.5, 0.25);
    assert_eq!(ball.material.reflectance, Reflectance::ModifiedPhong { specular, exponent: 30.0 });
    let medium = ball.material.subsurface.unwrap();
    assert_eq!((medium.absorption, medium.reduced_scattering), (Vec3::new(0.0, 1.0, 2.0), Vec3::new(30.0, 20.0, 10.0)));
    assert_eq!((medium.refractive_index, floor.material.subsurface), (1.4, None));
    let Reflectance::Lafortune { lobes } = &floor.material.reflectance else { panic!() };
    let axis = Vec3::new(-1.0, -0.9, 0.95);
    assert_eq!(lobes[0], LafortuneLobe { scale: Vec3::new(0.1, 0.2, 0.3), axis, exponent: 20.0 });
    assert!(lobes.len() == 2 && floor.material.gloss_variation.is_none());
    let frame = scene.frame(10);
    let moved = frame.world_from_object[0].transform_point(Vec3::X);
    let turned = Vec3::new(0.5_f32.sqrt(), 0.0, -0.5_f32.sqrt());
    assert!(moved.distance(Vec3::new(0.0, 2.0, 0.0) + 2.0 * turned) < 1e-5, "{moved}");
    assert!(frame.lights[0].center.distance(Vec3::new(1.0, 3.0, 0.0)) < 1e-6);
    assert!((frame.world_from_environment * Vec3::X).distance(Vec3::NEG_X) < 1e-6);
    assert!(scene.environment.sun.is_none() && matches!(scene.environment.base, DistantLight::Map(_)));
    assert_eq!((scene.camera.resolution, scene.camera.vertical_fov_degrees), ([80, 60], 40.0));
}

#[test]
fn little_is_enough_and_lights_replace_the_default_environment() {
    let scene = read(OBJECT).unwrap();
    assert_eq!((scene.name.as_str(), scene.frame_count, scene.objects[0].sphere_count), ("s", 1, 64));
    assert_eq!(scene.environment.radiance(Vec3::Y), Vec3::ONE);
    let lit = read(&format!("{OBJECT}[[light]]\nsphere = {{ center = [0, 3, 0], radius = 1 }}\nradiance = [1, 1, 1]"));
    assert_eq!(lit.unwrap().environment.radiance(Vec3::Y), Vec3::ZERO);
}

/// Text after an object that is wrong, the line of the error, and words in it.
const MISTAKES: &[(&str, usize, &[&str])] = &[
    ("colour = [1, 1, 1]", 3, &["unknown key `colour`", "albedo", "keyframe"]),
    ("albedo = [1, 1.1, 0]", 3, &["albedo", "[0, 1]"]),
    ("albedo = [1, nan, 0]", 3, &["albedo"]),
    ("albedo = [1, 1]", 3, &["`albedo` must be a list of 3 numbers, not a list of 2"]),
    ("albedo_texture = \"x.png\"", 3, &["`box` has no texture coordinates"]),
    ("reflectance = {}", 3, &["`reflectance` needs the key `model`"]),
    ("subsurface = {}", 3, &["needs the key `absorption`"]),
    ("subsurface = { absorption = [1, 1, 1], scattering = 1 }", 3, &["unknown key `scattering`", "reduced_scattering"]),
    (
        "subsurface.absorption = [0, 0, 0]\nsubsurface.reduced_scattering = [0, 1, 1]",
        3,
        &["add up to at least", "leave"],
    ),
    ("subsurface.absorption = [0, 0, -1]\nsubsurface.reduced_scattering = [1, 1, 1]", 3, &["within [0, 1e6]"]),
    ("reflectance = { model = \"ward\" }", 3, &["unknown model `ward`", "modified-phong", "lafortune"]),
    ("reflectance = { model = \"phong\", shine = 1 }", 3, &["unknown key `shine`", "specular"]),
    ("reflectance = { model = \"phong\", exponent = 1 }", 3, &["`phong` needs specular"]),
    ("reflectance = { model = \"phong\", specular = [1, 1, 1] }", 3, &["needs exponent"]),
    ("reflectance.model = \"phong\"\nreflectance.specular = [1, -1, 1]\nreflectance.exponent = 1", 4, &["specular"]),
    ("reflectance.model = \"phong\"\nreflectance.specular = [1, inf, 1]\nreflectance.exponent = 1", 4, &["specular"]),
    (
        "reflectance.model = \"phong\"\nreflectance.specular = [1, 1, 1]\nreflectance.exponent = 2e5",
        5,
        &["exponent", "100000"],
    ),
    ("reflectance.model = \"phong\"\nreflectance.specular = [1, 1, 1]\nreflectance.exponent = nan", 5, &["exponent"]),
    (
        "albedo = [0.7, 0, 0]\nreflectance.model = \"modified-phong\"\nreflectance.specular = [0.4, 0, 0]\nreflectance.exponent = 9",
        5,
        &["specular", "with the albedo at most 1"],
    ),
    ("reflectance = { model = \"phong\", lobes = [] }", 3, &["lobes", "specular and exponent"]),
    ("reflectance = { model = \"lafortune\", exponent = 1 }", 3, &["lafortune", "give lobes"]),
    ("reflectance = { model = \"lafortune\" }", 3, &["needs lobes"]),
    ("reflectance = { model = \"lafortune\", lobes = [] }", 3, &["1 to 4"]),
    (
        "reflectance.model = \"lafortune\"\nreflectance.lobes = [\n{ scale = [1, 1, 1], axis = [-1, -1, 1], exponent = 9 },\n\
             { scale = [1, 1, 1], axis = [2, 2, 2], exponent = 900 }]",
        6,
        &["scale", "axis"],
    ),
    (
        "reflectance = { model = \"lafortune\", lobes = [{ scale = [1, 1, 1], exponent = 9 }] }",
        3,
        &["needs the key `axis`"],
    ),
    (
        "reflectance = { model = \"phong\", specular = [1, 1, 1], exponent = 1, exponent_texture = \"x.png\" }",
        3,
        &["`box` has no texture coordinates", "exponent_texture"],
    ),
    ("animation = 0", 3, &["animation", "this is a shape"]),
    ("animation = -1", 3, &["`animation` must be a whole number or a text in quotes"]),
    ("[[object]]\nmesh = \"none.glb\"\nanimation = 0", 4, &["none.glb", "cannot be read"]),
    ("[[object]]\nmesh = \"x.obj\"\nanimation = \"a\"", 4, &["`.obj` files have no animations"]),
    ("scale = 0", 3, &["scale", "positive"]),
    ("scale = -1", 3, &["scale"]),
    ("scale = inf", 3, &["scale"]),
    ("\nspheres = -1", 4, &["`spheres` = -1", "from 0 to"]),
    ("\nspheres = 1000000", 4, &["`spheres` = 1000000", "from 0 to 2000"]),
    ("translate = [0, inf, 0]", 3, &["translate"]),
    ("translate = [1e37, 0, 0]", 3, &["translate = [1e37, 0.0, 0.0]", "from -1e12 to 1e12", "unit of length"]),
    ("scale = 2e12", 3, &["scale = 2000000000000.0", "at most 1.00e12", "unit of length"]),
    ("keyframe = [\n{ time = 0 },\n{ time = 1, translate = [0, -1e30, 0] }]", 5, &["translate", "1e12"]),
    ("keyframe = [{ time = 0, scale = 1e30 }]", 3, &["scale", "1.00e12"]),
    ("[[light]]\nsphere = { center = [0, 1e30, 0], radius = 1 }\nradiance = [1, 1, 1]", 4, &["center", "1e12"]),
    ("[[light]]\nsphere = { center = [0, 0, 0], radius = 1e30 }\nradiance = [1, 1, 1]", 4, &["radius", "1.00e12"]),
    (
        "[[light]]\nsphere = { center = [0, 1e6, 0], radius = 1 }\nradiance = [1, 1, 1]\n\
             keyframe = [{ time = 0, scale = 2e6 }]",
        6,
        &["scale", "at most 1.00e6"],
    ),
    ("[camera]\neye = [0, 1e28, 0]\ntarget = [0, 1, 0]", 4, &["eye", "1e12"]),
    ("[camera]\neye = [0, 1, 0]\ntarget = [0, 1e28, 0]", 5, &["target", "1e12"]),
    ("rotate = [0, 0, 0, 90]", 3, &["rotate", "axis"]),
    ("mesh = \"x.obj\"", 1, &["either"]),
    ("keyframe = []", 3, &["keyframe"]),
    ("keyframe = [\n{ time = 1 },\n{ time = 1 }]", 5, &["time", "later"]),
    ("scale = 1\nkeyframe = [{ time = 1 }]", 4, &["beside"]),
    ("[environment]\nconstant = [1, -1, 1]", 4, &["constant", "not negative"]),
    ("[environment]\nconstant = [1, 1, 1]\nimage = \"x.hdr\"", 3, &["one of: constant, image, sky"]),
    ("[environment]", 3, &["one of: constant, image, sky"]),
    ("[environment]\nimage = \"none.hdr\"", 4, &["none.hdr", "cannot be read"]),
    (
        "[environment]\nimage = \"none.hdr\"\nprojection = \"ball\"",
        5,
        &["unknown projection `ball`", "latlong, angular"],
    ),
    ("[environment]\nconstant = [1, 1, 1]\nforward_degrees = 1", 5, &["belong to an image"]),
    ("[environment]\nsky = { turbidity = 99 }", 4, &["`turbidity` = 99 must be from 1.7 to 10"]),
    ("[[light]]\nsphere = { center = [0, 0, 0], radius = 0 }\nradiance = [1, 1, 1]", 4, &["radius", "positive"]),
    ("[[light]]\nsphere = { center = [0, 0, 0], radius = 1 }\nradiance = [1, inf, 1]", 5, &["radiance"]),
    ("[[light]]\nradiance = [1, 1, 1]", 3, &["`light` needs the key `sphere`"]),
    ("[camera]\neye = [0, 1, 0]\ntarget = [0, 1, 0]", 5, &["target is its eye"]),
    ("[camera]\neye = [0, 1, 0]\ntarget = [0, 0, 0]\nvertical_fov_degrees = 180", 6, &["between 0 and 180"]),
    ("[camera]\neye = [0, 1, 0]\ntarget = [0, 0, 0]\nresolution = [0, 5]", 6, &["1 to 16384"]),
    ("[animation]\nframes_per_sec = 0", 4, &["frames_per_sec"]),
    ("fit = \"shadows\"", 3, &["unknown fit `shadows` (did you mean `shadow`?)", "bounding"]),
    ("unit_size = true", 3, &["unit_size belongs to a mesh file"]),
    ("[animation]\nframe_count = 0", 4, &["frame_count"]),
    ("[[object]]\nshape = \"cow\"", 4, &["unknown shape `cow`", "torus"]),
    ("[[object]]\nmesh = \"none.obj\"", 4, &["none.obj", "cannot be read"]),
    ("= 3", 3, &[]),
];

#[test]
fn mistakes_are_named_with_file_line_and_what_is_known() {
    for &(addition, line, parts) in MISTAKES {
        let error = read(&format!("{OBJECT}{addition}")).unwrap_err();
        let text = error.to_string();
        assert!(text.starts_with(&format!("folder/s.toml:{line}:")), "{addition:?}: {text}");
        assert!(parts.iter().all(|part| text.contains(part)), "{addition:?}: {text}");
    }
    assert!(read("name = \"x\"").unwrap_err().to_string().contains("no objects"));
}

#[test]
fn the_sun_may_stand_where_it_is() {
    let sun = "[[light]]\nsphere = { center = [0, 1.5e11, 0], radius = 7e8 }\nradiance = [2e7, 2e7, 2e7]";
    let scene = read(&format!("{OBJECT}{sun}")).unwrap();
    assert_eq!((scene.lights[0].0.center.y, scene.lights[0].0.radius), (1.5e11, 7e8));
}

#[test]
fn unknown_top_level_keys_are_errors_too() {
    let text = read(&format!("{OBJECT}[weather]\nrain = 1")).unwrap_err().to_string();
    assert!(text.starts_with("folder/s.toml:3:2: ") && text.contains("animation"), "{text}");
}

#[test]
fn a_file_can_hold_its_scene_still() {
    let moving = "[[object]]\nshape = \"box\"\nkeyframe = [{ time = 0 }, { time = 1, translate = [0, 3, 0] }]\n";
    let scene = read(&format!("name = \"a\"\nstill = 10\n{moving}")).unwrap();
    assert_eq!((scene.name.as_str(), scene.frame_count, scene.objects[0].motion.moves()), ("a", 1, false));
    assert!((scene.frame(0).world_from_object[0].translation - Vec3::Y).length() < 1e-6);
    let error = read(&format!("still = 31\n{moving}")).unwrap_err().to_string();
    assert!(error.contains("s.toml:1:9: still = 31 lies behind the last frame, 30"), "{error}");
}

#[test]
fn mistakes_are_marked_in_their_line() {
    let error = read(&format!("{OBJECT}shere = 3")).unwrap_err().to_string();
    assert!(error.ends_with("\n  |\n3 | shere = 3\n  | ^^^^^"), "{error}");
    let error = read(&format!("{OBJECT}albedo = [1, 2, 1]")).unwrap_err().to_string();
    assert!(error.ends_with("\n3 | albedo = [1, 2, 1]\n  |          ^^^^^^^^^"), "{error}");
}

#[test]
fn cameras_inside_and_odd_sizes_are_noted() {
    let folder = tempfile::tempdir().unwrap();
    std::fs::write(
        folder.path().join("m.obj"),
        "v 0 0 0\nv 900 0 0\nv 0 900 0\nv 0 0 900\nf 1 3 2\nf 1 2 4\nf 1 4 3\nf 2 3 4\n",
    )
    .unwrap();
    let notes = |more: &str| {
        let text = format!("{OBJECT}[[object]]\nmesh = \"m.obj\"\n{more}");
        let path = folder.path().join("s.toml");
        let source = Source::new(&path, &text);
        scene(&source, source.parse().unwrap()).unwrap().notes.join("\n")
    };
    assert!(notes("").contains("s.toml: `m` is 900.000 in size, 450 times larger than all others"), "{}", notes(""));
    assert_eq!((notes("unit_size = true"), notes("scale = 0.01")), (String::new(), String::new()));
    let inside = notes("unit_size = true\n[camera]\neye = [0.9, 0.9, 0.9]\ntarget = [0, 0, 0]");
    assert!(inside.contains("s.toml: the camera's eye is inside `box`"), "{inside}");
}
