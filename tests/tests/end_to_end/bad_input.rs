//! Files that are missing, cut off, empty, or full of nonsense: a clear error, status 2, no panic, nothing left behind.

use crate::common::{folder, halfshade, names, refused, stdout, write};
use std::fs;

const TRIANGLES: &str = "v 0 0 0\nv 1 0 0\nv 0 1 0\nv 0 0 1\nf 1 3 2\nf 1 2 4\nf 1 4 3\nf 2 3 4\n";

/// A small Radiance HDR file, flat (not run-length encoded).
fn hdr(width: usize, height: usize) -> Vec<u8> {
    let mut bytes = format!("#?RADIANCE\nFORMAT=32-bit_rle_rgbe\n\n-Y {height} +X {width}\n").into_bytes();
    bytes.extend([128u8, 128, 128, 129].repeat(width * height));
    bytes
}

#[test]
fn meshes_that_cannot_be_used() {
    let here = folder();
    let ply = "ply\nformat ascii 1.0\nelement vertex 3\nproperty float x\nproperty float y\nproperty float z\n\
               element face 1\nproperty list uchar int vertex_indices\nend_header\n0 0 0\n1 0 0\n";
    let cases: [(&str, Vec<u8>); 11] = [
        ("empty.obj", Vec::new()),
        ("points.obj", b"v 0 0 0\nv 1 0 0\n".to_vec()),
        ("nan.obj", TRIANGLES.replace("v 1 0 0", "v nan 0 0").into()),
        ("infinite.obj", TRIANGLES.replace("v 1 0 0", "v inf 0 0").into()),
        ("index.obj", TRIANGLES.replace("f 2 3 4", "f 2 3 9").into()),
        ("zero-area.obj", b"v 0 0 0\nv 1 0 0\nv 2 0 0\nf 1 2 3\n".to_vec()),
        ("cut.obj", TRIANGLES[..TRIANGLES.len() - 5].into()),
        ("cut.ply", ply.into()),
        ("cut.glb", b"glTF\x02\0\0\0\xff\xff\0\0".to_vec()),
        ("nonsense.ply", vec![0xff; 64]),
        ("format.stl", b"solid".to_vec()),
    ];
    for (name, bytes) in &cases {
        write(here.path(), name, bytes);
        let error = refused(halfshade(here.path()).args(["spheres", name, "-n", "2", "-o", "set.json"]));
        assert!(error.contains(name), "{name}: {error}");
        assert!(!here.path().join("set.json").exists(), "{name}");
        refused(halfshade(here.path()).args(["truth", name, "--resolution", "4x4", "-o", "t.exr"]));
    }
    assert!(refused(halfshade(here.path()).args(["spheres", "none.obj", "-n", "2"])).contains("none.obj"));
    assert_eq!(names(here.path()).len(), cases.len());
}

#[test]
fn lights_that_cannot_be_used() {
    let here = folder();
    write(here.path(), "a.obj", TRIANGLES);
    let whole = hdr(16, 8);
    let cases: [(&str, Vec<u8>); 5] = [
        ("empty.hdr", Vec::new()),
        ("cut.hdr", whole[..whole.len() / 2].to_vec()),
        ("shape.hdr", hdr(16, 5)),
        ("cut.exr", b"\x76\x2f\x31\x01\x02\0\0\0chan".to_vec()),
        ("nonsense.exr", vec![7; 100]),
    ];
    for (name, bytes) in &cases {
        write(here.path(), name, bytes);
        let arguments = ["truth", "a.obj", "--env", name, "--resolution", "4x4", "-o", "t.exr"];
        assert!(refused(halfshade(here.path()).args(arguments)).contains(name), "{name}");
    }
    let arguments = ["truth", "a.obj", "--resolution", "4x4", "-o", "t.exr", "--env"];
    for (light, more) in [
        ("sky", ["--clamp", "9"]),
        ("sky", ["--env-layer", "rgba"]),
        ("shape.hdr", ["--clamp", "0"]),
        ("shape.hdr", ["--clamp", "-1"]),
        ("shape.hdr", ["--clamp", "nan"]),
        ("shape.hdr", ["--clamp", "inf"]),
        ("shape.hdr", ["--env-layer", "rgba"]),
    ] {
        refused(halfshade(here.path()).args(arguments).arg(light).args(more));
    }
    let error = refused(halfshade(here.path()).args(["truth", "a.obj", "--env", "moon", "-o", "t.exr"]));
    assert!(error.contains("`sky`, `constant`"), "{error}");
    let error = refused(halfshade(here.path()).args(["truth", "one-sphere", "--env", "sky", "-o", "t.exr"]));
    assert!(error.contains("own light"), "{error}");
    assert!(!here.path().join("t.exr").exists());
    write(here.path(), "whole.hdr", &whole);
    let arguments = ["truth", "a.obj", "--env", "whole.hdr", "--resolution", "4x4", "--samples", "16", "-o", "t.exr"];
    halfshade(here.path()).args(arguments).assert().success();
}

