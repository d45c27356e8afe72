//! The error that methods are ranked by, as a cell of a table.

use super::{significant::significant, table::Cell};
use crate::Metrics;

/// The cell of an error that is ranked.
pub(super) fn relative_rmse(m: &Metrics) -> Cell {
    match m.rel_rmse {
        Some(value) if m.resolved => Cell::number(significant(value, 3), value),
        Some(value) => Cell::unresolved(format!("not resolved (about {})", significant(value, 1))),
        None => Cell::text("no light"),
    }
}
