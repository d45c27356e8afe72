//! Data to stdout, human text to stderr, bars and colours on a terminal only.

use crate::failure::Failure;
use halfshade_scene::Progress;
use indicatif::{ProgressBar, ProgressDrawTarget, ProgressStyle};
use std::{
    io::{IsTerminal, Write},
    sync::Mutex,
};

/// Prints `error: message` to stderr, coloured where that is a terminal that shows colours and nobody has asked for none
/// (NO_COLOR, CLICOLOR=0, TERM=dumb).
pub(crate) fn error(message: &str) {
    let _ = writeln!(anstream::stderr(), "\x1b[1;31merror:\x1b[0m {message}");
}

/// Prints a last line to stderr, below what bars may have left of theirs.
pub(crate) fn interrupted(message: &str) {
    let clear = if draws_bars() { "\r\x1b[2K" } else { "" };
    let _ = writeln!(std::io::stderr(), "{clear}{message}");
}

/// Whether stderr is a terminal in which a line can be drawn again.
fn draws_bars() -> bool {
    std::io::stderr().is_terminal() && std::env::var_os("TERM").is_none_or(|term| term != "dumb")
}

/// Prints to stdout.
pub(crate) fn data(text: &str) -> Result<(), Failure> {
    let mut stdout = std::io::stdout().lock();
    stdout.write_all(text.as_bytes()).and_then(|()| stdout.flush()).map_err(|error| match error.kind() {
        // Whoever reads has read enough.
        std::io::ErrorKind::BrokenPipe => Failure::ClosedPipe,
        _ => Failure::Error(format!("cannot write to the standard output: {error}")),
    })
}

/// Progress bars on stderr; nothing where stderr is no terminal, or a dumb one.
pub(crate) struct ProgressBars(Mutex<ProgressBar>);

impl ProgressBars {
    pub(crate) fn new() -> Self {
        Self(Mutex::new(ProgressBar::hidden()))
    }
}

impl Progress for ProgressBars {
    fn start(&self, label: &str, total: u64) {
        let Ok(mut bar) = self.0.lock() else { return };
        bar.finish_and_clear();
        if !draws_bars() {
            return;
        }
        *bar = ProgressBar::with_draw_target(Some(total), ProgressDrawTarget::stderr());
        if let Ok(style) = ProgressStyle::with_template("{msg:28} [{bar:40}] {percent:>3} % {elapsed} (left {eta})") {
            bar.set_style(style.progress_chars("=> "));
        }
        bar.set_message(label.to_owned());
    }

    fn advance(&self, steps: u64) {
        if let Ok(bar) = self.0.lock() {
            bar.inc(steps);
        }
    }

    /// Above the bar, if there is one.
    fn note(&self, text: &str) {
        if let Ok(bar) = self.0.lock() {
            bar.suspend(|| {
                let _ = writeln!(std::io::stderr(), "note: {text}");
            });
        }
    }
}

impl Drop for ProgressBars {
    fn drop(&mut self) {
        if let Ok(bar) = self.0.lock() {
            bar.finish_and_clear();
        }
    }
}
