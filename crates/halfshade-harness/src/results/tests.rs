//! An example of results, and tests of their schema.

use super::*;

/// Two strategies on one scene, with round numbers.
pub(crate) fn example() -> Results {
    let run = |strategy: &str, label: &str, rmse: f64, ms: f64| Run {
        scene: "vases".into(),
        frame: 0,
        receivers: "vertices".into(),
        receiver_count: 1000,
        strategy: strategy.into(),
        device: Device::Cpu,
        label: label.into(),
        params: BTreeMap::from([("bands".into(), serde_json::json!(4))]),
        status: Status::Ok,
        reason: None,
        error: Some(ErrorFigures {
            reference: "mesh".into(),
            transport: "direct".into(),
            metrics: Metrics {
                rmse,
                rel_rmse: Some(2.0 * rmse),
                bias: -0.5 * rmse,
                mae: 0.8 * rmse,
                p95: 2.0 * rmse,
                p99: 2.5 * rmse,
                max: 3.0 * rmse,
                rmse_noise: 1e-4,
                bias_noise: Some(2e-5),
                mae_noise: Some(4e-5),
                p95_noise: Some(2e-4),
                p99_noise: Some(4e-4),
                negative: None,
                max_noise: Some(1e-3),
                resolved: true,
                intervals: None,
                rmse_without: None,
            },
            weights: Weighting::Equal,
            classes: Vec::new(),
            similarity: Similarity::default(),
        }),
        truth: Some(TruthFigures { samples: 256, rms_standard_error: 1e-3, unshadowed_mean: 0.5 }),
        time: Some(TimeFigures::of(0.25, 2, vec![Sample::new(0.0, 1e-3 * ms); 3])),
        memory: Some(Memory { bytes: 2048, parts: BTreeMap::from([("tables".into(), 2048)]) }),
        stability: None,
        details: vec![Detail { name: "resolution by shell".into(), values: vec![8.0, 64.0, 0.015625] }],
        stages: Vec::new(),
    };
    let mut blind = run("blind", "blind", 0.0, 1.0);
    blind.status = Status::Unsupported;
    blind.reason = Some("can't model local lights".into());
    (blind.error, blind.truth, blind.time, blind.memory) = (None, None, None, None);
    Results {
        schema: SCHEMA.into(),
        experiment: "example".into(),
        claim: "fast is not exact".into(),
        experiment_hash: "00".into(),
        inputs: Some(vec![InputFile { path: "../scene.toml".into(), blake3: "01".into() }]),
        part: None,
        quick: false,
        revision: "0.1.0".into(),
        machine: Machine { cpu: "an abacus".into(), threads: 2, gpu: None, os: "none".into() },
        strategies: vec!["fast".into(), "exact".into(), "blind".into()],
        baseline: None,
        stability: None,
        scenes: vec![SceneFacts {
            name: "vases".into(),
            vertices: 1000,
            triangles: 2000,
            spheres: 20,
            published: vec![Published {
                method: "Ren et al. pixel shader".into(),
                hardware: "GeForce 8800 GTX".into(),
                source: "[Guerrero2007, 6]".into(),
                frames_per_sec: 95.0,
            }],
        }],
        runs: vec![run("fast", "fast:bands=4", 0.1, 2.0), run("exact", "exact", 0.01, 50.0), blind],
        differences: vec![Difference {
            scene: "vases".into(),
            frame: 0,
            receivers: "vertices".into(),
            first: "exact".into(),
            second: "fast:bands=4".into(),
            mean: 0.25,
            bias: -0.01,
            mae: 0.02,
            max: 0.125,
        }],
        pictures: Vec::new(),
    }
}

#[test]
fn json_has_the_keys_of_the_contract_and_reads_back() {
    let results = example();
    let text = results.to_json().unwrap();
    assert_eq!(serde_json::from_str::<Results>(&text).unwrap(), results);
    // Files from before there were differences, and those of experiments without.
    let none = Results { differences: Vec::new(), inputs: None, ..results };
    let text = none.to_json().unwrap();
    assert!(!text.contains("differences") && !text.contains("inputs"));
    assert_eq!(serde_json::from_str::<Results>(&text).unwrap(), none);
    let text = example().to_json().unwrap();
    let json: serde_json::Value = serde_json::from_str(&text).unwrap();
    let run = &json["runs"][0];
    let has = |value: &serde_json::Value, keys: &[&str]| {
        for key in keys {
            assert!(value.get(key).is_some(), "no key {key} in {value}");
        }
    };
    has(&json, &["schema", "experiment", "revision", "machine", "runs"]);
    has(&json["machine"], &["cpu", "threads", "gpu", "os"]);
    has(run, &["scene", "frame", "receivers", "strategy", "params", "status", "reason", "error", "truth", "time"]);
    has(&run["error"], &["reference", "transport", "rmse", "rel_rmse", "bias", "mae", "p95", "p99", "max"]);
    has(&run["error"], &["flip", "ssim", "resolved"]);
    has(&run["truth"], &["samples", "rms_standard_error"]);
    has(&run["time"], &["bake_secs", "prepare_secs", "shade_secs", "frames_per_sec", "samples"]);
    has(&run["time"]["shade_secs"], &["median", "mad"]);
    has(&run["memory"], &["bytes", "parts"]);
    assert_eq!(run["status"], "ok");
    assert_eq!(json["runs"][2]["status"], "unsupported");
}

#[test]
fn results_of_older_versions_are_read() {
    let mut json: serde_json::Value = serde_json::from_str(&example().to_json().unwrap()).unwrap();
    for run in json["runs"].as_array_mut().unwrap() {
        if let Some(error) = run["error"].as_object_mut() {
            error.retain(|key, _| {
                !["weights", "classes"].contains(&key.as_str()) && (key == "rmse_noise" || !key.ends_with("_noise"))
            });
        }
    }
    let old: Results = serde_json::from_str(&json.to_string()).unwrap();
    let error = old.runs[0].error.as_ref().unwrap();
    assert_eq!((error.weights, error.metrics.max_noise, error.metrics.rmse_noise), (Weighting::Equal, None, 1e-4));
    assert_eq!(old.vertex_weights(), Some(Weighting::Equal));
}
