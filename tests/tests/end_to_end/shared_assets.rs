//! The main job on real meshes and real light: every file of the shared asset folder, where there is one.
//!
//! Every mesh gets four spheres, every mesh under one probe and every probe over one mesh are run through truth and strategies.
//! HALFSHADE_ASSETS moves the folder; without it, `shared/assets` beside this repository is looked for.

use crate::common::{folder, halfshade, skipped, stdout, write};
use std::{
    fs,
    path::{Path, PathBuf},
};

/// The folder; where there is none, says that nothing is tested.
fn assets() -> Option<PathBuf> {
    let root = Path::new(env!("CARGO_MANIFEST_DIR"));
    let places = [
        std::env::var_os("HALFSHADE_ASSETS").map(PathBuf::from),
        Some(root.join("../shared/assets")),
        Some(root.join("../../shared/assets")),
        Some(root.join("../../../shared/assets")),
    ];
    let found = places.into_iter().flatten().find(|place| place.join("meshes").is_dir());
    if found.is_none() {
        skipped("no shared/assets beside the repository, and HALFSHADE_ASSETS is not set");
    }
    found
}

/// The files in `folder` with one of these endings, in order.
fn files(folder: &Path, endings: &[&str]) -> Vec<PathBuf> {
    let mut found: Vec<PathBuf> = fs::read_dir(folder)
        .expect("a folder")
        .map(|entry| entry.expect("an entry").path())
        .filter(|path| path.extension().is_some_and(|ending| endings.iter().any(|known| ending == *known)))
        .map(|path| path.canonicalize().expect("a path"))
        .collect();
    found.sort();
    found
}

#[test]
fn every_mesh_and_every_probe_runs() {
    let Some(assets) = assets() else { return };
    let here = folder();
    let meshes = files(&assets.join("meshes"), &["obj", "ply", "glb", "gltf"]);
    let probes = files(&assets.join("envmaps"), &["hdr", "exr"]);
    assert!(!meshes.is_empty() && !probes.is_empty());

    let mut experiment = String::from(
        "name = \"assets\"\nclaim = \"real meshes under real light run\"\nreferences = [\"mesh\", \"spheres\"]\n\
         receivers = [\"pixels\"]\n[truth]\nsamples = 16\n[pictures]\nresolution = [24, 18]\nstrategies = []\n\
         [[strategy]]\nname = \"unshadowed\"\n[[strategy]]\nname = \"ray-traced\"\nsamples = 4\n",
    );
    // A scene file for each pair, with few spheres: fitting many is tested elsewhere.
    let pairs = (0..meshes.len().max(probes.len())).map(|i| (&meshes[i % meshes.len()], &probes[i % probes.len()]));
    for (mesh, probe) in pairs {
        let name = mesh.file_stem().expect("a name").to_string_lossy().into_owned();
        let projection = if probe.to_string_lossy().contains("angular") { "angular" } else { "latlong" };
        let scene = format!(
            "name = \"{name}\"\n[[object]]\nmesh = {mesh:?}\nspheres = 4\n[environment]\nimage = {probe:?}\n\
             projection = \"{projection}\"\n"
        );
        write(here.path(), &format!("{name}.toml"), scene);
        experiment += &format!("[[scene]]\nname = \"{name}.toml\"\n");
    }
    write(here.path(), "assets.toml", experiment);
    let table = stdout(halfshade(here.path()).args(["run", "assets.toml"]));
    for mesh in &meshes {
        let name = mesh.file_stem().expect("a name").to_string_lossy();
        assert!(table.contains(&format!("{name}, frame 0: ")), "{name}: {table}");
    }
    assert!(!table.contains("failed:") && !table.contains("unsupported:"), "{table}");
}

