//! Runs on graphics devices, and where there is none.

use super::{EXPERIMENT, prepared, results};
use crate::common::{halfshade, refused, stdout, write};
use serde_json::Value;

/// Strategies that have kernels for graphics devices.
fn asks_for_both() -> String {
    EXPERIMENT.replace("claim", "devices = [\"cpu\", \"gpu\"]\nclaim").replacen(
        "receivers = [\"vertices\", \"pixels\"]",
        "receivers = [\"vertices\"]",
        1,
    )
}

#[test]
fn without_a_device_it_says_what_to_install_and_the_processor_goes_on() {
    let here = prepared();
    write(here.path(), "small.toml", asks_for_both());
    let nowhere = [("VK_DRIVER_FILES", "/nowhere"), ("VK_ICD_FILENAMES", "/nowhere")];
    let error = refused(halfshade(here.path()).envs(nowhere).args(["run", "small.toml"]));
    assert!(error.contains("no graphics device") && error.contains("mesa-vulkan-drivers"), "{error}");
    let render = ["render", "scene.toml", "--strategy", "unshadowed", "--device", "gpu"];
    assert!(refused(halfshade(here.path()).envs(nowhere).args(render)).contains("mesa-vulkan-drivers"));
    let error = refused(halfshade(here.path()).args(["--gpu", "off", "run", "small.toml"]));
    assert!(error.contains("--gpu off"), "{error}");
    assert!(!here.path().join("out").exists());
    assert!(stdout(halfshade(here.path()).envs(nowhere).args(["list", "devices"])).contains("no graphics devices"));
    stdout(halfshade(here.path()).envs(nowhere).args(["run", "small.toml", "--device", "cpu"]));
    assert!(results(here.path())["machine"]["gpu"].is_null());
}

/// The number of devices; fails where one is required and there is none.
fn device_count(here: &std::path::Path) -> usize {
    let text = stdout(halfshade(here).args(["list", "devices", "--json"]));
    let devices: Value = serde_json::from_str(&text).expect("JSON");
    let count = devices.as_array().expect("a list").len();
    let is_required = std::env::var_os("HALFSHADE_REQUIRE_GPU").is_some_and(|value| value == "1");
    assert!(count > 0 || !is_required, "HALFSHADE_REQUIRE_GPU=1, and there is no graphics device");
    count
}

#[test]
fn both_devices_stand_beside_each_other() {
    let here = prepared();
    if device_count(here.path()) == 0 {
        return;
    }
    write(here.path(), "small.toml", asks_for_both() + "[[strategy]]\nname = \"cosine-lobe\"\n");
    let table = stdout(halfshade(here.path()).args(["run", "small.toml"]));
    let has = |start: &str| {
        table.lines().any(|line| line.split_whitespace().collect::<Vec<_>>().join(" ").starts_with(start))
    };
    assert!(has("unshadowed on gpu gpu 0.") && table.contains("read back"), "{table}");
    assert!(has("cosine-lobe on gpu gpu unsupported: no kernels"), "{table}");
    let results = results(here.path());
    assert!(results["machine"]["gpu"].as_str().is_some_and(|gpu| !gpu.is_empty()));
    let runs = results["runs"].as_array().expect("runs");
    let of = |device: Option<&str>| {
        let is_it = |run: &&Value| run["strategy"] == "unshadowed" && run["device"].as_str() == device;
        runs.iter().find(is_it).expect("a run")
    };
    let [cpu, gpu] = [None, Some("gpu")].map(of);
    let error = |run: &Value| run["error"]["rel_rmse"].as_f64().expect("an error");
    assert!((error(cpu) - error(gpu)).abs() < 1e-5, "{} {}", error(cpu), error(gpu));
    assert!(cpu["time"]["read_back_secs"].is_null() && gpu["time"]["read_back_secs"].is_object());
    let difference = &results["differences"][0];
    assert_eq!((&difference["first"], &difference["second"]), (&"unshadowed on gpu".into(), &"unshadowed".into()));
    assert!(difference["max"].as_f64().expect("a difference") < 1e-4, "{difference}");
    let pictures = results["pictures"].as_array().expect("pictures");
    assert!(pictures.iter().any(|picture| picture["label"] == "unshadowed on gpu"), "{pictures:?}");
}

#[test]
fn an_unknown_device_is_refused_with_the_known_ones() {
    let here = prepared();
    if device_count(here.path()) == 0 {
        return;
    }
    let error = refused(halfshade(here.path()).args(["run", "small.toml", "--device", "abacus"]));
    assert!(error.contains("no graphics device `abacus`; there are: 0: "), "{error}");
    let error = refused(halfshade(here.path()).args(["--gpu", "99", "run", "small.toml", "--device", "gpu"]));
    assert!(error.contains("no graphics device `99`"), "{error}");
}
