//! Regression: has any error grown beyond noise since a baseline?
//!
//! Every figure of every run is compared: RMSE, its relative, bias by its size, mean absolute error, both percentiles and the
//! maximum; and of each class of receivers those that are means. What is largest in a class of few receivers depends on rare
//! events, of which its noise doesn't know. A figure has grown if it exceeds the baseline's by more than
//!
//! ```text
//! σ-multiple · hypot(noise before, noise now) + 2 % of the baseline's figure + 1e-5 of the mean unshadowed radiance
//! ```
//!
//! The last two allow for processors that round differently; with the same seeds on the same processor the difference is
//! 0. The multiple makes a false alarm of a whole check, all its figures together, as rare as [`FALSE_ALARMS`] under
//! another seed of the truth: each of n figures gets an n-th of that (Bonferroni), by Student's distribution with 15
//! degrees of freedom, since noise is known from sixteen estimates. It grows slowly, from 3.7 for ten figures to 5.7
//! for five hundred.
//!
//! A baseline is not taken at its word. It must be of as many receivers and samples, since then its noise is about what
//! the run finds now: of what it claims, no more than [`NOISE_RATIO`] times that counts. For a class that is the noise of all
//! receivers by its share if that is more, since noise that is estimated from few may miss most of it. What is on one side
//! only fails.

use crate::{
    HarnessError, Metrics, Results,
    metrics::relative,
    report::{Cell, Column, Table, significant},
    results::{ErrorFigures, Run},
    statistics::student_quantile,
};
use std::collections::HashSet;

/// How often a check may fail by noise alone.
pub const FALSE_ALARMS: f64 = 0.01;
/// Fraction of a baseline's figure that passes.
const TOLERANCE: f64 = 0.02;
/// Fraction of the mean unshadowed radiance that passes: what single precision leaves of sums.
const ROUNDING: f64 = 1e-5;
/// How many times the noise of a figure now that of the baseline may be.
pub const NOISE_RATIO: f64 = 3.0;

/// A figure with its noise.
struct Figure {
    name: &'static str,
    value: f64,
    noise: Option<f64>,
    /// A fraction of the mean unshadowed radiance, like `rel_rmse`; others are radiance.
    is_relative: bool,
}

/// The receivers of a run, or those of a class, before and now.
struct Part<'a> {
    /// Empty: all.
    class: &'a str,
    /// Share of the weight of all.
    share: f64,
    before: &'a Metrics,
    after: &'a Metrics,
}

/// Findings of a comparison.
#[derive(Debug, Clone, PartialEq)]
pub struct Comparison {
    /// Figures that moved beyond the tolerance, either way, and runs that are new or gone.
    pub moved: Table,
    /// How many runs were compared.
    pub compared: usize,
    /// How many figures of them.
    pub figures: usize,
    /// How many figures grew worse, and what is on one side only.
    pub failures: usize,
}

/// Refuses a baseline that nothing can be compared with, before anything is run.
pub fn check_baseline(baseline: &Results) -> Result<(), HarnessError> {
    if baseline.runs.iter().all(|run| run.error.is_none()) {
        return Err(HarnessError::input(format!("the baseline holds no errors to compare with: {RENEW}")));
    }
    let mut seen = HashSet::new();
    match baseline.runs.iter().find(|run| !seen.insert((run.key(), run.reference()))) {
        Some(twice) => Err(HarnessError::input(format!("the baseline lists {} twice: {RENEW}", twice.place()))),
        None => Ok(()),
    }
}