/// Fits `count` spheres that bound the Stanford bunny as a user would. Returns the outside volume, the violation of the bound, and
/// the error of the ground shadow under the default rule and under the covering one, or `None` where there is no bunny.
fn fit_the_bunny(count: usize) -> Option<[f64; 4]> {
    let assets = assets()?;
    let here = folder();
    let mesh = assets.join("meshes/bunny.obj").canonicalize().expect("bunny.obj");
    let count = count.to_string();
    stdout(
        halfshade(here.path()).arg("spheres").arg(&mesh).args(["-n", &count, "--fit", "bounding", "-o", "set.json"]),
    );
    let set: serde_json::Value =
        serde_json::from_str(&fs::read_to_string(here.path().join("set.json")).expect("read")).expect("JSON");
    let keys = ["outside_volume_fraction", "bounding_violation", "ground_shadow_error"];
    let [outside, violation, shadow] = keys.map(|key| set[key].as_f64().expect("a number"));
    let covering = set["ground_shadow_error_by_rule"]["covering"].as_f64().expect("a number");
    Some([outside, violation, shadow, covering])
}

#[test]
fn sixteen_spheres_fit_the_bunny() {
    let Some([outside, violation, shadow, covering]) = fit_the_bunny(16) else { return };
    assert!(outside <= 0.52 && violation == 0.0 && shadow <= 0.055, "{outside} {violation} {shadow}");
    assert!(covering <= 0.055, "{covering}");
}

/// The shadow is held to 0.036 and 0.025 under the covering rule. Under the continuous one, whose error lies nearly all
/// below the belly, it only holds what is reached.
fn a_better_fit(count: usize, most_outside: f64, [most_shadow, most_covering]: [f64; 2]) {
    let Some([outside, violation, shadow, covering]) = fit_the_bunny(count) else { return };
    assert!(outside <= most_outside && violation == 0.0, "{count}: {outside} {violation}");
    assert!(shadow <= most_shadow && covering <= most_covering, "{count}: shadow {shadow}, {covering}");
}

#[test]
fn thirty_two_spheres_fit_the_bunny_better() {
    a_better_fit(32, 0.33, [0.045, 0.036]);
}

#[test]
#[ignore = "fits for a quarter of a minute"]
fn sixty_four_spheres_fit_the_bunny_better_still() {
    a_better_fit(64, 0.235, [0.038, 0.025]);
}

#[test]
fn spheres_fitted_to_shadows_err_less_and_tell_what_they_miss() {
    let Some(assets) = assets() else { return };
    let here = folder();
    let mesh = assets.join("meshes/spot.obj").canonicalize().expect("spot.obj");
    let figures = |fit: &str| {
        let arguments = ["-n", "12", "--fit", fit, "-o", "set.json"];
        let text = stdout(halfshade(here.path()).arg("spheres").arg(&mesh).args(arguments));
        let set: serde_json::Value =
            serde_json::from_str(&fs::read_to_string(here.path().join("set.json")).expect("read")).expect("JSON");
        assert_eq!(set["fit"], fit);
        ["missing_volume_fraction", "outside_volume_fraction", "disc_shadow_error", "own_surface_error"].map(|key| {
            assert!(text.contains(&format!("{key}: 0.")), "{key}: {text}");
            set[key].as_f64().expect("a number")
        })
    };
    let (bounding, shadow) = (figures("bounding"), figures("shadow"));
    assert!(bounding[0] < 1e-9 && shadow[0] > 0.0 && shadow[1] < bounding[1], "{bounding:?} {shadow:?}");
    assert!(shadow[2] < 0.5 * bounding[2], "{bounding:?} {shadow:?}");
    // On the surface of this one little is won or lost.
    assert!((shadow[3] / bounding[3] - 1.0).abs() < 0.25, "{bounding:?} {shadow:?}");
}

