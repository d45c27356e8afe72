//! The only clock. Nobody else measures time, so nobody measures it differently.

use std::time::{Duration, Instant};

/// Something that tells the time since a moment of its own choice.
pub trait Clock: Sync {
    /// Time passed since that moment; never falls.
    fn now(&self) -> Duration;
}

/// The machine's monotonic clock.
#[derive(Debug, Clone, Copy)]
pub struct SystemClock(Instant);

impl SystemClock {
    /// A clock that starts at zero now.
    pub fn start() -> Self {
        Self(Instant::now())
    }
}

impl Clock for SystemClock {
    fn now(&self) -> Duration {
        self.0.elapsed()
    }
}

/// Seconds that `work` takes by `clock`, and what it returns.
pub fn time_secs<T>(clock: &dyn Clock, work: impl FnOnce() -> T) -> (f64, T) {
    let before = clock.now();
    let value = work();
    (clock.now().saturating_sub(before).as_secs_f64(), value)
}

#[cfg(test)]
pub(crate) mod mock {
    use super::Clock;
    use std::{
        sync::atomic::{AtomicU64, Ordering},
        time::Duration,
    };

    /// A clock that stands still until it is told how much time passed.
    #[derive(Debug, Default)]
    pub(crate) struct MockClock(AtomicU64);

    impl MockClock {
        pub(crate) fn advance(&self, duration: Duration) {
            self.0.fetch_add(u64::try_from(duration.as_nanos()).unwrap(), Ordering::SeqCst);
        }
    }

    impl Clock for MockClock {
        fn now(&self) -> Duration {
            Duration::from_nanos(self.0.load(Ordering::SeqCst))
        }
    }
}

#[cfg(test)]
mod tests {
    use super::{mock::MockClock, *};

    #[test]
    fn work_is_charged_with_the_time_that_passes_while_it_runs() {
        let clock = MockClock::default();
        clock.advance(Duration::from_secs(5));
        let (secs, value) = time_secs(&clock, || {
            clock.advance(Duration::from_millis(250));
            7
        });
        assert_eq!((secs, value), (0.25, 7));
    }
}
