//! Regression: has any error grown beyond noise since a baseline?
//!
//! Every figure of every run is compared: RMSE, its relative, bias by its size, mean absolute error, both percentiles and
//! the maximum. A figure has grown if it exceeds the baseline's by more than
//!
//! ```text
//! σ-multiple · hypot(noise before, noise now) + 2 % of the baseline's figure + 1e-5 of the mean unshadowed radiance
//! ```
//!
//! The last two allow for processors that round differently; with the same seeds on the same processor the difference is
//! 0. The multiple makes a false alarm of a whole check, all its figures together, as rare as [`FALSE_ALARMS`] under
//! another seed of the truth: each of n figures gets an n-th of that (Bonferroni), by Student's distribution with 15
//! degrees of freedom, since noise is known from sixteen estimates. It grows slowly, from 3.7 for ten figures to 5.7
//! for five hundred. A run that was measured before and isn't any more fails too.

use crate::{
    HarnessError, Metrics, Results,
    metrics::relative,
    report::{Cell, Column, Table, significant},
    results::{Run, Status},
};

/// How often a check may fail by noise alone.
pub const FALSE_ALARMS: f64 = 0.01;
/// Fraction of a baseline's figure that passes.
const TOLERANCE: f64 = 0.02;
/// Fraction of the mean unshadowed radiance that passes: what single precision leaves of sums.
const ROUNDING: f64 = 1e-5;

/// A figure with its noise.
struct Figure {
    name: &'static str,
    value: f64,
    noise: Option<f64>,
    /// A fraction of the mean unshadowed radiance, like `rel_rmse`; others are radiance.
    is_relative: bool,
}

/// What a comparison found.
#[derive(Debug, Clone, PartialEq)]
pub struct Comparison {
    /// What moved beyond the tolerance, either way, and what is new or gone.
    pub moved: Table,
    /// How many runs were compared.
    pub compared: usize,
    /// How many figures of them.
    pub figures: usize,
    /// How many figures grew worse and runs are gone.
    pub failures: usize,
}

