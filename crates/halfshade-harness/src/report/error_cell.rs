//! The error that methods are ranked by, as a cell of a table.

use super::{significant::significant, table::Cell};
use crate::Metrics;

/// The cell of an error that is ranked, with its interval if that is known.
pub(super) fn relative_rmse(m: &Metrics) -> Cell {
    match m.rel_rmse {
        Some(value) if m.resolved => {
            let interval = m.intervals.and_then(|intervals| intervals.rel_rmse);
            let interval = interval.map(|ends| format!(" ({})", between(ends, |end| significant(end, 3))));
            Cell::number(significant(value, 3) + &interval.unwrap_or_default(), value)
        }
        Some(value) => Cell::unresolved(format!("not resolved (about {})", significant(value, 1))),
        None => Cell::text("no light"),
    }
}

/// Both ends of an interval.
pub(super) fn between([low, high]: [f64; 2], figure: impl Fn(f64) -> String) -> String {
    format!("{} to {}", figure(low), figure(high))
}
