//! Sweeps over scenes and their lights, and the search for settings.

use crate::{
    common::{halfshade, refused, stdout, write},
    runs::{EXPERIMENT, SCENE, prepared, results},
};

/// A scene under a lamp whose radiance can be swept.
fn lit() -> String {
    format!("{SCENE}[[light]]\nsphere = {{ center = [0, 3, 0], radius = 0.5 }}\nradiance = [4, 4, 4]\n")
}

#[test]
fn any_value_of_a_scene_file_is_swept_and_light_scales_what_it_should() {
    let here = prepared();
    write(here.path(), "scene.toml", lit());
    let sweep = "name = \"scene.toml\"\nsweep = { \"light.1.radiance\" = [[4, 4, 4], [8, 8, 8]], bounces = [0, 1] }";
    let text = EXPERIMENT.replace("name = \"scene.toml\"", sweep).replace("[pictures]\n", "");
    write(here.path(), "small.toml", &text);
    stdout(halfshade(here.path()).args(["run", "small.toml"]));
    let results = results(here.path());
    let names: Vec<&str> =
        results["scenes"].as_array().unwrap().iter().map(|it| it["name"].as_str().unwrap()).collect();
    let expected = ["0", "1"].iter().flat_map(|bounces| {
        ["[4, 4, 4]", "[8, 8, 8]"].map(|light| format!("corner, bounces {bounces}, light.1.radiance {light}"))
    });
    assert_eq!(names, expected.collect::<Vec<_>>());
    let mean = |scene: &str| {
        let mut runs = results["runs"].as_array().unwrap().iter();
        runs.find(|run| run["scene"] == scene).unwrap()["truth"]["unshadowed_mean"].as_f64().unwrap()
    };
    assert!((mean(names[1]) / mean(names[0]) - 2.0).abs() < 1e-5, "{} {}", mean(names[1]), mean(names[0]));
    for (wrong, file, what) in [
        ("light.2.radiance", "small.toml:", "no entry `2` in a list of 1"),
        ("light.1.brightness", "scene.toml:", "brightness"),
    ] {
        write(here.path(), "small.toml", text.replace("light.1.radiance", wrong));
        let error = refused(halfshade(here.path()).args(["run", "small.toml"]));
        assert!(error.contains(file) && error.contains(what), "{error}");
    }
    write(here.path(), "small.toml", text.replace("name = \"scene.toml\"", "name = \"vases\""));
    let error = refused(halfshade(here.path()).args(["run", "small.toml"]));
    assert!(error.contains("a path into a scene file, and scene `vases` is none"), "{error}");
}

#[test]
fn tune_answers_with_a_spec_that_renders_and_says_where_nothing_serves() {
    let here = prepared();
    let tune = ["tune", "scene.toml", "--only", "unshadowed,ray-traced", "--samples", "32"];
    let told = stdout(halfshade(here.path()).args(tune).args(["--max-error", "0.1"]));
    let answer =
        told.lines().find(|line| line.starts_with("ray-traced:") && line.contains("at most")).expect("an answer");
    assert!(answer.contains("(at most 10 %)") && told.contains("settings"), "{told}");
    let spec = answer.split(": error").next().unwrap();
    stdout(halfshade(here.path()).args(["render", "scene.toml", "--strategy", spec, "-o", "it.png"]));
    assert!(here.path().join("out/tune-scene/report.html").exists());
    let none = halfshade(here.path()).args(tune).args(["--max-error", "1e-9"]).assert().code(1).get_output().clone();
    let told = String::from_utf8(none.stdout).unwrap();
    assert!(told.contains("nothing meets these bounds; ray-traced:"), "{told}");
    assert!(refused(halfshade(here.path()).args(tune)).contains("--max-error"));
    assert!(refused(halfshade(here.path()).args(tune).args(["--max-error", "-1"])).contains("above 0"));
}
