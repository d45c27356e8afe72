//! The guide: its recipes run, its tables are those of the declarations, and templates are what it says.
//!
//! `HALFSHADE_SPLICE=1` writes the tables anew.

use crate::common::{folder, halfshade, refused, stdout, write};
use crate::pages::{read, splice};
use halfshade_harness::{Experiment, experiment};
use halfshade_scene::{file, keys::reference};
use serde_json::Value;
use std::{fs, path::Path};

#[test]
fn the_guide_explains_every_key() {
    splice("GUIDE.md", "keys of scene files", &reference(&file::schema()));
    splice("GUIDE.md", "keys of experiment files", &reference(&experiment::schema()));
}

/// Blocks of code in a language, without their fences.
fn blocks(page: &str, language: &str) -> Vec<String> {
    let fence = format!("```{language}\n");
    page.split(&fence).skip(1).filter_map(|rest| Some(rest.split_once("```")?.0.to_owned())).collect()
}

/// A small Radiance HDR file, flat (not run-length encoded).
fn probe() -> Vec<u8> {
    let mut bytes = b"#?RADIANCE\nFORMAT=32-bit_rle_rgbe\n\n-Y 8 +X 16\n".to_vec();
    bytes.extend([128u8, 128, 128, 129].repeat(16 * 8));
    bytes
}

/// Files as the guide has them, but for pictures of fewer pixels; commands as it has them.
#[test]
fn recipes_run() {
    let (here, page) = (folder(), read("GUIDE.md"));
    write(here.path(), "bunny.obj", "v 0 0 0\nv 90 0 0\nv 0 90 0\nv 0 0 90\nf 1 3 2\nf 1 2 4\nf 1 4 3\nf 2 3 4\n");
    write(here.path(), "probe.hdr", probe());
    let mut files = 0;
    for text in blocks(&page, "toml") {
        let Some(name) = text.lines().next().and_then(|line| line.strip_prefix("# ")) else { continue };
        let small = text
            .replace("[320, 240]", "[24, 18]")
            .replace("spheres = 32", "spheres = 2")
            .replace("0, 10, 20, 30", "0, 30");
        write(here.path(), name, small.replace("samples = 256", "samples = 16"));
        files += 1;
    }
    let commands: Vec<String> = blocks(&page, "sh").iter().flat_map(|block| block.lines()).map(str::to_owned).collect();
    assert!(files == 3 && commands.len() >= 4, "{files} files, {commands:?}");
    for command in commands {
        let arguments = command.strip_prefix("halfshade ").expect("a command of ours");
        let shown = stdout(halfshade(here.path()).args(arguments.split_whitespace()));
        assert!(!shown.contains("failed") && !shown.contains("unsupported"), "{command}: {shown}");
    }
    let rows = fs::read_to_string(here.path().join("drops.csv")).expect("rows").lines().count();
    assert_eq!(rows, 1 + 2 * 3);
    assert!(here.path().join("bunny.png").exists() && here.path().join("out/compare-bunny/report.html").exists());
}

/// The names of all keys that a schema knows.
fn keys(schema: &Value, found: &mut Vec<String>) {
    for (key, property) in schema["properties"].as_object().into_iter().flatten() {
        found.push(key.clone());
        keys(property, found);
        keys(&property["items"], found);
    }
}

#[test]
fn templates_name_every_key_and_run() {
    let here = folder();
    for (kind, schema) in [("scene", file::schema()), ("experiment", experiment::schema())] {
        halfshade(here.path()).args(["new", kind]).assert().success();
        let name = format!("{kind}.toml");
        let text = fs::read_to_string(here.path().join(&name)).expect("a template");
        let mut known = Vec::new();
        keys(&schema, &mut known);
        let words: Vec<&str> = text.split(|c: char| !(c.is_alphanumeric() || c == '_')).collect();
        let missing: Vec<&String> = known.iter().filter(|key| !words.contains(&key.as_str())).collect();
        assert!(known.len() > 30 && missing.is_empty(), "{name}: {missing:?}");
        let error = refused(halfshade(here.path()).args(["new", kind]));
        assert!(error.contains(&format!("{name}: cannot create")), "{error}");
        assert_eq!(fs::read_to_string(here.path().join(&name)).expect("left alone"), text);
    }
    let render = ["render", "scene.toml", "--strategy", "unshadowed", "--resolution", "16x12", "-o", "s.exr"];
    halfshade(here.path()).args(render).assert().success();
    let experiment = Experiment::load(&here.path().join("experiment.toml")).expect("a sound template");
    assert!(experiment.timing.is_some() && experiment.pictures.is_some());
    let text = fs::read_to_string(here.path().join("experiment.toml")).expect("a template");
    write(here.path(), "small.toml", text.replace("[320, 240]", "[24, 18]").replace("bands = [3, 4]", "bands = 2"));
    let shown = stdout(halfshade(here.path()).args(["run", "small.toml", "--quick"]));
    assert!(shown.contains("Verdict") && !shown.contains("unsupported"), "{shown}");
}

