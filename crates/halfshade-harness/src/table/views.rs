//! The tables made of results.

use super::{Better, Cell, Column, Table, csv_format, significant};
use crate::{
    Metrics, Weighting,
    image_metrics::Similarity,
    metrics::relative,
    results::{Results, Run, Status},
};

/// Runs that are shown together: of one scene, frame and kind of receivers, against one reference.
pub(crate) fn runs_of<'a>(
    results: &'a Results,
    scene: &'a str,
    frame: usize,
    receivers: &'a str,
) -> impl Iterator<Item = &'a Run> {
    results.runs.iter().filter(move |run| run.scene == scene && run.frame == frame && run.receivers == receivers)
}

/// The cell of an error that is ranked.
pub(super) fn relative_rmse(m: &Metrics) -> Cell {
    match m.rel_rmse {
        Some(value) if m.resolved => Cell::number(significant(value, 3), value),
        Some(value) => Cell::unresolved(format!("not resolved (about {})", significant(value, 1))),
        None => Cell::text("no light"),
    }
}

/// Every (scene, frame, kind of receivers) there is, in order.
pub(crate) fn groups(results: &Results) -> Vec<(String, usize, String)> {
    let mut groups: Vec<(String, usize, String)> = Vec::new();
    for run in &results.runs {
        let group = (run.scene.clone(), run.frame, run.receivers.clone());
        if !groups.contains(&group) {
            groups.push(group);
        }
    }
    groups
}

