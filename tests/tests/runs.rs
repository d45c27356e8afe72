//! Runs that are interrupted, resumed, repeated, or given folders and inputs that are not what they were: nothing is
//! lost, and nothing is mixed.

mod common;

use common::{folder, halfshade, names, refused, stdout, write};
use serde_json::Value;
use std::{
    collections::BTreeMap,
    fs,
    path::{Path, PathBuf},
    process::{Child, Command, Stdio},
    time::Duration,
};

const SCENE: &str = "name = \"corner\"\n[[object]]\nmesh = \"tetrahedron.obj\"\nspheres = 2\n\
                     [[object]]\nshape = \"plane\"\nscale = 3\n\
                     [camera]\neye = [0, 2, 5]\ntarget = [0, 0.5, 0]\nresolution = [24, 16]\n";

const MESH: &str = "v 0 0 0\nv 1 0 0\nv 0 1 0\nv 0 0 1\nf 1 3 2\nf 1 2 4\nf 1 4 3\nf 2 3 4\n";

const EXPERIMENT: &str = r#"
name = "small"
claim = "none"
receivers = ["vertices", "pixels"]
[truth]
samples = 64
[timing]
warm_up = 1
repeats = 3
[pictures]
[[scene]]
name = "scene.toml"
[[strategy]]
name = "unshadowed"
[[strategy]]
name = "ray-traced"
samples = [1, 4]
"#;

/// A folder with the experiment and all that it reads.
fn prepared() -> tempfile::TempDir {
    let here = folder();
    write(here.path(), "small.toml", EXPERIMENT);
    write(here.path(), "scene.toml", SCENE);
    write(here.path(), "tetrahedron.obj", MESH);
    here
}

fn start(here: &Path, arguments: &[&str]) -> Child {
    Command::new(env!("CARGO_BIN_EXE_halfshade-under-test"))
        .current_dir(here)
        .env("HALFSHADE_CACHE", here.join("cache"))
        .args(arguments)
        .stdout(Stdio::null())
        .stderr(Stdio::piped())
        .spawn()
        .expect("started")
}

/// Starts the experiment and waits until its journal has so many lines; fails if the run ends before.
fn started(here: &Path, lines: usize) -> Child {
    let mut child = start(here, &["run", "small.toml"]);
    let journal = here.join("out/small/.halfshade/journal.jsonl");
    while fs::read(&journal).map_or(0, |bytes| bytes.iter().filter(|byte| **byte == b'\n').count()) < lines {
        assert!(child.try_wait().expect("a status").is_none(), "the run ended too early");
        std::thread::sleep(Duration::from_millis(1));
    }
    child
}

/// An experiment that takes long enough to be interrupted.
fn long(here: &Path) {
    write(here, "small.toml", EXPERIMENT.replace("repeats = 3", "repeats = 10000"));
}

fn results(here: &Path) -> Value {
    serde_json::from_slice(&fs::read(here.join("out/small/results.json")).expect("results")).expect("JSON")
}

/// All that isn't time: the text of what every run was found to be, and the bytes of every picture.
fn found(here: &Path) -> (Vec<String>, BTreeMap<PathBuf, Vec<u8>>) {
    let results = results(here);
    let of_run = |run: &Value| format!("{} {} {} {}", run["label"], run["receivers"], run["error"], run["truth"]);
    let runs = results["runs"].as_array().expect("runs").iter().map(of_run).collect();
    let tree = tree(&here.join("out/small/pictures"));
    (runs, tree.into_iter().filter_map(|(path, bytes)| Some((path, bytes?))).collect())
}

/// Everything below a folder: files with their bytes, links with where they lead, folders.
fn tree(folder: &Path) -> BTreeMap<PathBuf, Option<Vec<u8>>> {
    let mut tree = BTreeMap::new();
    for entry in fs::read_dir(folder).into_iter().flatten() {
        let path = entry.expect("an entry").path();
        if path.is_symlink() {
            let target = fs::read_link(&path).expect("a link");
            tree.insert(path, Some(target.to_string_lossy().into_owned().into_bytes()));
        } else if path.is_dir() {
            tree.extend(self::tree(&path));
            tree.insert(path, None);
        } else {
            let bytes = fs::read(&path).expect("read");
            tree.insert(path, Some(bytes));
        }
    }
    tree
}

