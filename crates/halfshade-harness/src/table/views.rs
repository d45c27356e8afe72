//! The tables made of results.

use super::{Better, Cell, Column, Table, csv_format, significant};
use crate::{
    image_metrics::Similarity,
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
        row.push(match m.rel_rmse {
            Some(value) if m.resolved => Cell::number(significant(value, 3), value),
            Some(value) => Cell::text(format!("not resolved (about {})", significant(value, 1))),
            None => Cell::text("no light"),
        });
        row.push(Cell::text(signed(m.bias)));
        row.extend([m.p95, m.p99, m.max].map(|value| Cell::number(significant(value, 3), value)));
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
        notes.push(format!(
            "{} {}; reference `{reference}`, {} samples, RMS standard error {} (relative {}). Errors are in radiance over \
             all channels; rel. RMSE is divided by the mean unshadowed radiance, {}.",
            run.receiver_count,
            if receivers == "vertices" { "vertex receivers" } else { "pixel receivers" },
            truth.samples,
            significant(truth.rms_standard_error, 2),
            significant(truth.rms_standard_error / truth.unshadowed_mean, 2),
            significant(truth.unshadowed_mean, 3),
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
                    .map_or(Cell::empty(), |error| match error.metrics.rel_rmse {
                        Some(value) if error.metrics.resolved => Cell::number(significant(value, 3), value),
                        Some(_) => Cell::text("not resolved"),
                        None => Cell::text("no light"),
                    })
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
    let head = "scene,frame,receivers,receiver_count,strategy,label,params,status,reason,reference,transport,rmse,rel_rmse,\
                bias,mae,p95,p99,max,rmse_noise,resolved,flip,ssim,truth_samples,truth_rms_standard_error,unshadowed_mean,\
                bake_secs,prepare_secs_median,prepare_secs_mad,shade_secs_median,shade_secs_mad,frames_per_sec,threads,\
                memory_bytes";
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
        let metric = |of: &dyn Fn(&crate::Metrics) -> f64| optional(error.map(|error| of(&error.metrics)));
        let (prepare, shade) = (time.and_then(|t| t.prepare_secs), time.and_then(|t| t.shade_secs));
        records.push(vec![
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
            metric(&|m| m.rmse),
            optional(error.and_then(|error| error.metrics.rel_rmse)),
            metric(&|m| m.bias),
            metric(&|m| m.mae),
            metric(&|m| m.p95),
            metric(&|m| m.p99),
            metric(&|m| m.max),
            metric(&|m| m.rmse_noise),
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
            "| fast:bands=4 | <u>0.200</u> | -0.050 | <u>0.200</u> | <u>0.250</u> | <u>0.300</u> | 0.25 | 0 ± 0 | \
             **2.00 ± 0** | **500** | 95.0 | 2.00 KiB |"
        );
        assert!(rows[3].starts_with("| exact | **0.0200** |"), "{text}");
        assert!(rows[4].starts_with("| blind | unsupported: can't model local lights |"), "{text}");
    }

    #[test]
    fn an_unresolved_error_wins_nothing() {
        let mut results = example();
        results.runs[1].error.as_mut().unwrap().metrics.resolved = false;
        let text = scene_table(&results, "vases", 0, "vertices").write(Format::Markdown, "");
        assert!(text.contains("| exact | not resolved (about 0.02) |"), "{text}");
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
        assert_eq!(reader.headers().unwrap().len(), 33);
        let records: Vec<csv::StringRecord> = reader.records().map(Result::unwrap).collect();
        assert_eq!(records.len(), 3);
        assert_eq!((&records[0][6], &records[0][11], &records[2][7]), ("bands=4", "0.1", "unsupported"));
    }
}
