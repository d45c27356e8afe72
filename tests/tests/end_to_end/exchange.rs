//! Scenes for other renderers: a folder that is written whole or not at all, and Mitsuba's answer where it is installed.

use crate::common::{folder, halfshade, names, refused, skipped, stdout, write};
use std::path::Path;
use std::process::Command;

const SCENE: &str = "name = \"a\"\n[[object]]\nshape = \"sphere\"\n[camera]\neye = [0, 1, 4]\ntarget = [0, 0, 0]\nresolution = [8, 6]\n";

#[test]
fn a_scene_is_exported_into_a_new_folder_and_can_be_rendered_from_there() {
    let here = folder();
    write(here.path(), "a.toml", SCENE);
    let files = stdout(halfshade(here.path()).args(["export", "a.toml", "--format", "mitsuba"]));
    for name in ["scene.xml", "render.py", "confirm.py", "meshes/0-0.ply"] {
        assert!(files.lines().any(|line| line == Path::new("a-mitsuba").join(name).to_string_lossy()), "{files}");
        assert!(here.path().join("a-mitsuba").join(name).is_file());
    }
    // Nothing that is there already is replaced.
    write(here.path(), "mine/notes.txt", "mine");
    for place in ["a-mitsuba", "mine", "a.toml"] {
        let text = refused(halfshade(here.path()).args(["export", "a.toml", "--format", "mitsuba", "-o", place]));
        assert!(text.contains(place), "{text}");
    }
    assert_eq!((names(here.path()).len(), names(&here.path().join("mine"))), (3, vec!["notes.txt".to_owned()]));
    let text =
        refused(halfshade(here.path()).args(["export", "a.toml", "--format", "mitsuba", "--frame", "3", "-o", "new"]));
    assert!(text.contains("there is no frame 3"), "{text}");

    // The written scene is one here, too, and gives the same truth.
    let truth = |scene: &str| stdout(halfshade(here.path()).args(["truth", scene, "--samples", "16", "-o", "t.exr"]));
    assert_eq!(truth("a.toml"), truth("a-mitsuba/scene.xml"));
    write(here.path(), "b.pbrt", "WorldBegin Shape \"sphere\" Shape \"disk\"");
    let compared = halfshade(here.path())
        .args(["compare", "b.pbrt", "--strategy", "unshadowed", "--quick", "--no-pictures"])
        .assert()
        .success();
    let text = String::from_utf8_lossy(&compared.get_output().stderr).into_owned();
    assert!(text.contains("b.pbrt:1: shape `disk` left out"), "{text}");
}

/// Whether Mitsuba is to be asked, and can be.
fn mitsuba_is_asked() -> bool {
    let asked = std::env::var_os("HALFSHADE_CONFIRM").is_some();
    let found = asked
        && Command::new("python3").args(["-c", "import mitsuba"]).output().is_ok_and(|output| output.status.success());
    if !found {
        skipped("HALFSHADE_CONFIRM isn't set, or `python3 -c 'import mitsuba'` fails (pip install mitsuba)");
    }
    found
}

/// Objects that shadow each other and the ground.
const OBJECTS: &str = "[[object]]\nshape = \"plane\"\nscale = 4\ntranslate = [0, -0.6, 0]\nalbedo = [0.6, 0.5, 0.4]\n\
                       [[object]]\nshape = \"box\"\nscale = 0.5\ntranslate = [-0.7, -0.1, 0.2]\nrotate = [0, 1, 0, 25]\nalbedo = [0.8, 0.3, 0.2]\n\
                       [[object]]\nshape = \"torus\"\nscale = 0.6\ntranslate = [0.8, -0.2, 0]\nrotate = [1, 0, 0, 60]\nalbedo = [0.2, 0.5, 0.8]\n";
const CAMERA: &str =
    "[camera]\neye = [1, 2, 4]\ntarget = [0, -0.2, 0]\nvertical_fov_degrees = 35\nresolution = [32, 24]\n";
