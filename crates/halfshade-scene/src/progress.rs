//! How long work tells where it stands, and what else the user should know, without knowing who listens.

/// A listener for the progress of one long task. Implementations decide whether anything is drawn.
pub trait Progress: Sync {
    /// A stage called `label` with `total` steps begins; it replaces the stage before.
    fn start(&self, label: &str, total: u64);
    /// `steps` more steps of the current stage are done.
    fn advance(&self, steps: u64);
    /// `done` of `total` steps of all that is asked for are done, each of which may have stages; for work that knows how many.
    fn overall(&self, _done: u64, _total: u64) {}
    /// A sentence for the user, such as of a cache entry that was refused.
    fn note(&self, _text: &str) {}
}

/// Nobody listens.
#[derive(Debug, Clone, Copy, Default)]
pub struct Silent;

impl Progress for Silent {
    fn start(&self, _label: &str, _total: u64) {}
    fn advance(&self, _steps: u64) {}
}
