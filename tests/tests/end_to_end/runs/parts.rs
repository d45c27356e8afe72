//! Experiments run in parts: joined they are what an undivided run is, and what doesn't belong together isn't joined.

use super::{EXPERIMENT, found, prepared, results, tree};
use crate::common::{halfshade, names, refused, stdout, write};
use serde_json::Value;
use std::{fs, os::unix::fs::PermissionsExt, path::Path, process::Command};

/// Groups that shards cut through, with all that is compared and drawn of them.
fn experiment() -> String {
    let compared = "claim = \"none\"\ncompare = [[\"unshadowed\", \"ray-traced:samples=4\"]]\nreferences = [\"mesh\", \"spheres\"]";
    let drawn = "[pictures]\ndifference = [\"unshadowed\", \"ray-traced:samples=4\"]";
    EXPERIMENT.replace("claim = \"none\"", compared).replace("[pictures]", drawn)
}

fn part(here: &Path, arguments: &[&str]) {
    stdout(halfshade(here).args(["run", "small.toml"]).args(arguments));
}

fn parts(here: &Path) -> Vec<String> {
    let folder = here.join("out/small-parts");
    names(&folder).into_iter().map(|name| folder.join(name).display().to_string()).collect()
}

fn merge(here: &Path) -> String {
    stdout(halfshade(here).arg("merge").args(parts(here)))
}

#[test]
fn shards_joined_are_the_whole_to_the_bit() {
    let here = prepared();
    write(here.path(), "small.toml", experiment());
    part(here.path(), &[]);
    let (whole, expected) = (results(here.path()), found(here.path()));
    for count in [1, 4, 7] {
        for folder in ["out/small", "out/small-parts"] {
            let _ = fs::remove_dir_all(here.path().join(folder));
        }
        (1..=count).rev().for_each(|number| part(here.path(), &["--shard", &format!("{number}/{count}")]));
        assert!(merge(here.path()).contains("ray-traced:samples=4"));
        assert_eq!(found(here.path()), expected, "{count}");
        let joined = results(here.path());
        for key in ["scenes", "differences", "pictures", "inputs", "experiment_hash", "strategies"] {
            assert_eq!(joined[key], whole[key], "{key} of {count}");
        }
        assert!(joined["part"].is_null() && joined["runs"][1]["time"].is_null());
        assert!(here.path().join("out/small/report.html").exists());
    }
    part(here.path(), &["--times"]);
    merge(here.path());
    assert_eq!(found(here.path()), expected);
    let (joined, runs) = (results(here.path()), |of: &Value| of["runs"].as_array().unwrap().clone());
    for (run, of_whole) in runs(&joined).iter().zip(&runs(&whole)) {
        let samples = |run: &Value| run["time"]["samples"].as_array().map(Vec::len);
        assert_eq!(samples(run), samples(of_whole), "{}", run["label"]);
    }
    assert_eq!(runs(&joined).len(), runs(&whole).len());
}

#[test]
fn what_is_missing_doubled_foreign_or_damaged_is_told_and_not_joined() {
    let here = prepared();
    (1..=2).for_each(|number| part(here.path(), &["--shard", &format!("{number}/2")]));
    part(here.path(), &["--times"]);
    part(here.path(), &["--shard", "1/3", "--out", "other/third"]);
    part(here.path(), &["--out", "other/whole"]);
    part(here.path(), &["--shard", "2/2", "--quick", "--out", "other/quick"]);
    write(here.path(), "renamed.toml", EXPERIMENT.replace("none", "another"));
    stdout(halfshade(here.path()).args(["run", "renamed.toml", "--shard", "2/2", "--out", "other/claim"]));
    let [one, two, times] = ["errors-1-of-2", "errors-2-of-2", "times"].map(|name| format!("out/small-parts/{name}"));
    let before = tree(&here.path().join("out"));
    let problem = |folders: &[&str]| refused(halfshade(here.path()).arg("merge").args(folders));
    for (folders, what) in [
        (vec![one.as_str()], "of 2 shards these are missing: 2; run them with --shard NUMBER/2"),
        (vec![&times], "these are times alone"),
        (vec![&one, &two, &one], "is shard 1/2 as out/small-parts/errors-1-of-2 is"),
        (vec![&one, &two, &times, &times], "is times as out/small-parts/times is"),
        (vec![&one, &two, "other/third"], "it is one of 3 shards, not of 2"),
        (vec![&one, "other/whole"], "is no part of an experiment but all of it"),
        (vec![&one, "other/quick"], "one was made with --quick, one without"),
        (vec![&one, "other/claim"], "the experiment file was another"),
        (vec![&one, "other"], "other/results.json"),
    ] {
        let error = problem(&folders);
        assert!(error.contains(what), "{what}: {error}");
    }
    let damaged = |file: &str, change: &dyn Fn(&mut Vec<u8>), what: &str| {
        let path = here.path().join(&two).join(file);
        let sound = fs::read(&path).unwrap();
        let mut bytes = sound.clone();
        change(&mut bytes);
        fs::write(&path, bytes).unwrap();
        let error = problem(&[&one, &two, &times]);
        assert!(error.contains(what) && error.contains("errors-2-of-2"), "{error}");
        fs::write(&path, sound).unwrap();
    };
    damaged("results.json", &|bytes| bytes.truncate(bytes.len() / 2), "damaged");
    let digit = |bytes: &mut Vec<u8>| {
        let at = bytes.windows(8).position(|word| word == b"\"rmse\": ").unwrap() + 10;
        bytes[at] = if bytes[at] == b'1' { b'2' } else { b'1' };
    };
    damaged("results.json", &digit, "damaged: not what shard 2/2 wrote");
    let picture = parts(here.path()).iter().find_map(|folder| {
        let found =
            tree(&Path::new(folder).join("pictures")).into_keys().find(|it| it.extension().is_some_and(|e| e == "png"));
        found.filter(|it| it.starts_with(here.path().join(&two)))
    });
    if let Some(picture) = picture {
        let name = picture.strip_prefix(here.path().join(&two)).unwrap().display().to_string();
        damaged(&name, &|bytes| bytes[20] ^= 1, "damaged: not what its part wrote");
    }
    assert_eq!(tree(&here.path().join("out")), before);
    stdout(halfshade(here.path()).args(["merge", &one, &two, &times]));
}