/// Error against the first reference, and time, of every strategy on one frame.
pub fn scene_table(results: &Results, scene: &str, frame: usize, receivers: &str) -> Table {
    let facts = results.scenes.iter().find(|facts| facts.name == scene);
    let published = facts.map_or(&[][..], |facts| facts.published.as_slice());
    let first = runs_of(results, scene, frame, receivers).map(Run::reference).find(|reference| !reference.is_empty());
    let reference = first.unwrap_or("mesh").to_owned();
    let shown: Vec<&Run> = runs_of(results, scene, frame, receivers)
        .filter(|run| run.strategy != "reference" && (run.reference() == reference || run.status != Status::Ok))
        .collect();
    let any = |value: fn(&Similarity) -> Option<f64>| {
        shown.iter().filter_map(|run| run.error.as_ref()).any(|error| value(&error.similarity).is_some())
    };
    let looks = [
        (Column::ranked("FLIP", Better::Lower), (|s| s.flip) as fn(&Similarity) -> Option<f64>),
        (Column::ranked("SSIM", Better::Higher), |s| s.ssim),
    ];
    let looks: Vec<_> = looks.into_iter().filter(|(_, value)| any(*value)).collect();
    let timed = shown.iter().any(|run| run.frame_secs().is_some());

    let mut columns = vec![
        Column::plain("strategy"),
        Column::ranked("rel. RMSE", Better::Lower),
        Column::plain("bias"),
        Column::ranked("mae", Better::Lower),
        Column::ranked("p95", Better::Lower),
        Column::ranked("p99", Better::Lower),
        Column::ranked("max", Better::Lower),
    ];
    columns.extend(looks.iter().map(|(column, _)| column.clone()));
    columns.push(Column::plain("bake s"));
    if timed {
        columns.push(Column::plain("prepare ms"));
        columns.push(Column::ranked("shade ms", Better::Lower));
        columns.push(Column::ranked("frames/s", Better::Higher));
        columns.extend(published.iter().map(|p| Column::plain(format!("{}, {}: frames/s", p.method, p.hardware))));
    }
    columns.push(Column::plain("memory"));

    let rows = shown.iter().map(|run| {
        let mut row = vec![Cell::text(run.label.clone())];
        let Some(error) = run.error.as_ref().filter(|_| run.status == Status::Ok) else {
            let word = if run.status == Status::Unsupported { "unsupported" } else { "failed" };
            row.push(Cell::text(format!("{word}: {}", run.reason.as_deref().unwrap_or("no reason given"))));
            row.resize(columns.len(), Cell::empty());
            return row;
        };
        let m = &error.metrics;
        row.push(relative_rmse(m));
        let mean = run.truth.as_ref().map_or(0.0, |truth| truth.unshadowed_mean);
        row.push(relative(m.bias, mean).map_or(Cell::empty(), |value| Cell::text(signed(value))));
        row.extend([m.mae, m.p95, m.p99, m.max].map(|value| {
            relative(value, mean).map_or(Cell::empty(), |value| Cell::number(significant(value, 3), value))
        }));
        row.extend(looks.iter().map(|(_, value)| {
            value(&error.similarity).map_or(Cell::empty(), |value| Cell::number(format!("{value:.4}"), value))
        }));
        let time = run.time.as_ref();
        row.push(time.map_or(Cell::empty(), |time| Cell::text(significant(time.bake_secs, 2))));
        if timed {
            let millis = |spread: Option<crate::statistics::Spread>| {
                spread.map_or(Cell::empty(), |spread| {
                    let text =
                        format!("{} ± {}", significant(1e3 * spread.median, 3), significant(1e3 * spread.mad, 1));
                    Cell::number(text, spread.median)
                })
            };
            row.push(millis(time.and_then(|time| time.prepare_secs)));
            row.push(millis(time.and_then(|time| time.shade_secs)));
            let rate = time.and_then(|time| time.frames_per_sec);
            row.push(rate.map_or(Cell::empty(), |value| Cell::number(significant(value, 3), value)));
            row.extend(published.iter().map(|p| Cell::text(significant(p.frames_per_sec, 3))));
        }
        row.push(run.memory.as_ref().map_or(Cell::empty(), |memory| Cell::text(bytes(memory.bytes))));
        row
    });
    let rows: Vec<Vec<Cell>> = rows.collect();

    let mut notes = Vec::new();
    if let Some(run) = shown.iter().find(|run| run.truth.is_some())
        && let Some(truth) = &run.truth
    {
        let mean = truth.unshadowed_mean;
        let of_mean = relative(truth.rms_standard_error, mean);
        notes.push(format!(
            "{} {}{}; reference `{reference}`, {} samples, RMS standard error {}. Errors are fractions of the mean unshadowed \
             radiance, {}, over all channels.",
            run.receiver_count,
            if receivers == "vertices" { "vertex receivers" } else { "pixel receivers" },
            match run.error.as_ref().map(|error| error.weights) {
                Some(Weighting::Area) => ", weighted by the area around them",
                _ => ", all counted alike",
            },
            truth.samples,
            of_mean.map_or("not defined".into(), |value| significant(value, 2)),
            significant(mean, 3),
        ));
    }
    if timed {
        notes.push(format!(
            "Times are medians ± median absolute deviations on {} threads of {}.",
            results.machine.threads, results.machine.cpu
        ));
    }
    if timed && !published.is_empty() {
        let sources: Vec<String> =
            published.iter().map(|p| format!("{} on a {} {}", p.method, p.hardware, p.source)).collect();
        notes.push(format!("Published: {}.", sources.join("; ")));
    }
    let title = match facts {
        Some(facts) => format!(
            "{scene}, frame {frame}: {} vertices, {} triangles, {} spheres",
            facts.vertices, facts.triangles, facts.spheres
        ),
        None => format!("{scene}, frame {frame}"),
    };
    Table { title, columns, rows, notes }
}

/// Relative RMSE against every reference, strategy by strategy: what is left when a cause is taken away. `None` if there
/// is only one reference.
pub fn error_split(results: &Results, scene: &str, frame: usize, receivers: &str) -> Option<Table> {
    let kind = |reference: &str| reference.split('=').next().unwrap_or("").to_owned();
    let mut kinds: Vec<String> = Vec::new();
    let mut labels: Vec<&str> = Vec::new();
    for run in runs_of(results, scene, frame, receivers).filter(|run| run.error.is_some()) {
        if !kinds.contains(&kind(run.reference())) {
            kinds.push(kind(run.reference()));
        }
        if !labels.contains(&run.label.as_str()) {
            labels.push(&run.label);
        }
    }
    (kinds.len() > 1).then_some(())?;
    let head = |kind: &str| match kind {
        "mesh" => "against the mesh".to_owned(),
        "spheres" => "against its spheres".to_owned(),
        "bands" => "against its spheres and bands of light".to_owned(),
        other => format!("against {other}"),
    };
    let columns = std::iter::once(Column::plain("strategy"))
        .chain(kinds.iter().map(|kind| Column::ranked(head(kind), Better::Lower)))
        .collect();
    let rows = labels
        .iter()
        .map(|label| {
            let cell = |wanted: &String| {
                runs_of(results, scene, frame, receivers)
                    .filter(|run| run.label == *label && kind(run.reference()) == *wanted)
                    .find_map(|run| run.error.as_ref())
                    .map_or(Cell::empty(), |error| relative_rmse(&error.metrics))
            };
            std::iter::once(Cell::text(*label)).chain(kinds.iter().map(cell)).collect()
        })
        .collect();
    Some(Table {
        title: format!("Where the error comes from: {scene}, frame {frame} (rel. RMSE)"),
        columns,
        rows,
        notes: vec![
            "Rows named `reference:` compare one reference with the mesh's truth: the error of the geometry alone, and of \
             geometry and band-limited light together. The last column leaves a strategy its products, its exponential \
             and its interpolation."
                .into(),
        ],
    })
}