/// Fails if anything that was there before is gone or has changed.
fn assert_kept(before: &BTreeMap<PathBuf, Option<Vec<u8>>>, folder: &Path) {
    let after = tree(folder);
    for (path, content) in before {
        assert_eq!(after.get(path), Some(content), "{}", path.display());
    }
}

#[test]
fn a_run_that_is_killed_goes_on_to_the_same_results() {
    let here = prepared();
    write(here.path(), "small.toml", EXPERIMENT.replace("repeats = 3", "repeats = 400"));
    stdout(halfshade(here.path()).args(["run", "small.toml"]));
    let expected = found(here.path());
    assert_eq!(expected.0.len(), 6);
    assert!(expected.1.len() >= 11, "{:?}", expected.1.keys());
    // Killed while the first receivers are timed: what was measured of them is kept, and not measured again.
    fs::remove_dir_all(here.path().join("out")).unwrap();
    let mut child = started(here.path(), 12);
    child.kill().unwrap();
    child.wait().unwrap();
    let journal = fs::read_to_string(here.path().join("out/small/.halfshade/journal.jsonl")).unwrap();
    let timed = journal.split_inclusive('\n').filter(|line| line.ends_with('\n')).find_map(|line| {
        let [_, fact]: [Value; 2] = serde_json::from_str(line).unwrap();
        fact.get("timed").filter(|timed| timed["key"].as_str().unwrap().contains("unshadowed")).cloned()
    });
    stdout(halfshade(here.path()).args(["run", "small.toml", "--resume"]));
    assert_eq!(found(here.path()), expected);
    let results = results(here.path());
    for run in results["runs"].as_array().unwrap() {
        assert_eq!(run["time"]["samples"].as_array().unwrap().len(), 400);
    }
    assert_eq!(results["runs"][0]["time"]["samples"][0], timed.unwrap()["sample"]);
    assert_eq!(names(&here.path().join("out/small/.halfshade")), ["lock", "written"]);
}

/// Moments are drawn from the same numbers each time, over somewhat more than a run takes; a run that ends before it is
/// killed begins anew.
#[test]
fn twenty_kills_at_any_moment_change_no_error() {
    let here = prepared();
    let begun = std::time::Instant::now();
    stdout(halfshade(here.path()).args(["run", "small.toml"]));
    let whole = begun.elapsed();
    let expected = found(here.path());
    fs::remove_dir_all(here.path().join("out")).unwrap();
    let mut state = 0x2545_f491_4f6c_dd1d_u64;
    let mut random = || {
        state = state.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
        (state >> 40) as f64 / (1_u64 << 24) as f64
    };
    let mut finished = 0;
    for _ in 0..20 {
        let mut child = start(here.path(), &["run", "small.toml", "--resume"]);
        std::thread::sleep(whole.min(Duration::from_secs(2)).mul_f64(random()));
        child.kill().unwrap();
        let status = child.wait_with_output().unwrap();
        assert_ne!(status.status.code(), Some(2), "{}", String::from_utf8_lossy(&status.stderr));
        if status.status.success() {
            finished += 1;
            assert_eq!(found(here.path()), expected);
            fs::remove_dir_all(here.path().join("out")).unwrap();
        }
    }
    assert!(finished < 20);
    stdout(halfshade(here.path()).args(["run", "small.toml", "--resume"]));
    assert_eq!(found(here.path()), expected);
    assert_eq!(names(&here.path().join("out/small/.halfshade")), ["lock", "written"]);
}