/// Without its sun, whose solid angle Mitsuba rounds by up to 0.3 %, in single precision.
const SKY: &str = "[environment]\nsky = { sun_elevation_degrees = 40, resolution = 16, sun = false }\n";
const LAMPS: &str = "[[light]]\nsphere = { center = [0.5, 1.8, 1], radius = 0.4 }\nradiance = [8, 6, 4]\n\
                     [[light]]\nsphere = { center = [-2, 1, 0.5], radius = 0.1 }\nradiance = [20, 40, 60]\n\
                     [environment]\nconstant = [0.1, 0.1, 0.2]\n";

/// Objects of which one is glossy.
fn glossy(reflectance: &str) -> String {
    OBJECTS.replace("albedo = [0.8, 0.3, 0.2]", &format!("albedo = [0.4, 0.3, 0.2]\nreflectance = {reflectance}"))
}

/// Rays through the same pixels, in Mitsuba and here: differences are noise, in units of both standard errors.
///
/// Errors of the truth are estimated from 16 replicates and have heavy tails, so that the standard deviation of z may be a little
/// above 1, and values above 3 several times as frequent as the 0.27 % of a normal distribution.
#[test]
fn mitsuba_confirms_the_truth() {
    if !mitsuba_is_asked() {
        return;
    }
    let phong = glossy("{ model = \"phong\", specular = [0.3, 0.3, 0.3], exponent = 20 }");
    let modified = glossy("{ model = \"modified-phong\", specular = [0.5, 0.5, 0.5], exponent = 60 }");
    let lafortune = glossy(
        "{ model = \"lafortune\", lobes = [{ scale = [0.6, 0.5, 0.4], axis = [-1, -0.7, 0.95], exponent = 12 }] }",
    );
    let uniform = "[environment]\nconstant = [1, 0.8, 0.6]\n";
    for (name, scene) in [
        ("direct", format!("{OBJECTS}{uniform}{CAMERA}")),
        ("sky", format!("{OBJECTS}{SKY}{CAMERA}")),
        ("lamps", format!("{OBJECTS}{LAMPS}{CAMERA}")),
        ("one-bounce", format!("bounces = 1\n{OBJECTS}{LAMPS}{CAMERA}")),
        ("three-bounces-of-sky", format!("bounces = 3\n{OBJECTS}{SKY}{CAMERA}")),
        ("phong", format!("{phong}{LAMPS}{CAMERA}")),
        ("modified-phong", format!("bounces = 1\n{modified}{SKY}{CAMERA}")),
        ("lafortune", format!("{lafortune}{LAMPS}{CAMERA}")),
    ] {
        let here = folder();
        write(here.path(), "a.toml", scene);
        stdout(halfshade(here.path()).args(["export", "a.toml", "--format", "mitsuba", "-o", "a"]));
        stdout(halfshade(here.path()).args(["truth", "a.toml", "--samples", "4096", "-o", "truth.exr"]));
        let samples = std::env::var("HALFSHADE_CONFIRM_SAMPLES").unwrap_or_else(|_| "4096".to_owned());
        let output = Command::new("python3")
            .args(["a/confirm.py", "truth.exr", "--samples", &samples])
            .current_dir(here.path())
            .output()
            .expect("python3 runs");
        let text = String::from_utf8_lossy(&output.stdout).into_owned();
        let found: serde_json::Value = serde_json::from_str(&text)
            .unwrap_or_else(|_| panic!("{name}: {text} {}", String::from_utf8_lossy(&output.stderr)));
        let number = |key: &str| found[key].as_f64().unwrap_or(f64::NAN);
        // Channels share their rays: a third of the values is independent.
        let independent = number("values") / 3.0;
        assert!(independent > 500.0, "{name}: {found}");
        assert!(number("mean_z").abs() < 4.0 / independent.sqrt(), "{name}: {found}");
        assert!((0.85..1.25).contains(&number("sd_z")), "{name}: {found}");
        assert!(number("share_above_3") < 0.02, "{name}: {found}");
        let light = number("light_difference") / number("light_standard_error");
        assert!(light.abs() < 4.0 * 3.0_f64.sqrt(), "{name}: {found}");
    }
}