/// Every run with every number, one line each: `results.csv`.
pub fn results_csv(results: &Results) -> String {
    let head = "scene,frame,receivers,receiver_count,strategy,label,params,status,reason,reference,transport,weights,\
                rel_rmse,rel_bias,rel_mae,rel_p95,rel_p99,rel_max,rmse_radiance,bias_radiance,mae_radiance,p95_radiance,\
                p99_radiance,max_radiance,rmse_noise_radiance,bias_noise_radiance,mae_noise_radiance,p95_noise_radiance,\
                p99_noise_radiance,max_noise_radiance,resolved,flip,ssim,truth_samples,\
                truth_rms_standard_error_radiance,unshadowed_mean_radiance,bake_secs,prepare_secs_median,\
                prepare_secs_mad,shade_secs_median,shade_secs_mad,frames_per_sec,threads,memory_bytes";
    let mut records: Vec<Vec<String>> = vec![head.split(',').map(|name| name.trim().to_owned()).collect()];
    for run in &results.runs {
        let optional = |value: Option<f64>| value.map(|value| value.to_string()).unwrap_or_default();
        let params: Vec<String> = run
            .params
            .iter()
            .map(|(key, value)| match value {
                serde_json::Value::String(word) => format!("{key}={word}"),
                other => format!("{key}={other}"),
            })
            .collect();
        let status = match run.status {
            Status::Ok => "ok",
            Status::Unsupported => "unsupported",
            Status::Failed => "failed",
        };
        let (error, truth, time) = (run.error.as_ref(), run.truth.as_ref(), run.time.as_ref());
        type Figure = fn(&Metrics) -> Option<f64>;
        let metric = |of: Figure| error.and_then(|error| of(&error.metrics));
        let mean = truth.map_or(0.0, |truth| truth.unshadowed_mean);
        let absolute: [Figure; 6] =
            [|m| Some(m.rmse), |m| Some(m.bias), |m| Some(m.mae), |m| Some(m.p95), |m| Some(m.p99), |m| Some(m.max)];
        let noise: [Figure; 6] = [
            |m| Some(m.rmse_noise),
            |m| m.bias_noise,
            |m| m.mae_noise,
            |m| m.p95_noise,
            |m| m.p99_noise,
            |m| m.max_noise,
        ];
        let (prepare, shade) = (time.and_then(|t| t.prepare_secs), time.and_then(|t| t.shade_secs));
        let mut record = vec![
            run.scene.clone(),
            run.frame.to_string(),
            run.receivers.clone(),
            run.receiver_count.to_string(),
            run.strategy.clone(),
            run.label.clone(),
            params.join(";"),
            status.to_owned(),
            run.reason.clone().unwrap_or_default(),
            run.reference().to_owned(),
            error.map(|error| error.transport.clone()).unwrap_or_default(),
            error.map(|error| error.weights.to_string()).unwrap_or_default(),
        ];
        record.extend(absolute.map(|of| optional(metric(of).and_then(|value| relative(value, mean)))));
        record.extend(absolute.into_iter().chain(noise).map(|of| optional(metric(of))));
        record.extend([
            error.map(|error| error.metrics.resolved.to_string()).unwrap_or_default(),
            optional(error.and_then(|error| error.similarity.flip)),
            optional(error.and_then(|error| error.similarity.ssim)),
            truth.map(|truth| truth.samples.to_string()).unwrap_or_default(),
            optional(truth.map(|truth| truth.rms_standard_error)),
            optional(truth.map(|truth| truth.unshadowed_mean)),
            optional(time.map(|time| time.bake_secs)),
            optional(prepare.map(|spread| spread.median)),
            optional(prepare.map(|spread| spread.mad)),
            optional(shade.map(|spread| spread.median)),
            optional(shade.map(|spread| spread.mad)),
            optional(time.and_then(|time| time.frames_per_sec)),
            time.map(|time| time.threads.to_string()).unwrap_or_default(),
            run.memory.as_ref().map(|memory| memory.bytes.to_string()).unwrap_or_default(),
        ]);
        records.push(record);
    }
    csv_format::lines(records.iter().map(|record| record.iter().map(String::as_str).collect()))
}

