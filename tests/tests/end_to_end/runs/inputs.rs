//! Inputs that have changed since a run began.

use super::{EXPERIMENT, MESH, SCENE, long, prepared, results, started, tree};
use crate::common::{halfshade, refused, stdout, write};
use serde_json::Value;
use std::{collections::BTreeMap, fs, path::PathBuf};

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
