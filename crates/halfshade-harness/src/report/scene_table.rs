//! The first table of a scene: error and time.

use super::{
    error_cell::relative_rmse,
    groups::Group,
    significant::significant,
    table::{Better, Cell, Column, Table},
    units::{bytes, seconds, seconds_with_spread},
};
use crate::{
    Published, Weighting,
    image_metrics::Similarity,
    metrics::relative,
    results::{Machine, Results, Run, Status},
    statistics::Spread,
};

/// A column of pictures' similarity, and its figure.
type SimilarityColumn = (Column, fn(&Similarity) -> Option<f64>);

/// Runs of a scene's table, and everything that its rows have in common.
struct SceneRuns<'a> {
    runs: Vec<&'a Run>,
    /// The reference of the errors, in words.
    reference: &'a str,
    /// Figures of pictures that any run has.
    similarities: Vec<SimilarityColumn>,
    /// Whether any run was timed.
    timed: bool,
    /// Whether any ran on a device with memory and a clock of its own.
    has_devices: bool,
    /// Whether any was timed with several frames in flight.
    has_streams: bool,
    /// Whether any method sent less than no light.
    has_negatives: bool,
    published: &'a [Published],
}

/// Error against the first reference, and time, of every strategy on one frame.
pub(super) fn scene_table(results: &Results, group: &Group) -> Table {
    let facts = results.scenes.iter().find(|facts| facts.name == group.scene);
    let runs = group.strategies(results);
    let similarities: [SimilarityColumn; 2] =
        [(Column::ranked("FLIP", Better::Lower), |s| s.flip), (Column::ranked("SSIM", Better::Higher), |s| s.ssim)];
    let errors = || runs.iter().filter_map(|run| run.error.as_ref());
    let scene_runs = SceneRuns {
        similarities: similarities
            .into_iter()
            .filter(|(_, of)| errors().any(|error| of(&error.similarity).is_some()))
            .collect(),
        has_devices: runs.iter().any(|run| !run.device.is_cpu()),
        has_streams: runs.iter().any(|run| run.time.as_ref().is_some_and(|time| time.streamed_secs.is_some())),
        has_negatives: errors().any(|error| error.metrics.negative.is_some_and(|share| share > 0.0)),
        timed: runs.iter().any(|run| run.frame_secs().is_some()),
        published: facts.map_or(&[][..], |facts| facts.published.as_slice()),
        runs,
        reference: group.first_reference(results),
    };
    let title = match facts {
        Some(facts) => format!(
            "{}: {} vertices, {} triangles, {} spheres",
            group.place(),
            facts.vertices,
            facts.triangles,
            facts.spheres
        ),
        None => group.place(),
    };
    let columns = scene_runs.columns();
    let rows = scene_runs.runs.iter().map(|run| scene_runs.row(run, columns.len())).collect();
    Table { title, columns, rows, notes: scene_runs.notes(&results.machine, &group.receivers) }
}