/// Compares the errors of `now` with those of `baseline`.
pub fn compare(now: &Results, baseline: &Results) -> Result<Comparison, HarnessError> {
    if now.quick != baseline.quick {
        return Err(HarnessError::input("the baseline was made with another --quick: both must be the same"));
    }
    let same = |a: &Run, b: &Run| a.key() == b.key() && (a.reference() == b.reference() || a.status != b.status);
    let pairs: Vec<(&Run, Option<&Run>)> =
        baseline.runs.iter().map(|old| (old, now.runs.iter().find(|new| same(new, old)))).collect();
    let both = |(old, new): &(&Run, Option<&Run>)| old.error.is_some() && new.is_some_and(|new| new.error.is_some());
    let compared = pairs.iter().filter(|pair| both(pair)).count();
    let count = compared * FIGURES;
    let sigmas = student_quantile(FALSE_ALARMS / count.max(1) as f64);
    let (mut rows, mut failures) = (Vec::new(), 0);
    for (old, new) in pairs {
        let Some(new) = new else {
            failures += 1;
            rows.push(row(old, "", [old_text(old), "gone".into()], "FAILED: no longer measured"));
            continue;
        };
        let (Some(before), Some(after)) = (&old.error, &new.error) else {
            if old.status != new.status {
                let worse = old.status == Status::Ok;
                failures += usize::from(worse);
                let why = new.reason.clone().unwrap_or_default();
                let verdict = if worse { "FAILED: no longer measured" } else { "measured now" };
                rows.push(row(new, "", [old_text(old), why], verdict));
            }
            continue;
        };
        if before.weights != after.weights {
            return Err(HarnessError::input(format!(
                "the baseline counts receivers of `{}` by `{}`, now it is `{}`: set `weights` to the same, or renew the baseline",
                old.scene, before.weights, after.weights
            )));
        }
        let mean = new.truth.as_ref().map_or(0.0, |truth| truth.unshadowed_mean.abs());
        let figures = figures(&before.metrics, mean).into_iter().zip(figures(&after.metrics, mean));
        for (before, after) in figures {
            // Baselines of older versions know the noise of the RMSE alone.
            let noise = before.noise.or(after.noise).unwrap_or(0.0).hypot(after.noise.unwrap_or(0.0));
            let rounding = if before.is_relative { ROUNDING } else { ROUNDING * mean };
            let allowed = sigmas * noise + TOLERANCE * before.value + rounding;
            let change = after.value - before.value;
            let unclear = !(change.is_finite() && allowed.is_finite());
            if change.abs() > allowed || unclear {
                let worse = change > allowed || unclear;
                failures += usize::from(worse);
                let verdict = if worse { "FAILED: error grew" } else { "better: renew the baseline" };
                let values = [before.value, after.value].map(|value| significant(value, 4));
                rows.push(row(new, before.name, values, verdict));
            }
        }
    }
    for new in now.runs.iter().filter(|new| baseline.runs.iter().all(|old| !same(new, old))) {
        rows.push(row(new, "", ["none".into(), old_text(new)], "new: renew the baseline"));
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
    Ok(Comparison { moved, compared, figures: count, failures })
}

/// Figures of a run that are compared.
const FIGURES: usize = 7;

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

/// The t that Student's distribution with 15 degrees of freedom exceeds with a `probability` of at most one half.
///
/// `P(|T| < t) = (2/π) (θ + sin θ cos θ Σ_{j<7} c_j cos^{2j} θ)`, θ = atan(t/√15), c_j = c_{j-1} · 2j/(2j + 1), c_0 = 1, by
/// bisection.
fn student_quantile(probability: f64) -> f64 {
    const DEGREES: f64 = 15.0;
    let exceeds = |t: f64| {
        let theta = (t / DEGREES.sqrt()).atan();
        let (sin, cos) = theta.sin_cos();
        let (mut term, mut sum) = (1.0, 0.0);
        for j in 0..7 {
            sum += term;
            term *= cos * cos * f64::from(2 * j + 2) / f64::from(2 * j + 3);
        }
        0.5 - (theta + sin * cos * sum) / std::f64::consts::PI
    };
    let (mut low, mut high) = (0.0, 100.0);
    for _ in 0..60 {
        let middle = 0.5 * (low + high);
        if exceeds(middle) > probability { low = middle } else { high = middle }
    }
    high
}

fn old_text(run: &Run) -> String {
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
    use crate::{Reference, Weighting, results::tests::example, traced::Traced};

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
            // What the figure's noise hides is told by the noise that the example claims: the maximum's is 0.3 %.
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

    /// A whole experiment on real traces: every scene and strategy against a seed of the truth, with errors `strength`
    /// times as large as they are.
    fn measured(scenes: &[(Traced, Reference)], strength: f32) -> Results {
        let mut results = example();
        let blank = results.runs[0].clone();
        results.runs.clear();
        for (traced, reference) in scenes {
            for (strategy, mut radiance) in traced.strategies() {
                let values = radiance.channels.iter_mut().flatten().zip(traced.exact.channels.iter().flatten());
                values.for_each(|(value, exact)| *value = exact + strength * (*value - exact));
                let mut run = Run { scene: traced.name.into(), strategy: strategy.into(), ..blank.clone() };
                run.error.as_mut().unwrap().metrics = crate::metrics::compare(&radiance, reference).unwrap();
                run.truth.as_mut().unwrap().unshadowed_mean = reference.unshadowed_mean;
                results.runs.push(run);
            }
        }
        results
    }

    #[test]
    #[expect(clippy::print_stdout, reason = "shown with --nocapture: both rates")]
    fn other_seeds_of_the_truth_raise_no_alarm_and_growth_by_a_twentieth_is_found() {
        const SEEDS: u64 = 100;
        let mut scenes: Vec<(Traced, Reference)> =
            Traced::all().into_iter().map(|traced| (traced.reference(0), traced)).map(|(a, b)| (b, a)).collect();
        let baseline = measured(&scenes, 1.0);
        let (mut alarms, mut missed) = (0, 0);
        for seed in 1..=SEEDS {
            scenes.iter_mut().for_each(|(traced, reference)| *reference = traced.reference(seed));
            alarms += usize::from(compare(&measured(&scenes, 1.0), &baseline).unwrap().failures > 0);
            missed += usize::from(compare(&measured(&scenes, 1.05), &baseline).unwrap().failures == 0);
        }
        let figures = FIGURES * baseline.runs.len();
        println!("of {SEEDS} seeds, {figures} figures each: {alarms} false alarms, {missed} missed growths by 5 %");
        assert!(alarms <= 1 && missed == 0, "{alarms} false alarms, {missed} missed");
    }

    #[test]
    fn quantiles_of_students_distribution() {
        // From tables: 15 degrees of freedom.
        for (probability, expected) in [(0.25, 0.6912), (0.05, 1.7531), (0.005, 2.9467), (0.0005, 4.0728)] {
            assert!((student_quantile(probability) - expected).abs() < 1e-4, "{probability}");
        }
    }

    #[test]
    fn what_is_gone_fails_and_what_is_new_is_shown() {
        let mut fewer = example();
        fewer.runs.remove(0);
        let gone = compare(&fewer, &example()).unwrap();
        assert_eq!((gone.failures, gone.moved.rows.len()), (1, 1));
        let new = compare(&example(), &fewer).unwrap();
        assert_eq!((new.failures, new.moved.rows.len()), (0, 1));
        let mut broken = example();
        broken.runs[0].status = Status::Failed;
        broken.runs[0].error = None;
        assert_eq!(compare(&broken, &example()).unwrap().failures, 1);
        let quick = Results { quick: true, ..example() };
        assert!(compare(&quick, &example()).is_err());
    }
}