#[cfg(unix)]
#[test]
fn what_was_in_the_folder_before_is_there_afterwards() {
    use std::os::unix::fs::symlink;
    let here = prepared();
    let out = here.path().join("out/small");
    for file in [
        "truth/precious.txt",
        "pictures/mine.png",
        "plots/mine.svg",
        "notes.md",
        "journal.jsonl",
        "deep/a/b",
        ".halfshade/.halfshade-notes",
        ".halfshade/unfinished-notes",
        ".halfshade/journal.old",
        ".halfshade/truth/notes.bin",
        ".halfshade/truth/unfinished-notes",
    ] {
        write(&out, file, "precious");
    }
    write(here.path(), "elsewhere/truth-0.bin", "precious");
    let elsewhere = here.path().join("elsewhere");
    for (target, link) in
        [(&elsewhere, "folder"), (&elsewhere.join("truth-0.bin"), "file"), (&"none".into(), "nothing")]
    {
        symlink(target, out.join(link)).unwrap();
        symlink(target, out.join("truth").join(link)).unwrap();
    }
    let before = [tree(&out), tree(&elsewhere)];
    let assert_all =
        || [&out, &elsewhere].into_iter().zip(&before).for_each(|(folder, tree)| assert_kept(tree, folder));
    // Interrupted, gone on with, finished, repeated, and one that fails.
    long(here.path());
    let mut child = started(here.path(), 9);
    child.kill().unwrap();
    child.wait().unwrap();
    assert_all();
    write(here.path(), "small.toml", EXPERIMENT);
    assert!(refused(halfshade(here.path()).args(["run", "small.toml", "--resume"])).contains("experiment file"));
    assert_all();
    stdout(halfshade(here.path()).args(["run", "small.toml"]));
    assert_all();
    stdout(halfshade(here.path()).args(["run", "small.toml", "--resume"]));
    let again = halfshade(here.path()).args(["run", "small.toml"]).assert().success().get_output().clone();
    let notes = String::from_utf8(again.stderr).unwrap();
    assert!(notes.contains("replaces results.json, results.csv, report.md, "), "{notes}");
    assert_all();
    write(here.path(), "scene.toml", SCENE.replace("eye = [0, 2, 5]", "eye = [0, 2, 5000000]"));
    drop(halfshade(here.path()).args(["run", "small.toml"]).output().unwrap());
    assert_all();
    assert!(out.join("results.json").exists());
}

#[cfg(unix)]
#[test]
fn what_stands_in_the_way_of_results_is_named_and_left() {
    use std::os::unix::fs::symlink;
    for file in ["results.json", "report.md", "results.csv", "pictures", "plots", ".halfshade"] {
        let here = prepared();
        let out = here.path().join("out/small");
        write(&out, file, "precious");
        let before = tree(&out);
        let error = refused(halfshade(here.path()).args(["run", "small.toml"]));
        assert!(error.contains(&format!("small/{file}: ")) && error.contains("move it away"), "{error}");
        assert_eq!(tree(&out), before);
        fs::remove_file(out.join(file)).unwrap();
        symlink("nowhere", out.join(file)).unwrap();
        let before = tree(&out);
        let error = refused(halfshade(here.path()).args(["run", "small.toml"]));
        assert!(error.contains(&format!("small/{file}: ")), "{error}");
        assert_eq!(tree(&out), before);
    }
    // A file that a run wrote and somebody changed is somebody's.
    let here = prepared();
    stdout(halfshade(here.path()).args(["run", "small.toml"]));
    let report = here.path().join("out/small/report.md");
    fs::write(&report, "my own words").unwrap();
    let error = refused(halfshade(here.path()).args(["run", "small.toml"]));
    assert!(error.contains("report.md: this is in the way"), "{error}");
    assert_eq!(fs::read(&report).unwrap(), b"my own words");
    // A folder that is a link is the folder.
    fs::create_dir(here.path().join("real")).unwrap();
    symlink("real", here.path().join("link")).unwrap();
    stdout(halfshade(here.path()).args(["run", "small.toml", "--out", "link"]));
    assert!(here.path().join("link").is_symlink() && here.path().join("real/results.json").exists());
}