#[test]
fn more_spheres_than_a_mesh_can_use() {
    let here = folder();
    write(here.path(), "a.obj", TRIANGLES);
    let error = refused(halfshade(here.path()).args(["spheres", "a.obj", "-n", "1000000"]));
    assert!(error.contains("1000000") && error.contains("from 1 to 2000"), "{error}");
    write(here.path(), "s.toml", "[[object]]\nmesh = \"a.obj\"\nspheres = 2001\n");
    let error = refused(halfshade(here.path()).args(["truth", "s.toml", "--resolution", "4x4", "-o", "t.exr"]));
    assert!(error.contains("s.toml:3:11: `spheres` = 2001 must be from 0 to 2000"), "{error}");
    let experiment = "name = \"e\"\nclaim = \"c\"\n[truth]\nsamples = 16\n[[scene]]\nname = \"one-sphere\"\n\
                      spheres = 2001\n[[strategy]]\nname = \"unshadowed\"\n";
    write(here.path(), "e.toml", experiment);
    let error = refused(halfshade(here.path()).args(["run", "e.toml"]));
    assert!(error.contains("spheres = 2001") && error.contains("2000"), "{error}");
}

#[test]
fn cameras_that_see_nothing() {
    let here = folder();
    write(here.path(), "a.obj", TRIANGLES);
    let far = "[[object]]\nmesh = \"a.obj\"\nspheres = 1\nscale = 1e-5\ntranslate = [1000, 500, -1000]\n";
    write(here.path(), "far.toml", far);
    let away = "[[object]]\nmesh = \"a.obj\"\n[camera]\neye = [0, 0, 9]\ntarget = [0, 0, 19]\n";
    write(here.path(), "away.toml", away);
    for command in [&["truth"][..], &["render", "--strategy", "unshadowed"]] {
        let run = |scene: &str| {
            let arguments = [scene, "--resolution", "8x6", "-o", "t.exr"];
            refused(halfshade(here.path()).args(command).args(arguments))
        };
        let error = run("far.toml");
        assert!(
            error.contains("far.toml: no camera in single precision") && error.contains("move it nearer"),
            "{error}"
        );
        let error = run("away.toml");
        assert!(error.contains("camera of scene `away` sees nothing"), "{error}");
    }
    assert_eq!(names(here.path()), ["a.obj", "away.toml", "far.toml"]);
}

