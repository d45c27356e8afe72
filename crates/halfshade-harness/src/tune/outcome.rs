//! The choice among what was run in full.

use super::{Bounds, bounds::Figures};
use crate::{Results, report::figures_of_all};
use std::fmt;

/// The strategy that is chosen.
#[derive(Debug, Clone, PartialEq)]
pub struct Choice {
    /// Its label, which is its SPEC.
    pub label: String,
    /// Its figures.
    pub figures: Figures,
    /// Whether it meets all bounds; if not, it comes nearest.
    pub meets_bounds: bool,
}

/// Findings of a search.
#[derive(Debug)]
pub struct Outcome {
    /// The choice.
    pub choice: Choice,
    /// What was asked.
    pub bounds: Bounds,
    /// Candidates that were tried.
    pub tried: usize,
    /// All candidates.
    pub count: usize,
    /// Receivers at which errors were first measured.
    pub sample: usize,
    /// All receivers.
    pub receivers: usize,
    /// Results of those that were run in full.
    pub results: Results,
}

impl Choice {
    /// The cheapest that meets `bounds`, or what comes nearest; `None` if nothing was measured.
    pub(super) fn of(results: &Results, bounds: &Bounds) -> Option<Self> {
        let all = || {
            figures_of_all(results).into_iter().map(|(label, error, frame_secs, bytes)| {
                let figures = Figures { error, frame_secs, bytes };
                Self { label, figures, meets_bounds: bounds.are_met(&figures) }
            })
        };
        let cost = |choice: &Self| bounds.cost(&choice.figures);
        let strain = |choice: &Self| bounds.strain(&choice.figures);
        let best = all().filter(|choice| choice.meets_bounds).min_by(|a, b| cost(a).total_cmp(&cost(b)));
        best.or_else(|| all().min_by(|a, b| strain(a).total_cmp(&strain(b))))
    }
}

impl fmt::Display for Outcome {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        use crate::report::{bytes, percent, seconds};
        let Self { choice: Choice { label, figures, meets_bounds }, bounds, .. } = self;
        let bound = |text: Option<String>| text.map_or(String::new(), |text| format!(" (at most {text})"));
        let found = format!(
            "error {}{}, frame {}{}, memory {}{}",
            percent(figures.error),
            bound(bounds.error.map(percent)),
            seconds(figures.frame_secs, 3),
            bound(bounds.frame_secs.map(|secs| seconds(secs, 3))),
            bytes(figures.bytes as usize),
            bound(bounds.bytes.map(|count| bytes(count as usize)))
        );
        match meets_bounds {
            true => writeln!(f, "{label}: {found}")?,
            false => writeln!(f, "nothing meets these bounds; {label} comes nearest: {found}")?,
        }
        write!(
            f,
            "Of {} settings {} were tried, with the truth at {} of {} receivers, and {} of them run in full.",
            self.count,
            self.tried,
            self.sample,
            self.receivers,
            figures_of_all(&self.results).len()
        )
    }
}
