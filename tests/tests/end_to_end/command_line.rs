//! The command line as a contract: what goes in, what comes out, how mistakes are answered.

use crate::common::{folder, halfshade, names, refused, stdout, write};
use serde_json::Value;
use std::{fs, path::Path};

const SMALL: &str = r#"
name = "small"
claim = "none"
references = ["mesh", "spheres"]
[truth]
samples = 16
[timing]
warm_up = 1
repeats = 3
[pictures]
resolution = [24, 16]
[[scene]]
name = "one-sphere"
[[strategy]]
name = "unshadowed"
[[strategy]]
name = "ray-traced"
samples = [1, 4]
"#;

#[test]
fn help_and_version_go_to_stdout_and_usage_errors_end_with_2() {
    let here = folder();
    assert!(stdout(halfshade(here.path()).arg("--help")).contains("Usage: halfshade"));
    assert!(stdout(halfshade(here.path()).arg("--version")).starts_with("halfshade 0."));
    for arguments in [&[][..], &["dance"], &["list"], &["list", "poems"], &["run"], &["spheres", "a.obj", "-n", "0"]] {
        halfshade(here.path()).args(arguments).assert().code(2).stdout("");
    }
    refused(halfshade(here.path()).args(["--threads", "0", "list", "scenes"]));
    // The commit in parentheses, where git could tell.
    let version = stdout(halfshade(here.path()).arg("--version"));
    assert_eq!(version, format!("halfshade {}\n", halfshade::REVISION));
}

#[test]
fn shells_and_manuals_know_every_command() {
    let here = folder();
    for shell in ["bash", "zsh", "fish", "elvish", "powershell"] {
        let script = stdout(halfshade(here.path()).args(["completions", shell]));
        assert!(script.contains("halfshade") && script.contains("strategy") && script.contains("compare"), "{shell}");
    }
    let page = stdout(halfshade(here.path()).arg("man"));
    assert!(page.contains(".TH halfshade 1") && page.contains("halfshade\\-render(1)"), "{page}");
    let page = stdout(halfshade(here.path()).args(["man", "render"]));
    assert!(page.contains(".TH halfshade\\-render 1") || page.contains(".TH halfshade-render 1"), "{page}");
    assert!(page.contains("strategy") && page.contains("quiet"), "{page}");
    let error = refused(halfshade(here.path()).args(["man", "rendre"]));
    assert!(error.contains("unknown command `rendre` (did you mean `render`?)"), "{error}");
}

#[test]
fn what_is_told_beside_the_data_is_for_the_user_to_choose() {
    let here = folder();
    let told = |more: &[&str]| {
        let arguments = ["truth", "one-sphere", "--samples", "16", "--resolution", "8x6", "-o", "t.exr"];
        let output = halfshade(here.path()).args(arguments).args(more).assert().success().get_output().clone();
        assert!(String::from_utf8(output.stdout).unwrap().contains("samples: 16"));
        String::from_utf8(output.stderr).unwrap()
    };
    assert_eq!(told(&[]), "note: wrote t.exr\n");
    let verbose = told(&["-v"]);
    assert!(verbose.lines().count() > 1 && verbose.contains("note: wrote t.exr"), "{verbose}");
    assert_eq!(told(&["--quiet"]), "");
    refused(halfshade(here.path()).args(["list", "scenes", "-q", "-v"]));
}

#[test]
fn lists_name_every_parameter_for_people_and_programs() {
    let here = folder();
    let text = stdout(halfshade(here.path()).args(["list", "strategies"]));
    assert!(text.contains("ray-traced") && text.contains("samples = "), "{text}");
    let json: Value =
        serde_json::from_str(&stdout(halfshade(here.path()).args(["list", "strategies", "--json"]))).unwrap();
    for strategy in json.as_array().unwrap() {
        for parameter in strategy["parameters"].as_array().unwrap() {
            for key in ["name", "summary", "type", "default", "range"] {
                assert!(!parameter[key].is_null(), "{key} of {parameter}");
            }
        }
    }
    let scenes: Value =
        serde_json::from_str(&stdout(halfshade(here.path()).args(["list", "scenes", "--json"]))).unwrap();
    for name in ["vases", "ducks", "squirrel-and-balls"] {
        assert!(scenes.as_array().unwrap().iter().any(|scene| scene["name"] == name), "{name}");
    }
}

