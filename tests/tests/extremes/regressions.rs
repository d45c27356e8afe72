//! Scenes that failed once.

/// Seed, strategy with its settings, and what was wrong.
pub(crate) const ALL: &[(u64, &str, &str)] = &[];