#[test]
fn scenes_and_strategies_never_share_a_picture() {
    let here = folder();
    let scene = |name: &str, color: &str| {
        format!(
            "name = '{name}'\n[[object]]\nshape = \"plane\"\n[environment]\nconstant = {color}\n\
             [camera]\neye = [0, 2, 2]\ntarget = [0, 0, 0]\nresolution = [8, 6]\n"
        )
    };
    let names =
        ["東京", "大阪", "Vase", "vase", "VASE", "é", "e\u{301}", "con", "a.", "a ", "a/b", "..", &"n".repeat(260)];
    let mut text = "name = \"names\"\nclaim = \"none\"\n[truth]\nsamples = 16\n[timing]\nwarm_up = 0\nrepeats = 1\n\
                    [pictures]\n[[strategy]]\nname = \"unshadowed\"\n"
        .to_owned();
    for (number, name) in names.iter().enumerate() {
        write(here.path(), &format!("{number}.toml"), scene(name, &format!("[{number}, 1, 1]")));
        text += &format!("[[scene]]\nname = \"{number}.toml\"\n");
    }
    write(here.path(), "names.toml", &text);
    stdout(halfshade(here.path()).args(["run", "names.toml"]));
    let out = here.path().join("out/names");
    let results: Value = serde_json::from_slice(&fs::read(out.join("results.json")).unwrap()).unwrap();
    let pictures = results["pictures"].as_array().unwrap();
    assert_eq!(pictures.len(), 2 * names.len());
    let mut seen = std::collections::HashSet::new();
    for files in pictures {
        for key in ["exr", "png", "error_png"] {
            let Some(file) = files[key].as_str() else { continue };
            assert!(seen.insert(file.to_lowercase()), "{file}");
            assert!(out.join(file).exists(), "{file}");
        }
    }
    assert_eq!(common::names(&out.join("plots")).len(), 2 * names.len());
    // Red is the scene's number over π times the albedo.
    let truths = pictures.iter().filter(|files| files["label"] == "truth");
    for (number, files) in truths.enumerate() {
        let image = exr::prelude::read_first_rgba_layer_from_file(
            out.join(files["exr"].as_str().unwrap()),
            |size, _| vec![0.0_f32; size.area()],
            |reds: &mut Vec<f32>, place, (red, _, _, _): (f32, f32, f32, f32)| reds[place.x() + 8 * place.y()] = red,
        )
        .unwrap();
        let reds = image.layer_data.channel_data.pixels;
        let largest = reds.into_iter().fold(0.0, f32::max);
        assert!((largest - 0.8 * number as f32).abs() < 1e-3, "{number}: {largest}");
    }
}

#[test]
fn a_changed_input_is_named_and_nothing_is_mixed() {
    let here = prepared();
    long(here.path());
    let mut child = started(here.path(), 9);
    child.kill().unwrap();
    child.wait().unwrap();
    for (file, text) in
        [("tetrahedron.obj", MESH.replace("v 0 1 0", "v 0 2 0")), ("scene.toml", SCENE.replace("3", "4"))]
    {
        let sound = fs::read(here.path().join(file)).unwrap();
        write(here.path(), file, text);
        let error = refused(halfshade(here.path()).args(["run", "small.toml", "--resume"]));
        assert!(error.contains(&format!("cannot resume: `{file}` has changed")), "{error}");
        write(here.path(), file, sound);
    }
    write(here.path(), "small.toml", EXPERIMENT);
    stdout(halfshade(here.path()).args(["run", "small.toml"]));
    let finished = fs::read(here.path().join("out/small/results.json")).unwrap();
    // Finished: said, and not done again.
    let again = halfshade(here.path()).args(["run", "small.toml", "--resume"]).assert().success().get_output().clone();
    let notes = String::from_utf8(again.stderr).unwrap();
    assert!(notes.contains("this run is finished"), "{notes}");
    assert_eq!(fs::read(here.path().join("out/small/results.json")).unwrap(), finished);
    // Files that have gone since are written again as they were, except pictures, which need shading.
    let out = here.path().join("out/small");
    let before = tree(&out);
    for name in ["report.md", "results.csv"] {
        fs::remove_file(out.join(name)).unwrap();
    }
    fs::remove_dir_all(out.join("plots")).unwrap();
    let resumed = || {
        let output =
            halfshade(here.path()).args(["run", "small.toml", "--resume"]).assert().success().get_output().clone();
        String::from_utf8(output.stderr).unwrap()
    };
    let notes = resumed();
    assert!(notes.contains("written again from its results: results.csv, report.md, 4 in plots"), "{notes}");
    let is_kept = |(path, _): &(PathBuf, Option<Vec<u8>>)| !path.ends_with(".halfshade/written");
    let after: BTreeMap<_, _> = tree(&out).into_iter().filter(is_kept).collect();
    assert_eq!(after, before.into_iter().filter(is_kept).collect());
    fs::remove_dir_all(out.join("pictures")).unwrap();
    fs::remove_file(out.join("report.md")).unwrap();
    let notes = resumed();
    assert!(notes.contains("in pictures; pictures are drawn again by a run without --resume only"), "{notes}");
    assert!(!fs::read_to_string(out.join("report.md")).unwrap().contains("](pictures/"));
    write(here.path(), "baseline.json", &finished);
    let check = ["check", "small.toml", "--baseline", "baseline.json"];
    assert!(stdout(halfshade(here.path()).args(check)).contains("0 failed"));
    // Another mesh is no regression.
    write(here.path(), "tetrahedron.obj", MESH.replace("v 0 1 0", "v 0 2 0"));
    let error = refused(halfshade(here.path()).args(check));
    assert!(error.contains("made from other files") && error.contains("`tetrahedron.obj` has changed"), "{error}");
    let error = refused(halfshade(here.path()).args(["run", "small.toml", "--resume"]));
    assert!(error.contains("the run is finished, and `tetrahedron.obj` has changed"), "{error}");
    assert_eq!(fs::read(here.path().join("out/small/results.json")).unwrap(), finished);
    // Baselines of earlier versions don't tell.
    let mut old: Value = serde_json::from_slice(&finished).unwrap();
    let inputs = old.as_object_mut().unwrap().remove("inputs").unwrap();
    let paths: Vec<&str> = inputs.as_array().unwrap().iter().map(|file| file["path"].as_str().unwrap()).collect();
    assert_eq!(paths, ["scene.toml", "tetrahedron.obj"]);
    write(here.path(), "baseline.json", old.to_string());
    let output = halfshade(here.path()).args(check).output().unwrap();
    assert!(String::from_utf8_lossy(&output.stderr).contains("doesn't tell what its scenes were read from"));
}