/// Checks the experiment `small.toml` against its own `results` as a baseline, and against damaged ones.
fn assert_checked(here: &Path, results: &Value) {
    // The same program finds the same errors; a baseline that was better makes it fail, and says what moved.
    let check = ["check", "small.toml", "--baseline", "base.json"];
    fs::copy(here.join("out/small/results.json"), here.join("base.json")).unwrap();
    let verdict = stdout(halfshade(here).args(check));
    assert!(verdict.contains("7 errors compared, 0 failed") && !verdict.contains("| "), "{verdict}");
    let mut better = results.clone();
    let rmse = better["runs"][1]["error"]["rmse"].as_f64().unwrap();
    better["runs"][1]["error"]["rmse"] = (0.5 * rmse).into();
    write(here, "base.json", better.to_string());
    let failed = halfshade(here).args(check).assert().code(1).get_output().clone();
    let table = String::from_utf8(failed.stdout).unwrap();
    assert!(table.contains("FAILED: error grew") && table.contains("1 failed"), "{table}");
    // A baseline is not taken at its word.
    let doctored = |change: &dyn Fn(&mut Value)| {
        let mut baseline = results.clone();
        change(&mut baseline);
        write(here, "base.json", baseline.to_string());
        halfshade(here).args(check).output().unwrap()
    };
    let refused_for = |change: &dyn Fn(&mut Value), problem: &str| {
        let output = doctored(change);
        let text = String::from_utf8(output.stderr).unwrap();
        assert!(output.status.code() == Some(2) && text.contains("base.json") && text.contains(problem), "{text}");
    };
    refused_for(&|it| it["runs"] = Value::Array(Vec::new()), "no errors to compare with");
    refused_for(&|it| it["runs"][1]["error"]["p99_noise"] = (-1.0).into(), "below 0");
    refused_for(&|it| it["runs"][1]["receiver_count"] = 3.into(), "the receivers of the baseline are 3");
    refused_for(&|it| it["runs"][1]["truth"]["samples"] = 1.into(), "the samples of the baseline are 1");
    let fails: [&dyn Fn(&mut Value); 3] = [
        &|it| drop(it["runs"].as_array_mut().unwrap().pop()),
        &|it| (it["runs"][1]["error"]["rmse"], it["runs"][1]["error"]["rmse_noise"]) = (1e-9.into(), 1e9.into()),
        &|it| it["runs"][1]["error"]["classes"][0]["mae"] = 0.into(),
    ];
    for fails in fails {
        let output = doctored(fails);
        assert_eq!(output.status.code(), Some(1), "{}", String::from_utf8_lossy(&output.stderr));
    }
}

/// From scenes and SPECs alone to a verdict; the experiment that is printed is the one that ran.
#[test]
fn a_comparison_needs_no_file() {
    let here = folder();
    let scene = "name = \"a box\"\n[[object]]\nshape = \"box\"\nspheres = 1\n[environment]\nconstant = [1, 1, 1]\n\
                 [camera]\neye = [0, 2, 4]\ntarget = [0, 0, 0]\nresolution = [16, 12]\n";
    write(here.path(), "box.toml", scene);
    let arguments =
        ["compare", "box.toml", "--strategy", "unshadowed", "--strategy", "ray-traced:samples=2,filter=none"];
    let more = ["--baseline", "ray-traced:samples=2,filter=none", "--samples", "16", "--no-pictures"];
    let shown = stdout(halfshade(here.path()).args(arguments).args(more));
    assert!(shown.starts_with("a box, frame 0: ") && shown.contains("\nVerdict: a box, frame 0, pixels\n"), "{shown}");
    assert!(shown.contains("1 (baseline)"), "{shown}");
    let runs = |folder: &str| -> Vec<Value> {
        let text = fs::read_to_string(here.path().join(folder).join("results.json")).unwrap();
        serde_json::from_str::<Value>(&text).unwrap()["runs"].as_array().unwrap().clone()
    };
    assert_eq!(runs("out/compare-box").len(), 2);
    let text = stdout(halfshade(here.path()).args(arguments).args(more).arg("--print"));
    write(here.path(), "kept.toml", text);
    stdout(halfshade(here.path()).args(["run", "kept.toml", "--out", "kept", "--only", "ray-traced"]));
    let kept = runs("kept");
    assert_eq!((kept.len(), &kept[0]["label"]), (1, &"ray-traced:samples=2,filter=none".into()));
    assert_eq!(kept[0]["error"], runs("out/compare-box")[1]["error"]);
    let error = refused(halfshade(here.path()).args(["run", "kept.toml", "--only", "prt"]));
    assert!(
        error.contains("kept.toml: has no scene or strategy `prt`; it has box.toml, unshadowed, ray-traced"),
        "{error}"
    );
    let error = refused(halfshade(here.path()).args(["compare", "nowhere"]));
    assert!(error.contains("error: unknown scene `nowhere`; built in: "), "{error}");
}