/// The mistakes of a value, by the part of JSON Schema that ours use.
fn mistakes(schema: &Value, value: &Value, path: &str) -> Vec<String> {
    let wrong = |what: &str| vec![format!("{path}: {what}: {value}")];
    if let Some(alternatives) = schema["anyOf"].as_array() {
        let fits = alternatives.iter().any(|schema| mistakes(schema, value, path).is_empty());
        return if fits { Vec::new() } else { wrong("no alternative") };
    }
    let constants = schema["oneOf"].as_array().into_iter().flatten().map(|choice| &choice["const"]);
    let words: Vec<&Value> = schema["enum"].as_array().into_iter().flatten().chain(constants).collect();
    if !words.is_empty() && !words.contains(&value) {
        return wrong("none of the words");
    }
    let outside = |number: f64| {
        schema["minimum"].as_f64().is_some_and(|min| number < min)
            || schema["maximum"].as_f64().is_some_and(|max| number > max)
    };
    match (schema["type"].as_str(), value) {
        (Some("object"), Value::Object(table)) => {
            let needed = schema["required"].as_array().into_iter().flatten();
            let mut found: Vec<String> = needed
                .filter(|key| !table.contains_key(key.as_str().unwrap_or_default()))
                .map(|key| format!("{path}: no {key}"))
                .collect();
            for (key, value) in table {
                let known = schema["properties"].get(key).unwrap_or(&schema["additionalProperties"]);
                let path = format!("{path}.{key}");
                match known {
                    Value::Bool(false) | Value::Null => found.push(format!("{path}: unknown")),
                    schema => found.extend(mistakes(schema, value, &path)),
                }
            }
            found
        }
        (Some("array"), Value::Array(list)) => {
            let count = list.len() as u64;
            let fits = schema["minItems"].as_u64().is_none_or(|min| count >= min)
                && schema["maxItems"].as_u64().is_none_or(|max| count <= max);
            let found = list.iter().flat_map(|item| mistakes(&schema["items"], item, path));
            if fits { found.collect() } else { wrong("length") }
        }
        (Some("integer"), Value::Number(number)) if number.is_i64() && !number.as_f64().is_some_and(outside) => {
            Vec::new()
        }
        (Some("number"), Value::Number(number)) if !number.as_f64().is_some_and(outside) => Vec::new(),
        (Some("string"), Value::String(_)) | (Some("boolean"), Value::Bool(_)) => Vec::new(),
        (None, _) => Vec::new(),
        _ => wrong("another type"),
    }
}

#[test]
fn files_of_the_repository_fit_the_schemas_that_are_printed() {
    let here = folder();
    let root = Path::new(env!("CARGO_MANIFEST_DIR")).join("..");
    let printed = |kind: &str| -> Value {
        serde_json::from_str(&stdout(halfshade(here.path()).args(["schema", kind]))).expect("JSON")
    };
    let check = |folder: &str, schema: &Value| {
        let entries = fs::read_dir(root.join(folder)).expect("a folder").map(|entry| entry.expect("an entry").path());
        let paths: Vec<_> = entries.filter(|path| path.extension().is_some_and(|ending| ending == "toml")).collect();
        for path in &paths {
            let text = fs::read_to_string(path).expect("text");
            let value: Value = toml::from_str(&text).unwrap_or_else(|error| panic!("{}: {error}", path.display()));
            assert_eq!(mistakes(schema, &value, &path.display().to_string()), [""; 0]);
        }
        paths.len()
    };
    let (scene, experiment) = (printed("scene"), printed("experiment"));
    assert!(check("experiments/scenes", &scene) >= 5 && check("experiments", &experiment) >= 30);
    // The check itself finds what is wrong.
    let value = serde_json::json!({ "object": [{ "shape": "cow", "sphere": 1, "spheres": -1, "albedo": [1, 2] }] });
    assert_eq!(mistakes(&scene, &value, "").len(), 4);
}
