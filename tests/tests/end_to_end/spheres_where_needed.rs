//! Sphere sets are built for those who read them: all others need not wait.

use crate::common::{folder, halfshade, write};
use std::{fs, path::Path};

/// How many sets a cache holds.
fn sets(cache: &Path) -> usize {
    let files = |folder: &Path| fs::read_dir(folder).map_or(0, |entries| entries.count());
    fs::read_dir(cache).map_or(0, |entries| {
        entries
            .map(|entry| entry.expect("an entry").path())
            .filter(|path| path.file_name().is_some_and(|name| name.to_string_lossy().starts_with("spheres")))
            .map(|path| if path.is_dir() { files(&path) } else { 1 })
            .sum()
    })
}

#[test]
fn sets_are_built_for_those_who_read_them() {
    let here = folder();
    write(here.path(), "s.toml", "[[object]]\nshape = \"box\"\nspheres = 2\n");
    let cache = here.path().join("cache");
    let run = |arguments: &[&str]| {
        let always = ["s.toml", "--resolution", "8x6", "-o", "p.exr", "--cache", "cache"];
        halfshade(here.path()).args(arguments).args(always).assert().success();
        sets(&cache)
    };
    assert_eq!(run(&["truth", "--samples", "16"]), 0);
    for strategy in ["unshadowed", "ray-traced:samples=1", "shadow-field:shells=4,resolution=4,map=8"] {
        assert_eq!(run(&["render", "--strategy", strategy]), 0, "{strategy}");
    }
    assert_eq!(run(&["render", "--strategy", "sh-exp:bands=2"]), 1);
    let experiment = |references: &str| {
        format!(
            "name = \"e\"\nclaim = \"c\"\nreferences = [{references}]\n[truth]\nsamples = 16\n[[scene]]\n\
             name = \"s.toml\"\n[[strategy]]\nname = \"unshadowed\"\n"
        )
    };
    for (references, expected) in [("\"mesh\"", 0), ("\"mesh\", \"spheres\"", 1)] {
        write(here.path(), "e.toml", experiment(references));
        let cache = format!("cache-{expected}");
        halfshade(here.path())
            .args(["run", "e.toml", "--out", &format!("out-{expected}"), "--cache", &cache])
            .assert()
            .success();
        assert_eq!(sets(&here.path().join(&cache)), expected, "{references}");
    }
}