/// One picture tells its time, and its error if asked; at one exposure pictures of different light compare.
#[test]
fn a_picture_tells_its_time_and_error() {
    let here = folder();
    for (name, light) in [("dim", 0.25), ("bright", 0.5)] {
        let scene = format!(
            "name = \"{name}\"\n[[object]]\nshape = \"box\"\nspheres = 1\n[environment]\nconstant = [{light}, {light}, {light}]\n\
             [camera]\neye = [0, 2, 4]\ntarget = [0, 0, 0]\nresolution = [16, 12]\n"
        );
        write(here.path(), &format!("{name}.toml"), scene);
    }
    let render = |scene: &str, file: &str, more: &[&str]| {
        let arguments = ["render", scene, "--strategy", "unshadowed", "-o", file];
        stdout(halfshade(here.path()).args(arguments).args(more))
    };
    let told = render("dim.toml", "dim.exr", &["--truth", "--samples", "16"]);
    let keys = ["threads: ", "bake_secs: ", "shade_secs: ", "frames_per_sec: ", "\nrel_rmse: ", "\nresolved: "];
    assert!(keys.iter().all(|key| told.contains(key)), "{told}");
    let brightest = |file: &str| image::open(here.path().join(file)).unwrap().to_rgb8().pixels().map(|p| p.0[1]).max();
    for (scene, file) in [("dim.toml", "dim.png"), ("bright.toml", "bright.png")] {
        let told = render(scene, file, &["--exposure", "0"]);
        assert!(!told.contains("rel_rmse"), "{told}");
    }
    assert!(brightest("dim.png") < brightest("bright.png"));
}

