//! Folders that hold other files, and names that collide.

use super::{EXPERIMENT, MESH, SCENE, assert_kept, long, prepared, started, tree};
use crate::common::{self, folder, halfshade, refused, stdout, write};
use serde_json::Value;
use std::fs;

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
    assert!(notes.contains("replaces results.json, results.csv, report.md, report.html, "), "{notes}");
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
    write(&here.path().join("out/small"), "report.md", "my own words");
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
