//! Every run with every number, for programs.

use super::table::{Cell, Column, Table};
use crate::{
    Intervals, Metrics,
    metrics::relative,
    results::{Results, Status},
};

/// Intervals in the order of their columns.
const INTERVALS: [fn(&Intervals) -> Option<[f64; 2]>; 7] = [
    |it| it.rel_rmse,
    |it| Some(it.rmse),
    |it| Some(it.bias),
    |it| Some(it.mae),
    |it| it.p95,
    |it| it.p99,
    |it| Some(it.negative),
];

/// Every run with every number, a row each: `results.csv`.
pub(super) fn all_runs(results: &Results) -> Table {
    let head = "scene,frame,receivers,receiver_count,strategy,label,params,status,reason,reference,transport,weights,\
                rel_rmse,rel_bias,rel_mae,rel_p95,rel_p99,rel_max,rmse_radiance,bias_radiance,mae_radiance,p95_radiance,\
                p99_radiance,max_radiance,rmse_noise_radiance,bias_noise_radiance,mae_noise_radiance,p95_noise_radiance,\
                p99_noise_radiance,max_noise_radiance,resolved,flip,ssim,truth_samples,\
                truth_rms_standard_error_radiance,unshadowed_mean_radiance,bake_secs,prepare_secs_median,\
                prepare_secs_mad,shade_secs_median,shade_secs_mad,frames_per_sec,threads,memory_bytes,device,\
                read_back_secs_median,device_secs_median,streamed_secs_median,latency_secs_median,negative_share,\
                rel_rmse_low,rel_rmse_high,rmse_low_radiance,rmse_high_radiance,bias_low_radiance,bias_high_radiance,\
                mae_low_radiance,mae_high_radiance,p95_low_radiance,p95_high_radiance,p99_low_radiance,p99_high_radiance,\
                negative_share_low,negative_share_high";
    let mut rows: Vec<Vec<Cell>> = Vec::new();
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
            run.device.to_string(),
            optional(time.and_then(|time| time.read_back_secs).map(|spread| spread.median)),
            optional(time.and_then(|time| time.device_secs).map(|spread| spread.median)),
            optional(time.and_then(|time| time.streamed_secs).map(|spread| spread.median)),
            optional(time.and_then(|time| time.latency_secs).map(|spread| spread.median)),
            optional(metric(|m| m.negative)),
        ]);
        let intervals = error.and_then(|error| error.metrics.intervals);
        record.extend(INTERVALS.iter().flat_map(|of| {
            let interval = intervals.as_ref().and_then(of);
            [0, 1].map(|end| optional(interval.map(|interval| interval[end])))
        }));
        rows.push(record.into_iter().map(Cell::text).collect());
    }
    let columns = head.split(',').map(|name| Column::plain(name.trim())).collect();
    Table { title: "Every run".into(), columns, rows, notes: Vec::new() }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::{report::Format, results::tests::example};

    #[test]
    fn csv_has_a_cell_for_every_head() {
        let mut results = example();
        let (bias, p99) = ([-0.06, -0.04], Some([0.2, 0.3]));
        results.runs[0].error.as_mut().unwrap().metrics.intervals =
            Some(Intervals { rmse: [0.1; 2], rel_rmse: None, bias, mae: [0.1; 2], p95: None, p99, negative: [0.0; 2] });
        let text = all_runs(&results).write(Format::Csv, "");
        let mut reader = csv::Reader::from_reader(text.as_bytes());
        assert_eq!(reader.headers().unwrap().len(), 64);
        let records: Vec<csv::StringRecord> = reader.records().map(Result::unwrap).collect();
        assert_eq!(records.len(), 3);
        assert_eq!((&records[0][6], &records[0][12], &records[2][7]), ("bands=4", "0.2", "unsupported"));
        // Relative to a mean of 0.5, absolute, and the noise.
        assert_eq!((&records[0][13], &records[0][19], &records[0][25]), ("-0.1", "-0.05", "0.00002"));
        assert_eq!([50, 54, 55, 60, 61].map(|column| &records[0][column]), ["", "-0.06", "-0.04", "0.2", "0.3"]);
    }
}
