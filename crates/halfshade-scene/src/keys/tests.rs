//! A file of a small type: what it may hold, and how mistakes are told.

use super::{Spanned, parse, reference, schema};
use schemars::JsonSchema;
use serde::Deserialize;

#[derive(Debug, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
struct File {
    /// Short name. More about it.
    name: String,
    /// Bands.
    #[schemars(range(min = 1, max = 8))]
    bands: Option<Spanned<usize>>,
    /// A seed.
    #[serde(default)]
    seed: u32,
    /// The light.
    light: Option<Spanned<Light>>,
    /// Ways to go.
    #[serde(default)]
    way: Vec<Spanned<Way>>,
}

/// Light.
#[derive(Debug, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
struct Light {
    /// By channel.
    radiance: [f32; 3],
    kind: Option<Kind>,
}

#[derive(Debug, Deserialize, JsonSchema)]
#[serde(rename_all = "kebab-case")]
enum Kind {
    /// All around.
    FarAway,
    /// A lamp.
    Lamp,
}

#[derive(Debug, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
struct Way {
    steps: Vec<i64>,
    loud: Option<bool>,
}

/// The error of a file with `text` behind a name, without the excerpt.
fn told(text: &str) -> String {
    let error = parse::<File>(&format!("name = \"x\"\n{text}")).unwrap_err().in_file("f.toml").to_string();
    assert!(error.contains("\n  |\n") && error.ends_with('^'), "{error}");
    error.lines().next().unwrap().to_owned()
}

#[test]
fn what_is_allowed_arrives() {
    let text =
        "name = \"x\"\nbands = 4\nlight = { radiance = [1, 2.5, 3], kind = \"far-away\" }\n[[way]]\nsteps = [1, 2]\n";
    let file: File = parse(text).unwrap();
    assert_eq!((file.name.as_str(), file.seed, file.way[0].get_ref().steps.len()), ("x", 0, 2));
    let (bands, light) = (file.bands.unwrap(), file.light.unwrap().into_inner());
    assert_eq!((bands.span(), bands.into_inner()), (19..20, 4));
    assert!(light.radiance == [1.0, 2.5, 3.0] && matches!(light.kind, Some(Kind::FarAway)));
    assert!(file.way[0].get_ref().loud.is_none());
}

#[test]
fn mistakes_are_told_in_words_of_the_file() {
    let mistakes = [
        ("band = 3", "f.toml:2:1: unknown key `band` (did you mean `bands`?); known: name, bands, seed, light, way"),
        ("bands = 9", "f.toml:2:9: `bands` = 9 must be from 1 to 8"),
        ("bands = 99999999999999999999", "f.toml:2:9: `bands` = 99999999999999999999 must be from 1 to 8"),
        ("bands = 4.5", "f.toml:2:9: `bands` must be a whole number, not 4.5"),
        ("bands = \"four\"", "f.toml:2:9: `bands` must be a whole number, not the text \"four\""),
        ("light = { radianec = [1, 1, 1] }", "f.toml:2:11: unknown key `radianec` (did you mean `radiance`?)"),
        ("seed = -1", "f.toml:2:8: `seed` = -1 must be from 0 to 4294967295"),
        ("seed = 5e9", "f.toml:2:8: `seed` must be a whole number, not 5e9"),
        ("light = 3", "f.toml:2:9: `light` must be a table, not 3"),
        ("[light]", "f.toml:2:1: `light` needs the key `radiance` (By channel)"),
        ("light.radiance = [1, 2]", "f.toml:2:18: `radiance` must be a list of 3 numbers, not a list of 2"),
        ("light.radiance = [1, true, 2]", "f.toml:2:22: `radiance` must be a number, not true"),
        (
            "light = { radiance = [1, 1, 1], kind = \"lamb\" }",
            "f.toml:2:40: unknown kind `lamb` (did you mean `lamp`?)",
        ),
        ("light = { radiance = [1, 1, 1], kind = 3 }", "f.toml:2:40: `kind` must be \"far-away\" or \"lamp\", not 3"),
        ("[[way]]\nsteps = 1", "f.toml:3:9: `steps` must be a list of whole numbers, not 1"),
        ("[[way]]\nsteps = []\nloud = 1979-05-27", "f.toml:4:8: `loud` must be true or false, not the date 1979-05-27"),
        ("name = \"y\"", "f.toml:2:1: duplicate key"),
        ("bands = ", "f.toml:2:9: string values must be quoted"),
    ];
    for (text, expected) in mistakes {
        let told = told(text);
        assert!(told.starts_with(expected), "{text}: {told}");
    }
    let error = parse::<File>("").unwrap_err();
    assert_eq!((error.line, error.problem.as_str()), (Some(1), "the file needs the key `name` (Short name)"));
    // The first of several, by place.
    assert!(told("zeal = 1\nband = 1").contains("`zeal`"));
}

#[test]
fn the_schema_and_the_reference_tell_the_same() {
    let schema = schema::<File>();
    assert!(schema["$schema"].as_str().is_some_and(|it| it.contains("draft-07")));
    assert!(!schema.to_string().contains("null") && !schema.to_string().contains("format"), "{schema:#}");
    assert_eq!(schema["properties"]["bands"]["maximum"], 8);
    assert_eq!(schema["required"], serde_json::json!(["name"]));
    let reference = reference(&schema);
    for line in [
        "| `name` | a text in quotes | Short name. More about it. **Needed.** |",
        "| `bands` | a whole number from 1 to 8 | Bands. |",
        "| `seed` | a whole number from 0 to 4294967295 | A seed. Default: `0`. |",
        "| `kind` | \"far-away\" or \"lamp\" | `far-away`: all around. `lamp`: a lamp. |",
        "**`[light]`**: the light.",
        "**`[[way]]`**",
    ] {
        assert!(reference.lines().any(|it| it == line), "{line}\n{reference}");
    }
}
