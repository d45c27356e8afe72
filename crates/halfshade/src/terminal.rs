//! Data to stdout, human text to stderr, bars and colours on a terminal only.

use crate::failure::Failure;
use std::io::{IsTerminal, Write};

/// Prints `error: message` to stderr, coloured where that is a terminal that shows colours and nobody has asked for none
/// (NO_COLOR, CLICOLOR=0, TERM=dumb).
pub(crate) fn error(message: &str) {
    let _ = writeln!(anstream::stderr(), "\x1b[1;31merror:\x1b[0m {message}");
}

/// Prints a line for people to stderr.
pub(crate) fn human(line: &str) {
    let _ = writeln!(std::io::stderr(), "{line}");
}

/// Prints a last line to stderr, below what bars may have left of theirs.
pub(crate) fn interrupted(message: &str) {
    let clear = if draws_bars() { "\r\x1b[2K" } else { "" };
    human(&format!("{clear}{message}"));
}

/// Whether stderr is a terminal in which a line can be drawn again.
pub(crate) fn draws_bars() -> bool {
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
