//! Runs that are killed, interrupted or disturbed by another run.

use super::{EXPERIMENT, found, long, prepared, results, start, started};
use crate::common::{halfshade, names, refused, stdout, write};
use rand::{RngExt, SeedableRng};
use rand_pcg::Pcg64Mcg;
use serde_json::Value;
use std::{fs, process::Command, time::Duration};

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
    let mut rng = Pcg64Mcg::seed_from_u64(1);
    let mut random = || rng.random_range(0.0..1.0);
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