#[test]
fn an_experiment_runs_checks_reports_and_resumes() {
    let here = folder();
    write(here.path(), "small.toml", SMALL);
    let table = stdout(halfshade(here.path()).args(["run", "small.toml"]));
    assert!(
        table.starts_with("one-sphere, frame 0: ") && table.contains("\nVerdict: one-sphere, frame 0, vertices\n"),
        "{table}"
    );
    let out = here.path().join("out/small");
    assert_eq!(
        names(&out),
        [".halfshade", "pictures", "plots", "report.html", "report.md", "results.csv", "results.json"]
    );
    assert_eq!(names(&out.join(".halfshade")), ["lock", "written"]);
    let text = fs::read_to_string(out.join("results.json")).unwrap();
    let json: Value = serde_json::from_str(&text).unwrap();
    assert_eq!(json["schema"], "halfshade.results/1");
    let runs = json["runs"].as_array().unwrap();
    // One row for the spheres themselves, then three strategies against two references.
    assert_eq!(runs.len(), 1 + 3 * 2);
    for run in &runs[1..] {
        assert_eq!(run["status"], "ok", "{run}");
        assert_eq!(run["time"]["samples"].as_array().unwrap().len(), 3);
        assert!(run["time"]["frames_per_sec"].as_f64().unwrap() > 0.0);
        // The mean error may be nothing, once the truth's noise is taken off.
        assert!(run["error"]["max"].as_f64().unwrap() > 0.0);
    }
    let against_mesh = runs.iter().filter(|run| run["error"]["reference"] == "mesh" && run["strategy"] != "reference");
    assert!(against_mesh.clone().count() == 3 && against_mesh.clone().all(|run| run["error"]["ssim"].is_number()));
    for picture in json["pictures"].as_array().unwrap() {
        assert!(
            out.join(picture["png"].as_str().unwrap()).exists() && out.join(picture["exr"].as_str().unwrap()).exists()
        );
    }
    assert_eq!(fs::read_to_string(out.join("results.csv")).unwrap().lines().count(), 1 + runs.len());

    for (format, start) in [
        ("md", "# small"),
        ("csv", "scene,frame"),
        ("latex", "% halfshade "),
        ("html", "<!DOCTYPE html>"),
        ("text", "small\n=====\n"),
    ] {
        let report = stdout(halfshade(here.path()).args(["report", "out/small", "--format", format]));
        assert!(report.starts_with(start), "{format}: {report}");
    }
    let report = stdout(halfshade(here.path()).args(["report", "out/small"]));
    let [verdict, evidence] =
        ["### Verdict: one-sphere", "### Where the error comes from"].map(|part| report.find(part));
    assert!(verdict.is_some() && verdict < evidence, "{report}");
    assert_eq!(stdout(halfshade(here.path()).args(["report", "out/small", "-o", "moved.md"])), "");
    assert_eq!(fs::read_to_string(here.path().join("moved.md")).unwrap(), report);
    let error = refused(halfshade(here.path()).args(["report", "out/small", "-o", "out/small/results.json"]));
    assert!(error.contains("results.json: is read as input"), "{error}");
    // Pictures that went elsewhere leave no dead links.
    let pictures = [out.join("pictures"), here.path().join("elsewhere")];
    let linked = || stdout(halfshade(here.path()).args(["report", "out/small"])).contains("](pictures/");
    assert!(linked());
    fs::rename(&pictures[0], &pictures[1]).unwrap();
    assert!(!linked());
    fs::rename(&pictures[1], &pictures[0]).unwrap();

    assert_checked(here.path(), &json);

    // Resuming something else, or from a damaged journal, is refused; nothing to resume starts anew.
    write(&out.join(".halfshade"), "journal.jsonl", "{\"schema\":\n");
    let error = refused(halfshade(here.path()).args(["run", "small.toml", "--resume"]));
    assert!(error.contains("journal.jsonl"), "{error}");
    assert_eq!(fs::read_to_string(out.join("results.json")).unwrap(), text, "refusing must leave results alone");
}

#[test]
fn mistakes_in_experiments_name_the_line_and_leave_nothing_behind() {
    let here = folder();
    let cases = [
        ("samples = 16", "sampels = 16", "bad.toml:6:1: unknown key `sampels` (did you mean `samples`?)"),
        (
            "name = \"ray-traced\"",
            "name = \"raytraced\"",
            "bad.toml:17:8: unknown strategy `raytraced` (did you mean `ray-traced`?); known: unshadowed, ray-traced",
        ),
        ("samples = [1, 4]", "samples = [1, 0]", "bad.toml:18:1: "),
        ("samples = [1, 4]", "rays = 4", "bad.toml:18:1: strategy `ray-traced`: unknown parameter `rays`; known: "),
        ("\"one-sphere\"", "\"two-spheres\"", "bad.toml:13:8: unknown scene `two-spheres`; built in: "),
        ("[[scene]]", "frames = [9999]\n[[scene]]", "unknown key"),
        ("claim = \"none\"", "claim = \"none\"\nframes = [99999]", "there is no frame 99999"),
        ("\"one-sphere\"", "\"one-sphere\"\nstill = 99999", "bad.toml:14:9: scene `one-sphere` has"),
        ("[\"mesh\", \"spheres\"]", "[\"cubes\"]", "bad.toml:4:14: unknown reference `cubes`"),
        ("repeats = 3", "repeats = 0", "bad.toml:9:11: `repeats` = 0 must be from 1 to "),
        ("samples = 16", "samples = 0", "bad.toml:6:11: `samples` = 0 must be from 1 to "),
        (
            "name = \"one-sphere\"",
            "name = \"one-sphere\"\nspheres = 0",
            "bad.toml:14:11: `spheres` = 0 must be from 1 to ",
        ),
    ];
    for (from, to, expected) in cases {
        // A byte-order mark is no text, and moves no line.
        for mark in ["", "\u{feff}"] {
            write(here.path(), "bad.toml", mark.to_owned() + &SMALL.replace(from, to));
            let error = refused(halfshade(here.path()).args(["run", "bad.toml"]));
            assert!(error.contains(expected), "{to}: {error}");
        }
    }
    assert!(refused(halfshade(here.path()).args(["run", "none.toml"])).contains("none.toml: cannot be read"));
    assert_eq!(names(here.path()), ["bad.toml"]);
}