#[test]
fn parts_are_resumed_as_themselves_only() {
    let here = prepared();
    part(here.path(), &["--shard", "1/2", "--out", "here"]);
    part(here.path(), &["--shard", "1/2", "--out", "here", "--resume"]);
    let other =
        halfshade(here.path()).args(["run", "small.toml", "--shard", "2/2", "--out", "here", "--resume"]).output();
    let error = String::from_utf8(other.unwrap().stderr).unwrap();
    assert!(error.contains("another part of the experiment, shard 1/2"), "{error}");
    let error =
        refused(halfshade(here.path()).args(["run", "small.toml", "--shard", "auto"]).env_remove("PARALLEL_SEQ"));
    assert!(error.contains("--shard: `auto` needs SLURM_ARRAY_TASK_ID"), "{error}");
    write(here.path(), "timeless.toml", EXPERIMENT.replace("[timing]\nwarm_up = 1\nrepeats = 3\n", ""));
    let error = refused(halfshade(here.path()).args(["run", "timeless.toml", "--times"]));
    assert!(error.contains("timeless.toml: has no `[timing]`"), "{error}");
}

/// Writes a program that stands for another one, and returns the search path on which it comes first.
fn stand_in(here: &Path, name: &str, script: &str) -> String {
    let path = here.join("bin").join(name);
    write(here, &format!("bin/{name}"), format!("#!/usr/bin/env bash\nset -euo pipefail\n{script}\n"));
    fs::set_permissions(&path, fs::Permissions::from_mode(0o755)).unwrap();
    format!("{}:{}", here.join("bin").display(), std::env::var("PATH").unwrap())
}

/// The schedulers are played by loops that set what they set; the commands are those of the examples.
#[test]
fn the_examples_for_clusters_run() {
    let examples = Path::new(env!("CARGO_MANIFEST_DIR")).join("../experiments/cluster");
    let program = env!("CARGO_BIN_EXE_halfshade-under-test");
    let here = prepared();
    part(here.path(), &[]);
    let expected = found(here.path());
    let run = |script: &str, arguments: &[&str], variables: &[(&str, &str)], path: &str| {
        let mut command = Command::new("bash");
        command.arg(examples.join(script)).args(arguments).envs(variables.iter().copied()).env("PATH", path);
        command.env("HALFSHADE_CACHE", here.path().join("cache")).current_dir(here.path());
        let output = command.output().unwrap();
        assert!(output.status.success(), "{script}: {}", String::from_utf8_lossy(&output.stderr));
    };
    let ours = format!("exec {program} \"$@\"");
    let path = stand_in(here.path(), "halfshade", &ours);
    stand_in(
        here.path(),
        "hq",
        "count=1\nwhile [ \"$1\" != -- ]; do case $1 in --array) count=${2#1-};; esac; shift; done; shift\n\
         for id in $(seq $count); do HQ_TASK_ID=$id \"$@\"; done",
    );
    stand_in(
        here.path(),
        "parallel",
        "while [ \"$1\" != halfshade ]; do shift; done\nwhile read -r id; do PARALLEL_SEQ=$id \"$@\" </dev/null; done",
    );
    for script in ["slurm.sh", "hyperqueue.sh", "parallel.sh"] {
        fs::remove_dir_all(here.path().join("out")).unwrap();
        if script == "slurm.sh" {
            let text = fs::read_to_string(examples.join(script)).unwrap();
            let count = text.split("--array=1-").nth(1).unwrap().split('\n').next().unwrap();
            for id in (1..=count.parse::<u32>().unwrap()).map(|id| id.to_string()) {
                let told = [("SLURM_ARRAY_TASK_ID", id.as_str()), ("SLURM_ARRAY_TASK_COUNT", count)];
                run(script, &["small.toml"], &told, &path);
            }
            merge(here.path());
        } else {
            run(script, &["small.toml", "small"], &[], &path);
            assert_eq!(results(here.path())["runs"][0]["time"]["samples"].as_array().unwrap().len(), 3, "{script}");
        }
        assert_eq!(found(here.path()), expected, "{script}");
    }
}
