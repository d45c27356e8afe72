//! References that experiments ask for.

use crate::common::{folder, halfshade, stdout, write};
use serde_json::Value;
use std::fs;

/// Who reads no spheres is compared with meshes under limited light too: what is left of transfer's error is its rays'.
#[test]
fn limited_light_falls_on_what_a_strategy_knows() {
    let here = folder();
    let scene = "name = \"a\"\n[[object]]\nshape = \"plane\"\nscale = 2\n\
                 [[object]]\nshape = \"box\"\nspheres = 1\ntranslate = [0, 0.6, 0]\nscale = 0.5\n\
                 [environment]\nsky = { sun_elevation_degrees = 40, resolution = 16, sun = false }\n";
    write(here.path(), "a.toml", scene);
    let experiment = "name = \"e\"\nclaim = \"c\"\nreferences = [\"mesh\", \"bands\"]\n[truth]\nsamples = 256\n\
                      [[scene]]\nname = \"a.toml\"\n[[strategy]]\nname = \"sh-exp\"\nbands = 3\n\
                      [[strategy]]\nname = \"prt\"\nbands = 3\n";
    write(here.path(), "e.toml", experiment);
    stdout(halfshade(here.path()).args(["run", "e.toml"]));
    let json: Value = serde_json::from_slice(&fs::read(here.path().join("out/e/results.json")).unwrap()).unwrap();
    let errors: Vec<(&str, &str, f64)> = (json["runs"].as_array().unwrap().iter())
        .map(|run| (run["strategy"].as_str().unwrap(), &run["error"]))
        // Rows of references are there, too.
        .filter(|(name, _)| *name != "reference")
        .map(|(name, error)| (name, error["reference"].as_str().unwrap(), error["rel_rmse"].as_f64().unwrap()))
        .collect();
    let names: Vec<_> = errors.iter().map(|(name, reference, _)| (*name, *reference)).collect();
    let expected = [("sh-exp", "mesh"), ("sh-exp", "bands=3"), ("prt", "mesh"), ("prt", "mesh-bands=3")];
    assert!(expected.iter().all(|one| names.contains(one)) && names.len() == 4, "{names:?}");
    let of = |wanted: (&str, &str)| errors.iter().find(|(name, reference, _)| (*name, *reference) == wanted).unwrap().2;
    assert!(of(("prt", "mesh-bands=3")) < 0.25 * of(("prt", "mesh")), "{errors:?}");
    let table = stdout(halfshade(here.path()).args(["report", "out/e"]));
    assert!(table.contains("against the mesh and its bands of light"), "{table}");
}