impl SceneRuns<'_> {
    fn columns(&self) -> Vec<Column> {
        let mut columns = vec![Column::plain("strategy")];
        if self.has_devices {
            columns.push(Column::plain("device"));
        }
        columns.extend([
            Column::ranked("rel. RMSE", Better::Lower),
            Column::plain("bias"),
            Column::ranked("mae", Better::Lower),
            Column::ranked("p95", Better::Lower),
            Column::ranked("p99", Better::Lower),
            Column::ranked("max", Better::Lower),
        ]);
        if self.has_negatives {
            columns.push(Column::ranked("below 0", Better::Lower));
        }
        columns.extend(self.similarities.iter().map(|(column, _)| column.clone()));
        columns.push(Column::plain("bake"));
        if self.timed {
            columns.push(Column::plain("prepare"));
            columns.push(Column::ranked("shade", Better::Lower));
            if self.has_devices {
                columns.push(Column::plain("by its clock"));
                columns.push(Column::plain("read back"));
            }
            columns.push(Column::ranked("frames/s", Better::Higher));
            if self.has_streams {
                columns.push(Column::plain("frames/s in flight"));
                columns.push(Column::plain("latency"));
            }
            let head = |p: &Published| Column::plain(format!("{}, {}: frames/s", p.method, p.hardware));
            columns.extend(self.published.iter().map(head));
        }
        columns.push(Column::plain("memory"));
        columns
    }

    /// A cell for each of `width` columns.
    fn row(&self, run: &Run, width: usize) -> Vec<Cell> {
        let mut row = vec![Cell::text(run.label.clone())];
        if self.has_devices {
            row.push(Cell::text(run.device.to_string()));
        }
        let Some(error) = run.error.as_ref().filter(|_| run.status == Status::Ok) else {
            let word = if run.status == Status::Unsupported { "unsupported" } else { "failed" };
            row.push(Cell::text(format!("{word}: {}", run.reason.as_deref().unwrap_or("no reason given"))));
            row.resize(width, Cell::empty());
            return row;
        };
        let m = &error.metrics;
        row.push(relative_rmse(m));
        let mean = run.truth.as_ref().map_or(0.0, |truth| truth.unshadowed_mean);
        row.push(relative(m.bias, mean).map_or(Cell::empty(), |value| Cell::text(signed(value))));
        row.extend([m.mae, m.p95, m.p99, m.max].map(|value| {
            relative(value, mean).map_or(Cell::empty(), |value| Cell::number(significant(value, 3), value))
        }));
        if self.has_negatives {
            let share = |value| Cell::number(significant(value, 2), value);
            row.push(m.negative.map_or(Cell::empty(), share));
        }
        row.extend(self.similarities.iter().map(|(_, value)| {
            value(&error.similarity).map_or(Cell::empty(), |value| Cell::number(format!("{value:.4}"), value))
        }));
        let times = run.time.as_ref();
        row.push(times.map_or(Cell::empty(), |time| Cell::text(seconds(time.bake_secs, 2))));
        if self.timed {
            row.push(time(times.and_then(|time| time.prepare_secs)));
            row.push(time(times.and_then(|time| time.shade_secs)));
            if self.has_devices {
                row.push(time(times.and_then(|time| time.device_secs)));
                row.push(time(times.and_then(|time| time.read_back_secs)));
            }
            let rate = times.and_then(|time| time.frames_per_sec);
            row.push(rate.map_or(Cell::empty(), |value| Cell::number(significant(value, 3), value)));
            if self.has_streams {
                let rate = times.and_then(|time| time.streamed_secs).filter(|spread| spread.median > 0.0);
                row.push(rate.map_or(Cell::empty(), |spread| Cell::text(significant(spread.median.recip(), 3))));
                row.push(time(times.and_then(|time| time.latency_secs)));
            }
            row.extend(self.published.iter().map(|p| Cell::text(significant(p.frames_per_sec, 3))));
        }
        row.push(run.memory.as_ref().map_or(Cell::empty(), |memory| Cell::text(bytes(memory.bytes))));
        row
    }

    /// Notes on references, receivers and machine, and sources of published figures.
    fn notes(&self, machine: &Machine, receivers: &str) -> Vec<String> {
        let mut notes = Vec::new();
        if let Some(run) = self.runs.iter().find(|run| run.truth.is_some())
            && let Some(truth) = &run.truth
        {
            let mean = truth.unshadowed_mean;
            let of_mean = relative(truth.rms_standard_error, mean);
            notes.push(format!(
                "{} {}{}; reference `{}`, {} samples, RMS standard error {}. Errors are fractions of the mean unshadowed \
                 radiance, {}, over all channels.",
                run.receiver_count,
                if receivers == "vertices" { "vertex receivers" } else { "pixel receivers" },
                match run.error.as_ref().map(|error| error.weights) {
                    Some(Weighting::Area) => ", weighted by the area around them",
                    _ => ", all counted alike",
                },
                self.reference,
                truth.samples,
                of_mean.map_or("not defined".into(), |value| significant(value, 2)),
                significant(mean, 3),
            ));
        }
        if self.timed {
            notes.push(format!(
                "Times are medians ± median absolute deviations on {} threads of {}.",
                machine.threads, machine.cpu
            ));
        }
        if let Some(gpu) = machine.gpu.as_ref().filter(|_| self.has_devices) {
            notes.push(format!(
                "Device `gpu` is {gpu}. Its *prepare* has the upload in it, its frames per second count *prepare* and *shade*, \
                 as on a screen; what is copied back for scoring stands apart."
            ));
        }
        if self.timed && !self.published.is_empty() {
            let source = |p: &Published| format!("{} on a {} {}", p.method, p.hardware, p.source);
            let sources: Vec<String> = self.published.iter().map(source).collect();
            notes.push(format!("Published: {}.", sources.join("; ")));
        }
        notes
    }
}

/// A time, ranked by its median.
fn time(spread: Option<Spread>) -> Cell {
    spread.map_or(Cell::empty(), |spread| Cell::number(seconds_with_spread(spread.median, spread.mad), spread.median))
}

fn signed(value: f64) -> String {
    if value > 0.0 { format!("+{}", significant(value, 2)) } else { significant(value, 2) }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::{
        report::{Format, all_runs::all_runs, groups::tests::only},
        results::tests::example,
    };

    #[test]
    fn the_table_of_a_scene_shows_error_time_published_figures_and_reasons() {
        let text = scene_table(&example(), &only()).write(Format::Markdown, "");
        let rows: Vec<&str> = text.lines().filter(|line| line.starts_with("| ")).collect();
        assert!(rows[0].contains("Ren et al. pixel shader, GeForce 8800 GTX: frames/s"), "{text}");
        assert_eq!(
            rows[2],
            "| fast:bands=4 | <u>0.200</u> | -0.10 | <u>0.160</u> | <u>0.400</u> | <u>0.500</u> | <u>0.600</u> | 250 ms | 0 ± 0 ms | \
             **2.00 ± 0 ms** | **500** | 95.0 | 2.00 KiB |"
        );
        assert!(rows[3].starts_with("| exact | **0.0200** |"), "{text}");
        assert!(rows[4].starts_with("| blind | unsupported: can't model local lights |"), "{text}");
    }

    #[test]
    fn an_unresolved_error_is_the_best() {
        let mut results = example();
        results.runs[0].error.as_mut().unwrap().metrics.resolved = false;
        let text = scene_table(&results, &only()).write(Format::Markdown, "");
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
            let table = scene_table(&results, &only()).write(format, "");
            let text = table + &all_runs(&results).write(format, "");
            assert!(text.contains("no light") && !text.contains("NaN") && !text.contains("inf"), "{text}");
        }
    }
}