#[test]
fn a_scene_held_still_is_for_methods_that_need_one() {
    let here = folder();
    let strategy = "prt:directions=16,bands=2";
    let arguments =
        ["render", "one-sphere", "--strategy", strategy, "--frame", "50", "--resolution", "8x8", "-o", "a.exr"];
    let error = refused(halfshade(here.path()).args(arguments));
    assert!(error.contains("moves against") && error.contains("ray-traced"), "{error}");
    halfshade(here.path()).args(arguments).arg("--still").assert().success();
    let still = SMALL
        .replace("\"one-sphere\"", "\"one-sphere\"\nstill = 50")
        .replace("name = \"unshadowed\"", "name = \"prt\"\ndirections = 16");
    assert!(still.contains("still = 50") && still.contains("\"prt\""));
    write(here.path(), "still.toml", still);
    let text = stdout(halfshade(here.path()).args(["run", "still.toml"]));
    assert!(text.contains("one-sphere, still at frame 50") && !text.contains("unsupported"), "{text}");
}

#[test]
fn pictures_have_the_layers_and_size_asked_for() {
    let here = folder();
    let size = ["--resolution", "20x10"];
    halfshade(here.path())
        .args(["render", "one-sphere", "--strategy", "unshadowed", "-o", "a.exr"])
        .args(size)
        .assert()
        .success();
    let text =
        stdout(halfshade(here.path()).args(["truth", "one-sphere", "--samples", "16", "-o", "t.exr"]).args(size));
    assert!(text.contains("rms_standard_error: "), "{text}");
    halfshade(here.path())
        .args(["render", "one-sphere", "--strategy", "ray-traced:samples=2", "--receivers", "vertices", "-o", "b.png"])
        .args(size)
        .assert()
        .success();
    let channels = |name: &str| {
        let image = exr::prelude::read_all_data_from_file(here.path().join(name)).unwrap();
        let attributes = &image.layer_data[0].attributes;
        let [comments, software] =
            [&attributes.comments, &attributes.software_name].map(|text| text.as_ref().unwrap().to_string());
        assert!(comments.starts_with("scene: one-sphere\nframe: 0\nstrategy: "), "{comments}");
        assert_eq!(software, format!("halfshade {}", halfshade::REVISION));
        assert_eq!((image.layer_data.len(), image.layer_data[0].size.x(), image.layer_data[0].size.y()), (1, 20, 10));
        image.layer_data[0].channel_data.list.iter().map(|channel| channel.name.to_string()).collect::<Vec<_>>()
    };
    assert_eq!(channels("a.exr"), ["B", "G", "R"]);
    assert_eq!(channels("t.exr"), ["B", "G", "R", "stderr.B", "stderr.G", "stderr.R"]);
    assert_eq!(&fs::read(here.path().join("b.png")).unwrap()[1..4], b"PNG");
    assert_eq!(names(here.path()), ["a.exr", "b.png", "t.exr"]);
}