#[test]
fn textures_buffers_and_probes_are_inputs_too() {
    let here = prepared();
    let mut hdr = b"#?RADIANCE\nFORMAT=32-bit_rle_rgbe\n\n-Y 4 +X 8\n".to_vec();
    hdr.extend([128u8, 128, 128, 129].repeat(32));
    write(here.path(), "light/sky.hdr", &hdr);
    let number = |value: f32| value.to_le_bytes();
    let places = [0.0, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0, 1.0, 0.0, 0.0, 1.0];
    let bytes: Vec<u8> = places.into_iter().flat_map(number).collect();
    write(here.path(), "mesh/a b.bin", &bytes);
    // The smallest PNG: one grey pixel.
    let png: &[u8] = &[
        137, 80, 78, 71, 13, 10, 26, 10, 0, 0, 0, 13, 73, 72, 68, 82, 0, 0, 0, 1, 0, 0, 0, 1, 8, 0, 0, 0, 0, 58, 126,
        155, 85, 0, 0, 0, 10, 73, 68, 65, 84, 120, 156, 99, 104, 0, 0, 0, 130, 0, 129, 119, 205, 114, 182, 0, 0, 0, 0,
        73, 69, 78, 68, 174, 66, 96, 130,
    ];
    write(here.path(), "mesh/grey.png", png);
    write(
        here.path(),
        "mesh/a.gltf",
        r#"{"asset":{"version":"2.0"},"scene":0,"scenes":[{"nodes":[0]}],"nodes":[{"mesh":0}],
        "meshes":[{"primitives":[{"attributes":{"POSITION":0,"TEXCOORD_0":1},"material":0}]}],
        "materials":[{"pbrMetallicRoughness":{"baseColorTexture":{"index":0}}}],
        "textures":[{"source":0}],"images":[{"uri":"grey.png"}],
        "accessors":[{"bufferView":0,"componentType":5126,"count":3,"type":"VEC3","min":[0,0,0],"max":[1,1,0]},
        {"bufferView":1,"componentType":5126,"count":3,"type":"VEC2"}],
        "bufferViews":[{"buffer":0,"byteLength":36},{"buffer":0,"byteOffset":36,"byteLength":24}],
        "buffers":[{"byteLength":60,"uri":"a%20b.bin"}]}"#,
    );
    write(
        here.path(),
        "scenes/scene.toml",
        "[[object]]\nmesh = \"../mesh/a.gltf\"\nspheres = 0\n[environment]\nimage = \"../light/sky.hdr\"\n\
         [camera]\neye = [0, 0, 3]\ntarget = [0, 0, 0]\nresolution = [8, 6]\n",
    );
    write(
        here.path(),
        "e/small.toml",
        "name = \"small\"\nclaim = \"none\"\n[truth]\nsamples = 16\n[[scene]]\nname = \"../scenes/scene.toml\"\n\
         [[strategy]]\nname = \"unshadowed\"\n",
    );
    stdout(halfshade(here.path()).args(["run", "e/small.toml"]));
    let inputs = &results(here.path())["inputs"];
    let paths: Vec<&str> = inputs.as_array().unwrap().iter().map(|file| file["path"].as_str().unwrap()).collect();
    let expected = [
        "../scenes/../light/sky.hdr",
        "../scenes/../mesh/a b.bin",
        "../scenes/../mesh/a.gltf",
        "../scenes/../mesh/grey.png",
        "../scenes/scene.toml",
    ];
    assert_eq!(paths, expected);
}