#[test]
fn scene_files_with_mistakes_name_file_and_line() {
    let here = folder();
    let sound = "[[object]]\nshape = \"sphere\"\nalbedo = [0.5, 0.5, 0.5]\nspheres = 1\nscale = 1\n\
                 [environment]\nconstant = [1, 1, 1]\n";
    let cases = [
        ("scale = 1", "scale = 0", 5),
        ("scale = 1", "scale = -2", 5),
        ("[0.5, 0.5, 0.5]", "[0.5, 0.5, 1.5]", 3),
        ("constant = [1, 1, 1]", "constant = [1, nan, 1]", 7),
        ("constant = [1, 1, 1]", "constant = [1, -1, 1]", 7),
        ("constant = [1, 1, 1]", "constant = [1, inf, 1]", 7),
        ("spheres = 1", "sphere = 1", 4),
        ("\"sphere\"", "\"spere\"", 2),
        ("spheres = 1", "spheres = -1", 4),
    ];
    for (from, to, line) in cases {
        write(here.path(), "bad.toml", sound.replace(from, to));
        let error = refused(halfshade(here.path()).args(["truth", "bad.toml", "--resolution", "4x4", "-o", "t.exr"]));
        assert!(error.contains(&format!("bad.toml:{line}:")), "{to}: {error}");
    }
    write(here.path(), "missing.toml", sound.replace("shape = \"sphere\"", "mesh = \"none.obj\""));
    let error = refused(halfshade(here.path()).args(["truth", "missing.toml", "-o", "t.exr"]));
    assert!(error.contains("none.obj"), "{error}");
    write(here.path(), "good.toml", sound);
    let arguments = ["truth", "good.toml", "--resolution", "4x4", "--samples", "16", "-o", "t.exr"];
    halfshade(here.path()).args(arguments).assert().success();
}

#[test]
fn light_beyond_single_precision_is_refused_and_dim_or_no_light_is_measured() {
    let here = folder();
    let experiment = "name = \"e\"\nclaim = \"none\"\n[truth]\nsamples = 16\n[pictures]\n[[scene]]\nname = \"scene.toml\"\n\
                      [[strategy]]\nname = \"unshadowed\"\n[[strategy]]\nname = \"ray-traced\"\n";
    write(here.path(), "e.toml", experiment);
    let scene = |light: &str| {
        let text = format!(
            "name = \"a|b <i>c</i>\"\n[[object]]\nshape = \"box\"\nspheres = 1\n[environment]\nconstant = [{light}, {light}, {light}]\n\
             [camera]\neye = [0, 2, 4]\ntarget = [0, 0, 0]\nresolution = [12, 12]\n"
        );
        write(here.path(), "scene.toml", text);
    };
    for (light, word) in [("3e38", "not finite"), ("1e-42", "too dim")] {
        scene(light);
        let run = refused(halfshade(here.path()).args(["run", "e.toml", "--out", "out"]));
        let truth = refused(halfshade(here.path()).args(["truth", "scene.toml", "-o", "t.exr"]));
        for error in [run, truth] {
            let named =
                ["scene `a|b <i>c</i>`", "frame 0", "values of the truth", word].map(|part| error.contains(part));
            assert_eq!(named, [true; 4], "{light}: {error}");
        }
        assert!(!here.path().join("out/results.json").exists() && !here.path().join("t.exr").exists());
    }
    for (light, relative) in [("1e36", true), ("1e-30", true), ("0", false)] {
        scene(light);
        let table = stdout(halfshade(here.path()).args(["run", "e.toml", "--out", light]));
        assert!(table.starts_with("a|b <i>c</i>, frame 0: "), "{table}");
        let path = here.path().join(light).join("results.json");
        let json: serde_json::Value = serde_json::from_str(&fs::read_to_string(path).unwrap()).unwrap();
        let error = &json["runs"][0]["error"];
        for key in ["rmse", "bias", "mae", "p95", "p99", "max", "rmse_noise", "max_noise", "ssim"] {
            assert!(error[key].is_number(), "{light}: {key} in {error}");
        }
        assert_eq!(error["rel_rmse"].is_number(), relative, "{light}: {error}");
        assert!(json["pictures"].as_array().unwrap().iter().all(|picture| picture["exposure"].is_number()));
        for format in ["md", "csv", "latex", "html", "text"] {
            let report = stdout(halfshade(here.path()).args(["report", light, "--format", format]));
            assert!(!report.contains("NaN") && !report.contains("inf,"), "{light}: {report}");
        }
    }
}