#[test]
fn a_sphere_set_is_written_in_the_coordinates_of_its_mesh() {
    let Some(assets) = assets() else { return };
    let here = folder();
    let mesh = assets.join("meshes/spot.obj").canonicalize().expect("spot.obj");
    let arguments = ["-n", "4", "--fit", "bounding", "-o", "set.json"];
    let text = stdout(halfshade(here.path()).arg("spheres").arg(&mesh).args(arguments));
    for key in
        ["outside_volume_fraction: ", "bounding_violation: 0\n", "ground_shadow_error: 0.", "seconds: ", "growth: "]
    {
        assert!(text.contains(key), "{key}: {text}");
    }
    let set: serde_json::Value =
        serde_json::from_str(&fs::read_to_string(here.path().join("set.json")).expect("read")).expect("JSON");
    assert_eq!(set["bounding_violation"], 0.0);
    let spheres: Vec<[f64; 4]> = set["spheres"]
        .as_array()
        .expect("spheres")
        .iter()
        .map(|s| {
            let center = |axis: usize| s["center"][axis].as_f64().expect("a number");
            [center(0), center(1), center(2), s["radius"].as_f64().expect("a number")]
        })
        .collect();
    assert_eq!(spheres.len(), 4);
    // Independent of our loader: every vertex line of the file lies in a sphere.
    let mut count = 0;
    for line in fs::read_to_string(&mesh).expect("read").lines().filter(|line| line.starts_with("v ")) {
        let v: Vec<f64> = line[2..].split_whitespace().map(|x| x.parse().expect("a number")).collect();
        let inside = |s: &[f64; 4]| {
            let squared: f64 = (0..3).map(|axis| (v[axis] - s[axis]).powi(2)).sum();
            squared.sqrt() <= s[3] * (1.0 + 1e-6)
        };
        assert!(spheres.iter().any(inside), "{line}");
        count += 1;
    }
    assert_eq!(count, 2930);
}

/// Sixteen lobes against the truth of the same spheres, and against exponentiated spherical harmonics of 6 bands, which
/// captured light with small windows and a sun outruns.
#[test]
fn cosine_lobes_follow_captured_light() {
    let Some(assets) = assets() else { return };
    let here = folder();
    let mesh = assets.join("meshes/bunny.obj").canonicalize().expect("bunny.obj");
    let mut experiment = String::from(
        "name = \"probes\"\nclaim = \"lobes follow captured light\"\nreferences = [\"mesh\", \"spheres\"]\n\
         receivers = [\"pixels\"]\n[truth]\nsamples = 1024\n[pictures]\nresolution = [64, 48]\nstrategies = []\n\
         [[strategy]]\nname = \"cosine-lobe\"\n[[strategy]]\nname = \"sh-exp\"\nbands = 6\n",
    );
    let probes = files(&assets.join("envmaps"), &["hdr", "exr"]);
    for probe in &probes {
        let projection = if probe.to_string_lossy().contains("angular") { ":angular" } else { "" };
        let light = format!("{}{projection}", probe.display());
        experiment +=
            &format!("[[scene]]\nname = {mesh:?}\nenvironment = {light:?}\nspheres = 16\nfit = \"bounding\"\n");
    }
    write(here.path(), "probes.toml", experiment);
    stdout(halfshade(here.path()).args(["run", "probes.toml"]));
    let text = fs::read_to_string(here.path().join("out/probes/results.json")).expect("read");
    let results: serde_json::Value = serde_json::from_str(&text).expect("JSON");
    let runs = results["runs"].as_array().expect("runs");
    let errors = |strategy: &str| -> Vec<f64> {
        let of_spheres =
            |run: &&serde_json::Value| run["strategy"] == strategy && run["error"]["reference"] == "spheres";
        runs.iter().filter(of_spheres).map(|run| run["error"]["rel_rmse"].as_f64().expect("an error")).collect()
    };
    let (lobes, harmonics) = (errors("cosine-lobe"), errors("sh-exp"));
    assert_eq!((lobes.len(), harmonics.len()), (probes.len(), probes.len()));
    for ((probe, lobes), harmonics) in probes.iter().zip(&lobes).zip(&harmonics) {
        assert!(*lobes < 0.02 && lobes < harmonics, "{}: {lobes} {harmonics}", probe.display());
    }
}