#[test]
fn two_runs_do_not_share_a_folder() {
    let here = prepared();
    long(here.path());
    let mut child = started(here.path(), 9);
    for resume in [&[][..], &["--resume"]] {
        let error = refused(halfshade(here.path()).args(["run", "small.toml"]).args(resume));
        assert!(error.contains("out/small: another run is writing into this folder"), "{error}");
    }
    child.kill().unwrap();
    child.wait().unwrap();
    // A killed run keeps no lock.
    write(here.path(), "small.toml", EXPERIMENT);
    stdout(halfshade(here.path()).args(["run", "small.toml"]));
}

#[cfg(unix)]
#[test]
fn an_interrupt_says_how_to_go_on() {
    let here = prepared();
    long(here.path());
    let child = started(here.path(), 9);
    let sent = Command::new("kill").args(["-INT", &child.id().to_string()]).status().unwrap();
    assert!(sent.success());
    let output = child.wait_with_output().unwrap();
    assert_eq!(output.status.code(), Some(130));
    let text = String::from_utf8(output.stderr).unwrap();
    let last = text.lines().last().unwrap();
    assert!(last.starts_with("interrupted; what was measured is kept; go on with: "), "{text}");
    assert!(last.ends_with(" run small.toml --resume"), "{text}");
    let journal = fs::read_to_string(here.path().join("out/small/.halfshade/journal.jsonl")).unwrap();
    assert!(journal.lines().count() >= 9);
}

#[test]
fn what_is_named_twice_is_refused_with_its_line() {
    let here = prepared();
    for (from, to, line, problem) in [
        ("claim", "frames = [0, 0]\nclaim", 3, "name each once"),
        ("\"vertices\", \"pixels\"", "\"pixels\", \"pixels\"", 4, "name each once"),
        ("[truth]", "references = [\"mesh\", \"mesh\"]\n[truth]", 5, "name each once"),
        ("\"scene.toml\"", "\"scene.toml\"\nframes = [0, 0]", 13, "name each once"),
        ("[1, 4]", "[4, 1, 4]", 17, "list each value once"),
        ("samples = [1, 4]", "samples = 1\n[[strategy]]\nname = \"unshadowed\"", 19, "listed above already"),
        ("[[strategy]]", "[[scene]]\nname = \"scene.toml\"\n[[strategy]]", 14, "is listed twice"),
        ("[truth]", "compare = [[\"unshadowed\", \"unshadowed\"]]\n[truth]", 5, "with itself"),
        ("[pictures]", "[pictures]\nstrategies = [\"unshadowed\", \"unshadowed\"]", 11, "name each once"),
    ] {
        write(here.path(), "small.toml", EXPERIMENT.replacen(from, to, 1));
        let error = refused(halfshade(here.path()).args(["run", "small.toml"]));
        assert!(error.contains(&format!("small.toml:{line}: ")) && error.contains(problem), "{to}: {error}");
    }
    let pair = "[\"unshadowed\", \"ray-traced:samples=1\"]";
    write(here.path(), "small.toml", EXPERIMENT.replace("[truth]", &format!("compare = [{pair}, {pair}]\n[truth]")));
    assert!(
        refused(halfshade(here.path()).args(["run", "small.toml"])).contains("small.toml:5: `compare` has this pair")
    );
    assert!(!here.path().join("out").exists());
}

