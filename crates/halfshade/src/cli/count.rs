//! Counts on the command line.

use halfshade_harness::threads::MAX_THREADS;
use halfshade_truth::MAX_SAMPLES;

pub(super) fn thread_count(text: &str) -> Result<usize, String> {
    count(text, MAX_THREADS)
}

/// A whole number from 1 to `most`.
pub(super) fn count(text: &str, most: usize) -> Result<usize, String> {
    let count = text.parse().ok().filter(|count| (1..=most).contains(count));
    count.ok_or_else(|| format!("expected a whole number from 1 to {most}"))
}

/// A number of samples per receiver.
pub(super) fn sample_count(text: &str) -> Result<usize, String> {
    count(text, MAX_SAMPLES)
}
