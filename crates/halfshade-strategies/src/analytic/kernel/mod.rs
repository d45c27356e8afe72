//! Closed forms, eight receivers side by side.

pub(crate) mod hemisphere;
pub(crate) mod overlap;
