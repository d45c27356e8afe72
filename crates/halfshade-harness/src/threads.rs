//! How many threads work.

use crate::HarnessError;

/// Most threads that can be asked for: beyond what machines have, the system runs out of memory for stacks.
pub const MAX_THREADS: usize = 1024;

/// Threads that the machine runs at once.
pub fn available() -> usize {
    std::thread::available_parallelism().map_or(1, |count| count.get())
}

/// Does `work` on `count` threads, or on all.
pub fn with_threads<T: Send>(count: Option<usize>, work: impl FnOnce() -> T + Send) -> Result<T, HarnessError> {
    let count = count.unwrap_or_else(available);
    if count > MAX_THREADS {
        return Err(HarnessError::input(format!("{count} threads: at most {MAX_THREADS}")));
    }
    let pool = rayon::ThreadPoolBuilder::new()
        .num_threads(count)
        .build()
        .map_err(|error| HarnessError::input(format!("cannot start {count} threads: {error}")))?;
    Ok(pool.install(work))
}