/// Compares the errors of `now` with those of `baseline`.
pub fn compare(now: &Results, baseline: &Results) -> Result<Comparison, HarnessError> {
    if now.quick != baseline.quick {
        return Err(HarnessError::input("the baseline was made with another --quick: both must be the same"));
    }
    let same = |a: &Run, b: &Run| a.key() == b.key() && (a.reference() == b.reference() || a.status != b.status);
    let pairs: Vec<(&Run, Option<&Run>)> =
        baseline.runs.iter().map(|old| (old, now.runs.iter().find(|new| same(new, old)))).collect();
    let both = pairs.iter().filter_map(|(old, new)| Some((*old, (*new)?)));
    if let Some(what) = both.clone().find_map(|(old, new)| difference(old, new)) {
        return Err(HarnessError::input(format!("errors can't be compared: {what}; {RENEW}")));
    }
    let measured: Vec<_> =
        both.filter_map(|(old, new)| Some(parts(old.error.as_ref()?, new.error.as_ref()?))).collect();
    let count = measured.iter().flatten().map(Part::figure_count).sum();
    let sigmas = multiple_of_noise(count);
    let (mut rows, mut failures) = (Vec::new(), 0);
    for (old, new) in pairs {
        let Some(new) = new else {
            failures += 1;
            rows.push(row(old, "", [told(old), "gone".into()], GONE));
            continue;
        };
        let (Some(before), Some(after)) = (&old.error, &new.error) else {
            if old.status != new.status {
                let verdict = if old.error.is_some() { Some(GONE) } else { new.error.as_ref().map(|_| NEW) };
                failures += usize::from(verdict.is_some());
                let values = [old, new].map(told);
                rows.push(row(new, "", values, verdict.unwrap_or("another reason: renew the baseline")));
            }
            continue;
        };
        let lone = lone_classes(before, after);
        failures += lone.len();
        rows.extend(lone.into_iter().map(|(class, values, verdict)| row(new, class, values, verdict)));
        let mean = new.truth.as_ref().map_or(0.0, |truth| truth.unshadowed_mean.abs());
        let all = figures(&after.metrics, mean);
        for part in parts(before, after) {
            let pairs = figures(part.before, mean).into_iter().zip(figures(part.after, mean)).zip(&all);
            for ((before, after), of_all) in pairs.take(part.figure_count()) {
                let now = after.noise.unwrap_or(0.0);
                let confirmed = now.max(of_all.noise.unwrap_or(0.0) / part.share);
                // Baselines of older versions know the noise of the RMSE alone.
                let noise = before.noise.map_or(now, |noise| noise.min(NOISE_RATIO * confirmed)).hypot(now);
                let rounding = if before.is_relative { ROUNDING } else { ROUNDING * mean };
                let allowed = sigmas * noise + TOLERANCE * before.value + rounding;
                let change = after.value - before.value;
                let unclear = !(change.is_finite() && allowed.is_finite());
                if change.abs() > allowed || unclear {
                    let worse = change > allowed || unclear;
                    failures += usize::from(worse);
                    let verdict = if worse { "FAILED: error grew" } else { "better: renew the baseline" };
                    let values = [before.value, after.value].map(|value| significant(value, 4));
                    rows.push(row(new, &part.name(before.name), values, verdict));
                }
            }
        }
    }
    for new in now.runs.iter().filter(|new| baseline.runs.iter().all(|old| !same(new, old))) {
        failures += 1;
        rows.push(row(new, "", ["none".into(), told(new)], NEW));
    }
    let columns = ["scene", "frame", "receivers", "strategy", "reference", "figure", "baseline", "now", "verdict"]
        .map(Column::plain);
    let notes = match rows.is_empty() {
        true => Vec::new(),
        false => vec![format!(
            "`rel_rmse` is a fraction of the mean unshadowed radiance; all other figures are in radiance. Growth passes up to \
             {sigmas:.1} standard deviations of the noise of both, and 2 %."
        )],
    };
    let moved = Table { title: "What moved".into(), columns: columns.to_vec(), rows, notes };
    Ok(Comparison { moved, compared: measured.len(), figures: count, failures })
}

/// Standard deviations of noise that pass, where `count` figures are compared.
pub fn multiple_of_noise(count: usize) -> f64 {
    student_quantile(FALSE_ALARMS / count.max(1) as f64)
}

