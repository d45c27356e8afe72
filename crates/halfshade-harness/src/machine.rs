//! What a measurement ran on.

use crate::{HarnessError, results::Machine};

/// Most threads that can be asked for: beyond what machines have, the system runs out of memory for stacks.
pub const MAX_THREADS: usize = 1024;

/// Processor, threads and operating system.
pub fn describe(threads: usize) -> Machine {
    Machine { cpu: cpu(), threads, gpu: None, os: format!("{} {}", std::env::consts::OS, std::env::consts::ARCH) }
}

/// Threads that the machine runs at once.
pub fn threads() -> usize {
    std::thread::available_parallelism().map_or(1, |count| count.get())
}

fn cpu() -> String {
    let text = std::fs::read_to_string("/proc/cpuinfo").unwrap_or_default();
    text.lines()
        .find_map(|line| line.strip_prefix("model name")?.split_once(':').map(|(_, name)| name.trim().to_owned()))
        .unwrap_or_else(|| std::env::consts::ARCH.to_owned())
}

/// Hash of the program that runs, or nothing if it can't be read: built anew from changed sources, even one of the same
/// commit may compute something else.
pub fn program_hash() -> String {
    let bytes = std::env::current_exe().and_then(std::fs::read);
    bytes.map(|bytes| blake3::hash(&bytes).to_hex().to_string()).unwrap_or_default()
}

/// Does `work` on `count` threads, or on all.
pub fn with_threads<T: Send>(count: Option<usize>, work: impl FnOnce() -> T + Send) -> Result<T, HarnessError> {
    let count = count.unwrap_or_else(threads);
    if count > MAX_THREADS {
        return Err(HarnessError::input(format!("{count} threads: at most {MAX_THREADS}")));
    }
    let pool = rayon::ThreadPoolBuilder::new()
        .num_threads(count)
        .build()
        .map_err(|error| HarnessError::input(format!("cannot start {count} threads: {error}")))?;
    Ok(pool.install(work))
}