#[test]
fn a_picture_replaces_no_input_and_says_what_it_replaces() {
    let here = prepared();
    let mut hdr = b"#?RADIANCE\nFORMAT=32-bit_rle_rgbe\n\n-Y 4 +X 8\n".to_vec();
    hdr.extend([128u8, 128, 128, 129].repeat(32));
    write(here.path(), "sky.hdr", &hdr);
    let render = |arguments: &[&str]| {
        let mut command = halfshade(here.path());
        command.args(["truth", "tetrahedron.obj", "--samples", "16", "--resolution", "8x4"]).args(arguments);
        command
    };
    stdout(&mut render(&["-o", "sky.exr", "--env", "sky.hdr"]));
    let probe = fs::read(here.path().join("sky.exr")).unwrap();
    let error = refused(&mut render(&["--env", "sky.exr", "-o", "sky.exr"]));
    assert!(error.contains("sky.exr: is read as input"), "{error}");
    assert_eq!(fs::read(here.path().join("sky.exr")).unwrap(), probe);
    let again = render(&["-o", "sky.exr"]).assert().success().get_output().clone();
    assert!(String::from_utf8(again.stderr).unwrap().contains("sky.exr is there already and will be replaced"));
    let error =
        refused(halfshade(here.path()).args(["spheres", "tetrahedron.obj", "-n", "2", "-o", "tetrahedron.obj"]));
    assert!(error.contains("tetrahedron.obj: is read as input"), "{error}");
    assert_eq!(fs::read_to_string(here.path().join("tetrahedron.obj")).unwrap(), MESH);
    let long = format!("{}.exr", "n".repeat(260));
    assert!(refused(&mut render(&["-o", &long])).contains("cannot write"));
}

#[test]
fn absurd_numbers_on_the_command_line_are_refused_at_once() {
    let here = prepared();
    let picture = ["render", "scene.toml", "--strategy", "unshadowed"];
    for (option, values) in [
        ("--threads", &["0", "1025", "100000", "18446744073709551615", "-1", "nan"][..]),
        ("--exposure", &["nan", "inf", "-inf", "1e9"]),
        ("--resolution", &["16384x16384", "0x5", "4294967296x1", "-1x5"]),
        ("--background", &["nan", "inf", "-1"]),
        ("--bounces", &["17", "18446744073709551615", "-1"]),
        ("--frame", &["18446744073709551615", "7", "-1"]),
    ] {
        for value in values {
            let option = format!("{option}={value}");
            let error = refused(halfshade(here.path()).args(picture).arg(&option));
            assert!(!error.contains("wrote"), "{option}");
        }
    }
    for samples in ["0", "4000000000", "18446744073709551615"] {
        refused(halfshade(here.path()).args(["truth", "scene.toml", "--samples", samples]));
    }
    assert_eq!(names(here.path()), ["scene.toml", "small.toml", "tetrahedron.obj"]);
}

/// On a terminal, which the program `script` stands in for where there is one.
#[cfg(target_os = "linux")]
#[test]
fn colours_and_bars_are_left_out_where_nobody_can_see_them() {
    let here = prepared();
    let program = env!("CARGO_BIN_EXE_halfshade-under-test");
    let said = |arguments: &str, variables: &[(&str, &str)]| {
        let mut command = Command::new("script");
        command.args(["-qec", &format!("{program} {arguments}"), "/dev/null"]).current_dir(here.path());
        for name in ["NO_COLOR", "CLICOLOR", "CLICOLOR_FORCE", "CI", "TERM", "COLORTERM"] {
            command.env_remove(name);
        }
        let output = command.envs(variables.iter().copied()).env("HALFSHADE_CACHE", here.path().join("cache")).output();
        output.ok().map(|output| String::from_utf8_lossy(&output.stdout).into_owned())
    };
    let Some(colored) = said("run none.toml", &[("TERM", "xterm")]) else { return };
    assert!(colored.contains("\x1b["), "{colored:?}");
    for variables in
        [&[("TERM", "dumb")][..], &[("TERM", "xterm"), ("NO_COLOR", "1")], &[("TERM", "xterm"), ("CLICOLOR", "0")]]
    {
        for arguments in ["run none.toml", "run --nonsense", "--help"] {
            let plain = said(arguments, variables).unwrap();
            assert!(!plain.is_empty() && !plain.contains('\x1b'), "{arguments} {variables:?}: {plain:?}");
        }
    }
    let plain = said("run small.toml", &[("TERM", "dumb")]).unwrap();
    assert!(plain.contains("### corner") && !plain.contains('\x1b'), "{plain:?}");
}