/// Whether the RMSE of `after` is farther from that of `before` than the noise of both explains, by itself and for once.
pub fn moved_beyond_noise(before: &Metrics, after: &Metrics, unshadowed_mean: f64) -> bool {
    let noise = before.rmse_noise.hypot(after.rmse_noise);
    let allowed = multiple_of_noise(1) * noise + TOLERANCE * before.rmse + ROUNDING * unshadowed_mean.abs();
    (after.rmse - before.rmse).abs() > allowed
}

/// Advice about a baseline that doesn't serve.
const RENEW: &str = "renew the baseline, which is the results.json of a run";
/// Verdicts on runs that are on one side only.
const GONE: &str = "FAILED: no longer measured";
const NEW: &str = "FAILED: not in the baseline, renew it";

/// Why errors of two runs are of different things, if they are.
fn difference(old: &Run, new: &Run) -> Option<String> {
    let samples = |run: &Run| run.truth.as_ref().map(|truth| truth.samples);
    let count = |samples: Option<u64>| samples.map_or("unknown".to_owned(), |samples| samples.to_string());
    let counted = (old.receiver_count != new.receiver_count)
        .then(|| ("receivers", old.receiver_count.to_string(), new.receiver_count.to_string()));
    let of_errors = || {
        let (before, after) = (old.error.as_ref()?, new.error.as_ref()?);
        let traced = (samples(old) != samples(new)).then(|| ("samples", count(samples(old)), count(samples(new))));
        let weighted = (before.weights != after.weights)
            .then(|| ("weights", format!("`{}`", before.weights), format!("`{}`", after.weights)));
        let lit = (before.transport != after.transport)
            .then(|| ("transport", format!("`{}`", before.transport), format!("`{}`", after.transport)));
        traced.or(weighted).or(lit)
    };
    let (what, before, after) = counted.or_else(of_errors)?;
    Some(format!("{}: the {what} of the baseline are {before}, those of the run {after}", new.place()))
}

/// All receivers, and the classes that are told on both sides.
fn parts<'a>(before: &'a ErrorFigures, after: &'a ErrorFigures) -> Vec<Part<'a>> {
    let classes = before.classes.iter().filter_map(|old| {
        let new = after.classes.iter().find(|new| new.class == old.class)?;
        Some(Part { class: &old.class, share: new.share, before: &old.metrics, after: &new.metrics })
    });
    std::iter::once(Part { class: "", share: 1.0, before: &before.metrics, after: &after.metrics })
        .chain(classes)
        .collect()
}

/// Classes that are told on one side only: name, RMSE before and now, verdict.
fn lone_classes<'a>(before: &'a ErrorFigures, after: &'a ErrorFigures) -> Vec<(&'a str, [String; 2], &'static str)> {
    let only = |a: &'a ErrorFigures, b: &'a ErrorFigures| {
        let is_lone = |class: &str| b.classes.iter().all(|other| other.class != class);
        let lone = a.classes.iter().filter(move |it| is_lone(&it.class));
        lone.map(|it| (it.class.as_str(), significant(it.metrics.rmse, 4)))
    };
    let gone = only(before, after).map(|(class, rmse)| (class, [rmse, "gone".into()], GONE));
    gone.chain(only(after, before).map(|(class, rmse)| (class, ["none".into(), rmse], NEW))).collect()
}

impl Part<'_> {
    /// How many figures of it are compared.
    fn figure_count(&self) -> usize {
        if self.class.is_empty() { FIGURES } else { MEANS }
    }

    /// Name of one of its figures.
    fn name(&self, figure: &str) -> String {
        if self.class.is_empty() { figure.to_owned() } else { format!("{figure}, {}", self.class) }
    }
}

/// Figures that are compared of all receivers.
const FIGURES: usize = 7;
/// Those that are compared of a class, the first of them.
const MEANS: usize = 4;

fn figures(m: &Metrics, unshadowed_mean: f64) -> [Figure; FIGURES] {
    let absolute = |name, value: f64, noise| Figure { name, value, noise, is_relative: false };
    [
        absolute("rmse", m.rmse, Some(m.rmse_noise)),
        Figure {
            name: "rel_rmse",
            value: m.rel_rmse.unwrap_or(0.0),
            noise: relative(m.rmse_noise, unshadowed_mean),
            is_relative: true,
        },
        absolute("size of bias", m.bias.abs(), m.bias_noise),
        absolute("mae", m.mae, m.mae_noise),
        absolute("p95", m.p95, m.p95_noise),
        absolute("p99", m.p99, m.p99_noise),
        absolute("max", m.max, m.max_noise),
    ]
}

