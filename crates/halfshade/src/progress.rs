//! Progress of long work: bars on a terminal, a line a minute elsewhere, notes in between.

use crate::terminal;
use halfshade_harness::{Clock, SystemClock};
use halfshade_scene::Progress;
use indicatif::{MultiProgress, ProgressBar, ProgressDrawTarget, ProgressStyle};
use std::{
    sync::{Mutex, MutexGuard, PoisonError},
    time::Duration,
};

/// How much a command tells beside its data and errors.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
pub(crate) enum Verbosity {
    /// Nothing.
    Quiet,
    /// Notes, and how far it is.
    Usual,
    /// Each stage as it begins, too.
    Verbose,
}

/// Time between two lines where nothing can be drawn.
const LINE_EVERY: Duration = Duration::from_secs(60);

/// A listener that tells on stderr.
pub(crate) struct ToldProgress {
    verbosity: Verbosity,
    /// Whether bars are drawn.
    draws: bool,
    clock: SystemClock,
    state: Mutex<State>,
}

struct State {
    bars: MultiProgress,
    stage: ProgressBar,
    whole: ProgressBar,
    lines: Lines,
}

impl ToldProgress {
    pub(crate) fn new(verbosity: Verbosity) -> Self {
        let draws = verbosity > Verbosity::Quiet && terminal::draws_bars();
        let target = if draws { ProgressDrawTarget::stderr() } else { ProgressDrawTarget::hidden() };
        let state = State {
            bars: MultiProgress::with_draw_target(target),
            stage: ProgressBar::hidden(),
            whole: ProgressBar::hidden(),
            lines: Lines::default(),
        };
        Self { verbosity, draws, clock: SystemClock::start(), state: Mutex::new(state) }
    }

    fn state(&self) -> MutexGuard<'_, State> {
        self.state.lock().unwrap_or_else(PoisonError::into_inner)
    }

    /// Prints the line that is due, where nothing is drawn.
    fn tell(&self, state: &mut State) {
        if self.verbosity > Verbosity::Quiet
            && !self.draws
            && let Some(line) = state.lines.due(self.clock.now())
        {
            terminal::human(&line);
        }
    }
}

impl State {
    fn bar(&self, label: &str, total: u64) -> ProgressBar {
        let bar = self.bars.add(ProgressBar::new(total));
        if let Ok(style) = ProgressStyle::with_template("{msg:28!} [{bar:40}] {percent:>3} % {elapsed} (left {eta})") {
            bar.set_style(style.progress_chars("=> "));
        }
        bar.set_message(label.to_owned());
        bar
    }
}

impl Progress for ToldProgress {
    fn start(&self, label: &str, total: u64) {
        if self.verbosity == Verbosity::Verbose {
            self.state().bars.suspend(|| terminal::human(label));
        }
        let mut state = self.state();
        state.stage.finish_and_clear();
        state.bars.remove(&state.stage);
        state.stage = state.bar(label, total);
        state.lines.stage = Stage { label: label.to_owned(), done: 0, total };
        self.tell(&mut state);
    }

    fn advance(&self, steps: u64) {
        let mut state = self.state();
        state.stage.inc(steps);
        state.lines.stage.done += steps;
        self.tell(&mut state);
    }

    fn overall(&self, done: u64, total: u64) {
        let mut state = self.state();
        if state.lines.whole.is_none() {
            state.whole = state.bar("all", total);
        }
        state.whole.set_position(done);
        state.lines.whole = Some((done, total));
        self.tell(&mut state);
    }

    /// Above the bars, if there are some.
    fn note(&self, text: &str) {
        if self.verbosity > Verbosity::Quiet {
            self.state().bars.suspend(|| terminal::human(&format!("note: {text}")));
        }
    }
}

impl Drop for ToldProgress {
    fn drop(&mut self) {
        let state = self.state();
        state.stage.finish_and_clear();
        state.whole.finish_and_clear();
    }
}

/// Lines that tell how far the work is, at most one a minute.
#[derive(Debug, Default)]
struct Lines {
    stage: Stage,
    /// Parts of the whole that are done, and all, where they are known.
    whole: Option<(u64, u64)>,
    last: Duration,
}

#[derive(Debug, Default)]
struct Stage {
    label: String,
    done: u64,
    total: u64,
}

impl Lines {
    /// The line that is due `now`, since the start.
    fn due(&mut self, now: Duration) -> Option<String> {
        if now < self.last + LINE_EVERY {
            return None;
        }
        self.last = now;
        let Stage { label, done, total } = &self.stage;
        let stage = format!("{label} {} %", percent(*done, *total));
        let minutes = now.as_secs() / 60;
        Some(match self.whole {
            None => format!("{minutes} min: {stage}"),
            Some((done, total)) => {
                let left = match done {
                    0 => String::new(),
                    done => {
                        let left = now.mul_f64(total.saturating_sub(done) as f64 / done as f64);
                        format!(", about {} min left", left.as_secs().div_ceil(60))
                    }
                };
                format!("{minutes} min: {} % of all{left}; {stage}", percent(done, total))
            }
        })
    }
}

fn percent(done: u64, total: u64) -> u64 {
    (100 * done).checked_div(total).map_or(0, |percent| percent.min(100))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_line_a_minute_tells_what_is_left() {
        let at = Duration::from_secs;
        let mut lines = Lines { stage: Stage { label: "timing vases".into(), done: 3, total: 4 }, ..Lines::default() };
        assert_eq!(lines.due(at(59)), None);
        assert_eq!(lines.due(at(61)).as_deref(), Some("1 min: timing vases 75 %"));
        assert_eq!((lines.due(at(62)), lines.due(at(120))), (None, None));
        lines.whole = Some((0, 20));
        assert_eq!(lines.due(at(121)).as_deref(), Some("2 min: 0 % of all; timing vases 75 %"));
        lines.whole = Some((5, 20));
        assert_eq!(lines.due(at(240)).as_deref(), Some("4 min: 25 % of all, about 12 min left; timing vases 75 %"));
        lines.stage.total = 0;
        assert!(lines.due(at(999)).is_some_and(|line| line.ends_with("timing vases 0 %")));
    }
}