#[test]
fn bad_requests_for_pictures_are_refused_before_any_work() {
    let here = folder();
    let render = |arguments: &[&str]| {
        refused(halfshade(here.path()).arg("render").args(arguments).args(["--resolution", "8x8"]))
    };
    assert!(render(&["one-sphere", "--strategy", "magic"]).contains("known: unshadowed, ray-traced"));
    assert!(render(&["one-sphere", "--strategy", "ray-traced:samples=none"]).contains("expected 1..="));
    assert!(render(&["no-sphere", "--strategy", "unshadowed"]).contains("vases"));
    assert!(render(&["one-sphere", "--strategy", "unshadowed", "-o", "a.jpg"]).contains(".exr or .png"));
    assert!(render(&["one-sphere", "--strategy", "unshadowed", "-o", "none/a.exr"]).contains("cannot write"));
    assert!(render(&["one-sphere", "--strategy", "unshadowed", "-o", "."]).contains(".exr or .png"));
    assert!(render(&["one-sphere", "--strategy", "unshadowed", "--frame", "99999"]).contains("no frame"));
    assert!(render(&["one-sphere", "--strategy", "unshadowed", "--background", "nan"]).contains("not negative"));
    assert!(render(&["one-sphere", "--strategy", "sh-exp:bands=2,bands=4"]).contains("`bands` is set twice"));
    for wrong in [&["truth", "one-sphere", "--samples", "0"][..], &["spheres", "a.obj", "-n", "0"]] {
        assert!(refused(halfshade(here.path()).args(wrong)).contains("expected a whole number from 1 to "));
    }
    assert_eq!(names(here.path()), [""; 0]);
}

#[test]
fn an_output_that_cannot_be_written_ends_with_2_and_leaves_nothing() {
    let here = folder();
    write(here.path(), "small.toml", SMALL);
    write(here.path(), "taken", "a file");
    let error = refused(halfshade(here.path()).args(["run", "small.toml", "--out", "taken/out"]));
    assert!(error.contains("error: taken: a folder is needed here, and this is none"), "{error}");
    // Always full.
    if Path::new("/dev/full").exists() {
        fs::create_dir(here.path().join("full")).unwrap();
        std::os::unix::fs::symlink("/dev/full", here.path().join("full/a.exr")).unwrap();
        let render = ["render", "one-sphere", "--strategy", "unshadowed", "--resolution", "8x8", "-o", "full/a.exr"];
        let error = refused(halfshade(here.path()).args(render));
        assert!(error.contains("a.exr: cannot write"), "{error}");
        assert_eq!(names(&here.path().join("full")), ["a.exr"]);
        let full = fs::OpenOptions::new().write(true).open("/dev/full").unwrap();
        let output = std::process::Command::new(env!("CARGO_BIN_EXE_halfshade-under-test"))
            .args(["list", "scenes"])
            .stdout(full)
            .output()
            .unwrap();
        assert_eq!(output.status.code(), Some(2));
    }
    assert!(!here.path().join("out").exists());
}

#[test]
fn strategies_are_compared_with_each_other_where_an_experiment_asks_for_it() {
    let here = folder();
    let pair = |second: &str| {
        SMALL.replace("[truth]", &format!("compare = [[\"ray-traced:samples=4\", {second:?}]]\n[truth]"))
    };
    write(here.path(), "small.toml", pair("ray-traced:samples=1"));
    stdout(halfshade(here.path()).args(["run", "small.toml"]));
    let json: Value = serde_json::from_slice(&fs::read(here.path().join("out/small/results.json")).unwrap()).unwrap();
    let [difference] = &json["differences"].as_array().unwrap()[..] else { panic!("one pair") };
    assert_eq!(difference["first"], "ray-traced:samples=4");
    let mae = difference["mae"].as_f64().unwrap();
    assert!(mae > 0.0 && mae < difference["mean"].as_f64().unwrap(), "{difference}");
    let report = stdout(halfshade(here.path()).args(["report", "out/small"]));
    let [verdict, evidence] =
        ["### Verdict: one-sphere", "### Where the error comes from"].map(|part| report.find(part));
    assert!(verdict.is_some() && verdict < evidence, "{report}");
    assert!(report.contains("| ray-traced:samples=4 | ray-traced:samples=1 |"), "{report}");
    write(here.path(), "small.toml", pair("ray-traced:samples=2"));
    let error = refused(halfshade(here.path()).args(["run", "small.toml"]));
    assert!(error.contains("small.toml:5") && error.contains("not among the strategies"), "{error}");
}