fn told(run: &Run) -> String {
    match &run.error {
        Some(error) => significant(error.metrics.rmse, 4),
        None => run.reason.clone().unwrap_or_default(),
    }
}

fn row(run: &Run, figure: &str, [before, after]: [String; 2], verdict: &str) -> Vec<Cell> {
    [
        run.scene.clone(),
        run.frame.to_string(),
        run.receivers.clone(),
        run.label.clone(),
        run.reference().to_owned(),
        figure.to_owned(),
        before,
        after,
        verdict.to_owned(),
    ]
    .map(Cell::text)
    .to_vec()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::{
        Reference, Weighting,
        classes::{ClassError, by_class},
        results::{Status, tests::example},
        traced::Traced,
    };
    use rayon::prelude::*;

    fn changed(change: impl Fn(&mut Metrics)) -> Results {
        let mut results = example();
        change(&mut results.runs[0].error.as_mut().unwrap().metrics);
        results
    }

    fn verdict(now: &Results, baseline: &Results) -> (usize, usize, usize) {
        let found = compare(now, baseline).unwrap();
        assert_eq!(found.figures, 7 * found.compared);
        (found.compared, found.failures, found.moved.rows.len())
    }

    #[test]
    fn growth_beyond_noise_fails_and_within_it_passes() {
        // The example's noise is 1e-4 on both sides and its RMSE 0.1. Fourteen figures: 3.90 · 1.414e-4 + 2e-3 + 5e-6 pass.
        let sigmas = student_quantile(0.01 / 14.0);
        let allowed = sigmas * 2.0f64.sqrt() * 1e-4 + 2e-3 + 5e-6;
        let of_rmse = |rmse| verdict(&changed(|m| m.rmse = rmse), &example());
        assert_eq!(of_rmse(0.1), (2, 0, 0));
        assert_eq!(of_rmse(0.1 + 0.999 * allowed), (2, 0, 0));
        assert_eq!(of_rmse(0.1 + 1.001 * allowed), (2, 1, 1));
        assert_eq!(of_rmse(0.05), (2, 0, 1));
        assert_eq!(of_rmse(f64::NAN), (2, 1, 1));
    }

    #[test]
    fn each_figure_fails_by_itself_and_a_baseline_of_nothing_passes_nobody() {
        let grow: [fn(&mut Metrics, f64); 7] = [
            |m, by| m.rmse *= by,
            |m, by| m.rel_rmse = m.rel_rmse.map(|value| value * by),
            |m, by| m.bias *= by,
            |m, by| m.mae *= by,
            |m, by| m.p95 *= by,
            |m, by| m.p99 *= by,
            |m, by| m.max *= by,
        ];
        for (number, grow) in grow.iter().enumerate() {
            // The noise that the example claims says how much a figure's noise hides: the maximum's is 0.3 %.
            assert_eq!(verdict(&changed(|m| grow(m, 1.05)), &example()), (2, 1, 1), "figure {number}");
            assert_eq!(verdict(&changed(|m| grow(m, 1.0 / 1.05)), &example()).1, 0, "figure {number}");
            assert_eq!(verdict(&example(), &changed(|m| grow(m, 0.0))), (2, 1, 1), "figure {number}");
        }
        let none = changed(|m| (m.bias, m.p99, m.max) = (0.0, 0.0, 0.0));
        assert_eq!(verdict(&example(), &none), (2, 3, 3));
        // A bias that changes sign but not size is told by what else changes.
        assert_eq!(verdict(&changed(|m| m.bias = -m.bias), &example()), (2, 0, 0));
    }

    #[test]
    fn baselines_of_older_versions_borrow_the_noise_of_now() {
        let mut old = example();
        for error in old.runs.iter_mut().filter_map(|run| run.error.as_mut()) {
            let m = &mut error.metrics;
            (m.bias_noise, m.mae_noise, m.p95_noise, m.p99_noise, m.max_noise) = (None, None, None, None, None);
        }
        assert_eq!(verdict(&changed(|m| m.max += 7e-3), &old), (2, 0, 0));
        assert_eq!(verdict(&changed(|m| m.max += 0.02), &old), (2, 1, 1));
        let mut other = example();
        other.runs[0].error.as_mut().unwrap().weights = Weighting::Area;
        let problem = compare(&other, &old).unwrap_err().to_string();
        assert!(problem.contains("`equal`") && problem.contains("`area`"), "{problem}");
    }

    #[test]
    fn a_baseline_of_nothing_or_of_something_else_is_refused() {
        let refused = |change: &dyn Fn(&mut Run)| {
            let mut baseline = example();
            change(&mut baseline.runs[0]);
            compare(&example(), &baseline).unwrap_err().to_string()
        };
        let receivers = refused(&|run| run.receiver_count = 3);
        let expected = "`fast:bands=4` on vertices of scene `vases`, frame 0: the receivers of the baseline are 3, those \
                        of the run 1000; renew the baseline";
        assert!(receivers.contains(expected), "{receivers}");
        let samples = refused(&|run| run.truth.as_mut().unwrap().samples = 1);
        assert!(samples.contains("the samples of the baseline are 1, those of the run 256"), "{samples}");
        assert!(refused(&|run| run.truth = None).contains("unknown"));
        assert!(refused(&|run| run.error.as_mut().unwrap().transport = "bounces=1".into()).contains("`bounces=1`"));
        assert!(check_baseline(&example()).is_ok());
        let empty = check_baseline(&Results { runs: Vec::new(), ..example() }).unwrap_err().to_string();
        assert!(empty.contains("no errors to compare with") && empty.contains("renew"), "{empty}");
        let mut twice = example();
        twice.runs.push(twice.runs[1].clone());
        let problem = check_baseline(&twice).unwrap_err().to_string();
        assert!(problem.contains("lists `exact` on vertices of scene `vases`, frame 0 twice"), "{problem}");
        assert_eq!(verdict(&example(), &Results { runs: Vec::new(), ..example() }), (0, 3, 3));
    }

    #[test]
    fn noise_that_a_baseline_claims_counts_as_far_as_the_run_confirms_it() {
        let mut doctored = example();
        for m in doctored.runs.iter_mut().filter_map(|run| run.error.as_mut()).map(|error| &mut error.metrics) {
            m.rmse_noise = 1e9;
            for noise in [&mut m.bias_noise, &mut m.mae_noise, &mut m.p95_noise, &mut m.p99_noise, &mut m.max_noise] {
                *noise = Some(1e9);
            }
            (m.rmse, m.rel_rmse) = (1e-9, Some(2e-9));
        }
        assert_eq!(verdict(&example(), &doctored), (2, 4, 4));
        // Honest estimates of noise differ, too.
        let sigmas = student_quantile(0.01 / 14.0);
        let noisier = changed(|m| m.rmse_noise = 2e-4);
        let grown = |by: f64| verdict(&changed(|m| m.rmse += by), &noisier).1;
        let allowed = sigmas * 5f64.sqrt() * 1e-4 + 2e-3 + 5e-6;
        assert_eq!((grown(0.999 * allowed), grown(1.001 * allowed)), (0, 1));
    }

    #[test]
    fn errors_by_class_are_compared_each_with_its_own_noise() {
        let told = |change: fn(&mut ClassError)| {
            let mut results = example();
            let error = results.runs[0].error.as_mut().unwrap();
            let class =
                |class: &str| ClassError { class: class.into(), receivers: 9, share: 0.5, metrics: error.metrics };
            error.classes = ["own", "ground"].map(class).to_vec();
            change(&mut error.classes[1]);
            results
        };
        let same = told(|_| {});
        let found = compare(&told(|class| class.metrics.mae *= 1.05), &same).unwrap();
        assert_eq!((found.figures, found.failures), (7 * 2 + 4 * 2, 1));
        assert_eq!(found.moved.rows[0][5], Cell::text("mae, ground"));
        assert_eq!(compare(&same, &told(|class| class.metrics.mae = 0.0)).unwrap().failures, 1);
        let noisy = told(|class| (class.metrics.mae, class.metrics.mae_noise) = (0.3, Some(0.1)));
        assert_eq!(compare(&noisy, &same).unwrap().failures, 0);
        for (now, baseline) in [(&same, &told(|class| class.class = "other".into())), (&example(), &same)] {
            assert_eq!(compare(now, baseline).unwrap().failures, 2);
            assert_eq!(compare(baseline, now).unwrap().failures, 2);
        }
    }

    /// A whole experiment on real traces: every scene and strategy against a seed of the truth, with errors `strength`
    /// times as large as they are.
    fn measured(scenes: &[(&Traced, Reference)], strength: f32) -> Results {
        let mut results = example();
        let blank = results.runs[0].clone();
        results.runs.clear();
        for (traced, reference) in scenes {
            for (strategy, mut radiance) in traced.strategies() {
                let values = radiance.channels.iter_mut().flatten().zip(traced.exact.channels.iter().flatten());
                values.for_each(|(value, exact)| *value = exact + strength * (*value - exact));
                let mut run = Run { scene: traced.name.into(), strategy: strategy.into(), ..blank.clone() };
                let error = run.error.as_mut().unwrap();
                error.metrics = crate::metrics::compare(&radiance, reference).unwrap();
                error.classes = by_class(&radiance, reference);
                run.truth.as_mut().unwrap().unshadowed_mean = reference.unshadowed_mean;
                results.runs.push(run);
            }
        }
        results
    }

    #[test]
    #[expect(clippy::print_stdout, reason = "shown with --nocapture: both rates")]
    fn other_seeds_of_the_truth_raise_no_alarm_and_growth_by_a_twentieth_is_found() {
        const SEEDS: u64 = 20;
        let scenes = Traced::all();
        let seen_with = |seed| scenes.iter().map(|traced| (traced, traced.reference(seed))).collect::<Vec<_>>();
        let baseline = measured(&seen_with(0), 1.0);
        let figures = compare(&baseline, &baseline).unwrap().figures;
        let failures = |seen: &[_], strength| compare(&measured(seen, strength), &baseline).unwrap().failures;
        let (alarms, missed) = (1..=SEEDS)
            .into_par_iter()
            .map(seen_with)
            .map(|seen| (usize::from(failures(&seen, 1.0) > 0), usize::from(failures(&seen, 1.05) == 0)))
            .reduce(|| (0, 0), |a, b| (a.0 + b.0, a.1 + b.1));
        println!("of {SEEDS} seeds, {figures} figures each: {alarms} false alarms, {missed} missed growths by 5 %");
        assert!(alarms <= 1 && missed == 0, "{alarms} false alarms, {missed} missed");
    }

    #[test]
    fn what_is_on_one_side_only_fails() {
        let mut fewer = example();
        fewer.runs.remove(0);
        let gone = compare(&fewer, &example()).unwrap();
        assert_eq!((gone.failures, gone.moved.rows.len()), (1, 1));
        let new = compare(&example(), &fewer).unwrap();
        assert_eq!((new.failures, new.moved.rows.len()), (1, 1));
        let mut broken = example();
        broken.runs[0].status = Status::Failed;
        broken.runs[0].error = None;
        assert_eq!(compare(&broken, &example()).unwrap().failures, 1);
        assert_eq!(compare(&example(), &broken).unwrap().failures, 1);
        let mut blind = broken.clone();
        blind.runs[0].status = Status::Unsupported;
        assert_eq!(verdict(&blind, &broken), (1, 0, 1));
        let quick = Results { quick: true, ..example() };
        assert!(compare(&quick, &example()).is_err());
    }
}
