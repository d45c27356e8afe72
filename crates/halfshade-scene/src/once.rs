//! Values that are computed once for the whole program, by work on all cores.

use std::sync::OnceLock;

/// The value in `cell`; if there is none yet, that which `compute` returns, which must be the same every time.
///
/// `compute` may use the thread pool: nobody waits for it. [`OnceLock::get_or_init`] and `LazyLock` would hold a lock
/// meanwhile, and a worker that awaits the others' part of the work takes up further tasks, which ask for the same
/// value and wait for it forever. A thread that asks while the value is being computed computes it too.
pub fn once<T>(cell: &OnceLock<T>, compute: impl FnOnce() -> T) -> &T {
    if let Some(value) = cell.get() {
        return value;
    }
    let value = compute();
    cell.get_or_init(|| value)
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::sync::{Barrier, mpsc};
    use std::thread;
    use std::time::Duration;

    /// One worker, done with its half of the work, takes up a task that asks for the same value while the other half
    /// lasts.
    fn ask_while_computing() -> u32 {
        let (cell, halves, asked) = (OnceLock::new(), Barrier::new(2), OnceLock::new());
        let pool = rayon::ThreadPoolBuilder::new().num_threads(2).build().expect("two threads");
        pool.scope(|scope| {
            let other_half = || {
                halves.wait();
                scope.spawn(|_| asked.set(*once(&cell, || 1)).expect("one task asks"));
                *asked.wait()
            };
            once(&cell, || rayon::join(|| halves.wait(), other_half).1);
        });
        cell.into_inner().expect("a value")
    }

    #[test]
    fn a_worker_never_waits_for_itself() {
        let (done, end) = mpsc::channel();
        thread::spawn(move || done.send(ask_while_computing()));
        assert_eq!(end.recv_timeout(Duration::from_secs(20)), Ok(1), "a worker waits for what it computes itself");
    }
}