#[test]
fn damaged_results_are_refused_by_name() {
    let here = folder();
    write(here.path(), "results.json", "{\"schema\": \"halfshade.results/1\", \"runs\": [");
    for arguments in [&["report", "."][..], &["report", "results.json", "--format", "csv"]] {
        assert!(refused(halfshade(here.path()).args(arguments)).contains("results.json"));
    }
    write(here.path(), "small.toml", SMALL);
    let error = refused(halfshade(here.path()).args(["check", "small.toml", "--baseline", "results.json"]));
    assert!(error.contains("results.json:1") && error.contains("damaged"), "{error}");
    assert!(refused(halfshade(here.path()).args(["report", "nowhere"])).contains("nowhere: cannot be read"));
}

#[test]
fn bounces_reach_truth_strategies_and_results_and_mistakes_name_their_line() {
    let here = folder();
    let picture = ["--resolution", "24x16"];
    let mean = |bounces: &str| -> f64 {
        let arguments = ["truth", "one-sphere", "--samples", "64", "-o", "t.exr", "--bounces", bounces];
        let text = stdout(halfshade(here.path()).args(arguments).args(picture));
        text.lines().find_map(|line| line.strip_prefix("rms_standard_error: ")).unwrap().parse().unwrap()
    };
    assert!(mean("0") > 0.0 && mean("2") > 0.0);
    for bounces in ["0", "1"] {
        let arguments = ["render", "one-sphere", "--strategy", "sh-exp", "-o", "r.exr", "--bounces", bounces];
        stdout(halfshade(here.path()).args(arguments).args(picture));
        fs::rename(here.path().join("r.exr"), here.path().join(format!("{bounces}.exr"))).unwrap();
    }
    let read = |name: &str| fs::read(here.path().join(name)).unwrap();
    assert_ne!(read("0.exr"), read("1.exr"));
    let flat = ["render", "one-sphere", "--strategy", "unshadowed", "--bounces", "1"];
    assert!(refused(halfshade(here.path()).args(flat)).contains("can't model interreflection; sh-exp and prt can"));
    assert!(refused(halfshade(here.path()).args(["truth", "one-sphere", "--bounces", "99"])).contains("at most"));

    let bounced = SMALL
        .replace("name = \"one-sphere\"", "name = \"one-sphere\"\nbounces = 1\nspheres = 2\nfit = \"shadow\"")
        + "[[strategy]]\nname = \"sh-exp\"\n";
    write(here.path(), "bounced.toml", &bounced);
    stdout(halfshade(here.path()).args(["run", "bounced.toml"]));
    let json: Value = serde_json::from_slice(&read("out/small/results.json")).unwrap();
    let runs = json["runs"].as_array().unwrap();
    let of = |strategy: &str| runs.iter().find(|run| run["strategy"] == strategy).unwrap();
    assert_eq!(of("sh-exp")["error"]["transport"], "bounces=1");
    assert_eq!(of("sh-exp")["scene"], "one-sphere, 2 spheres, fitted to shadows");
    assert_eq!(of("unshadowed")["status"], "unsupported");
    for (line, problem) in [
        ("bounces = 99", "must be from 0 to"),
        ("camera = { eye = [0, 0, 0], target = [0, 0, 0], vertical_fov_degrees = 40 }", "camera:"),
    ] {
        write(here.path(), "bad.toml", bounced.replace("bounces = 1", line));
        let message = refused(halfshade(here.path()).args(["run", "bad.toml"]));
        assert!(message.contains("bad.toml:14") && message.contains(problem), "{message}");
    }
    let difference = "difference = [\"sh-exp\", \"sh-exp:bands=7\"]\n[[scene]]";
    write(here.path(), "bad.toml", bounced.replace("[[scene]]", difference));
    assert!(refused(halfshade(here.path()).args(["run", "bad.toml"])).contains("not among the strategies"));
}
