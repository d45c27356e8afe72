//! Experiments and options that are refused, and plain output.

use super::{EXPERIMENT, prepared};
use crate::common::{halfshade, names, refused, write};
use std::process::Command;

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
        assert!(error.contains(&format!("small.toml:{line}:")) && error.contains(problem), "{to}: {error}");
    }
    let pair = "[\"unshadowed\", \"ray-traced:samples=1\"]";
    write(here.path(), "small.toml", EXPERIMENT.replace("[truth]", &format!("compare = [{pair}, {pair}]\n[truth]")));
    let error = refused(halfshade(here.path()).args(["run", "small.toml"]));
    assert!(error.contains("small.toml:5:") && error.contains("`compare` has this pair"), "{error}");
    assert!(!here.path().join("out").exists());
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
    assert!(plain.contains("\ncorner, frame 0: ") && !plain.contains('\x1b'), "{plain:?}");
}