fn signed(value: f64) -> String {
    if value > 0.0 { format!("+{}", significant(value, 2)) } else { significant(value, 2) }
}

fn bytes(count: usize) -> String {
    match count {
        0..1024 => format!("{count} B"),
        1024..1_048_576 => format!("{} KiB", significant(count as f64 / 1024.0, 3)),
        _ => format!("{} MiB", significant(count as f64 / 1_048_576.0, 3)),
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::{results::tests::example, table::Format};

    #[test]
    fn the_table_of_a_scene_shows_error_time_published_figures_and_reasons() {
        let text = scene_table(&example(), "vases", 0, "vertices").write(Format::Markdown, "");
        let rows: Vec<&str> = text.lines().filter(|line| line.starts_with("| ")).collect();
        assert!(rows[0].contains("Ren et al. pixel shader, GeForce 8800 GTX: frames/s"), "{text}");
        assert_eq!(
            rows[2],
            "| fast:bands=4 | <u>0.200</u> | -0.10 | <u>0.160</u> | <u>0.400</u> | <u>0.500</u> | <u>0.600</u> | 0.25 | 0 ± 0 | \
             **2.00 ± 0** | **500** | 95.0 | 2.00 KiB |"
        );
        assert!(rows[3].starts_with("| exact | **0.0200** |"), "{text}");
        assert!(rows[4].starts_with("| blind | unsupported: can't model local lights |"), "{text}");
    }

    #[test]
    fn an_unresolved_error_is_the_best() {
        let mut results = example();
        results.runs[0].error.as_mut().unwrap().metrics.resolved = false;
        let text = scene_table(&results, "vases", 0, "vertices").write(Format::Markdown, "");
        assert!(text.contains("| fast:bands=4 | **not resolved (about 0.2)** |"), "{text}");
        assert!(text.contains("| exact | <u>0.0200</u> |"), "{text}");
    }

    #[test]
    fn a_scene_without_light_says_so_and_divides_by_nothing() {
        let mut results = example();
        for run in &mut results.runs {
            if let (Some(error), Some(truth)) = (&mut run.error, &mut run.truth) {
                (error.metrics.rel_rmse, truth.unshadowed_mean, truth.rms_standard_error) = (None, 0.0, 0.0);
            }
        }
        for format in [Format::Markdown, Format::Latex, Format::Html, Format::Csv] {
            let table = scene_table(&results, "vases", 0, "vertices").write(format, "");
            let text = table + &results_csv(&results);
            assert!(text.contains("no light") && !text.contains("NaN") && !text.contains("inf"), "{text}");
        }
    }

    #[test]
    fn a_second_reference_splits_the_error() {
        let mut results = example();
        assert_eq!(error_split(&results, "vases", 0, "vertices"), None);
        let mut run = results.runs[0].clone();
        run.error.as_mut().unwrap().reference = "spheres".into();
        run.error.as_mut().unwrap().metrics.rel_rmse = Some(0.125);
        results.runs.push(run);
        let table = error_split(&results, "vases", 0, "vertices").unwrap();
        assert_eq!(
            table.rows[0].iter().map(|cell| cell.text.as_str()).collect::<Vec<_>>(),
            ["fast:bands=4", "0.200", "0.125"]
        );
    }

    #[test]
    fn csv_has_a_cell_for_every_head() {
        let text = results_csv(&example());
        let mut reader = csv::Reader::from_reader(text.as_bytes());
        assert_eq!(reader.headers().unwrap().len(), 44);
        let records: Vec<csv::StringRecord> = reader.records().map(Result::unwrap).collect();
        assert_eq!(records.len(), 3);
        assert_eq!((&records[0][6], &records[0][12], &records[2][7]), ("bands=4", "0.2", "unsupported"));
        // Relative to a mean of 0.5, absolute, and the noise.
        assert_eq!((&records[0][13], &records[0][19], &records[0][25]), ("-0.1", "-0.05", "0.00002"));
    }
}
