//! Times of a group, all strategies in turn.

use super::{group::Group, record::Record, setup::Setup};
use crate::{
    Clock, Device, HarnessError,
    frame_time::{neighbour, timed_frame},
};
use halfshade_scene::{Frame, RadianceBuffer, ReceiverBuffer};
use halfshade_strategy::{Baked, Shading, StrategyError};
use std::{collections::VecDeque, num::NonZeroU32, time::Duration};

/// A stream of frames is so many times as long as the number of those in flight: its beginning and end count little.
const STREAM_ROUNDS: usize = 8;

/// A strategy that is ready to be timed.
pub(super) struct Ready {
    pub(super) key: String,
    pub(super) device: Device,
    pub(super) baked: Box<dyn Baked>,
}

/// Rounds over all strategies, so that a disturbance meets all alike; whoever begins changes from round to round.
/// Before every timed frame its neighbour is prepared, untimed: what a frame changes is really new to it.
pub(super) fn time(
    setup: &Setup<'_>,
    group: &Group<'_>,
    ready: &mut [Ready],
    record: &mut Record,
) -> Result<(), HarnessError> {
    let Some(timing) = setup.plan.timing.filter(|_| !ready.is_empty()) else { return Ok(()) };
    let (tools, frame, scene) = (setup.tools, &group.frame, group.frame.scene);
    let neighbour = neighbour(frame);
    let rounds = ready.iter().map(|ready| setup.missing_samples(record, &ready.key)).max().unwrap_or(0);
    let all_rounds = timing.warm_up as usize + rounds;
    tools.progress.start(&format!("timing {}", scene.name), (all_rounds * ready.len()) as u64);
    let mut radiance = RadianceBuffer::zeros(group.receivers.len());
    for round in 0..all_rounds {
        let count = ready.len();
        for place in 0..count {
            let Ready { key, device, baked } = &mut ready[(place + round) % count];
            let warming_up = round < timing.warm_up as usize;
            if !warming_up && setup.missing_samples(record, key) == 0 {
                continue;
            }
            let failed = |error| HarnessError::input(format!("{key}: a frame failed while it was timed: {error}"));
            let frames = [&neighbour, frame];
            let mut sample = timed_frame(tools.clock, *device, baked.as_mut(), frames, &group.receivers, &mut radiance)
                .map_err(failed)?;
            if let Some(count) = timing.frames_in_flight.filter(|_| !device.is_cpu()) {
                let times =
                    timed_stream(tools.clock, count, baked.as_mut(), frames, &group.receivers).map_err(failed)?;
                [sample.streamed_secs, sample.latency_secs] = times.map_or([None; 2], |times| times.map(Some));
            }
            if !warming_up {
                record.add_sample(key, sample)?;
            }
            tools.progress.advance(1);
        }
    }
    Ok(())
}

/// Frames that follow each other while up to `count` are on their way: seconds per frame, and mean seconds from the beginning
/// of a frame's preparation to its end. `None` if the strategy can't begin without waiting.
fn timed_stream(
    clock: &dyn Clock,
    count: NonZeroU32,
    baked: &mut dyn Baked,
    frames: [&Frame<'_>; 2],
    receivers: &ReceiverBuffer,
) -> Result<Option<[f64; 2]>, StrategyError> {
    let count = count.get() as usize;
    let all = STREAM_ROUNDS * count;
    let mut latency_secs = 0.0;
    let mut flying: VecDeque<(Duration, Box<dyn Shading>)> = VecDeque::with_capacity(count);
    let mut land = |(start, shading): (Duration, Box<dyn Shading>)| -> Result<(), StrategyError> {
        shading.finish()?;
        latency_secs += clock.now().saturating_sub(start).as_secs_f64();
        Ok(())
    };
    let begin = clock.now();
    for number in 0..all {
        if flying.len() == count
            && let Some(first) = flying.pop_front()
        {
            land(first)?;
        }
        let start = clock.now();
        let prepared = baked.prepare(frames[number % 2])?;
        let Some(shading) = prepared.start(receivers.view()) else { return Ok(None) };
        flying.push_back((start, shading?));
    }
    flying.into_iter().try_for_each(&mut land)?;
    let whole_secs = clock.now().saturating_sub(begin).as_secs_f64();
    Ok(Some([whole_secs / all as f64, latency_secs / all as f64]))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::{clock::mock::MockClock, frame_time::tests::Steady};
    use glam::Vec3;
    use halfshade_scene::{Environment, RadianceMut, Receivers, Scene};
    use halfshade_strategy::{Footprint, Prepared};
    use std::sync::{Arc, Mutex};

    /// Shades for 6 ms by itself, one frame after another, and takes 1 ms to prepare.
    struct Device {
        clock: Arc<MockClock>,
        free_at: Mutex<Duration>,
    }

    struct Flight(Arc<MockClock>, Duration);

    impl Shading for Flight {
        fn finish(self: Box<Self>) -> Result<(), StrategyError> {
            self.0.advance(self.1.saturating_sub(self.0.now()));
            Ok(())
        }
    }

    impl Baked for Device {
        fn footprint(&self) -> Footprint {
            Footprint::default()
        }

        fn prepare(&mut self, _frame: &Frame<'_>) -> Result<Box<dyn Prepared + '_>, StrategyError> {
            self.clock.advance(Duration::from_millis(1));
            Ok(Box::new(&*self))
        }
    }

    impl Prepared for &Device {
        fn shade(&self, _receivers: Receivers<'_>, _out: RadianceMut<'_>) {}

        fn start(&self, _receivers: Receivers<'_>) -> Option<Result<Box<dyn Shading>, StrategyError>> {
            let mut free_at = self.free_at.lock().unwrap();
            *free_at = self.clock.now().max(*free_at) + Duration::from_millis(6);
            Some(Ok(Box::new(Flight(self.clock.clone(), *free_at))))
        }
    }

    /// One frame at a time takes 7 ms; more than one hide the preparation, and wait for those before them.
    #[test]
    fn frames_in_flight_trade_latency_for_throughput() {
        let scene = Scene { frame_count: 2, ..Scene::at_rest("empty", Vec::new(), Environment::constant(Vec3::ONE)) };
        let (a, b) = (scene.frame(0), scene.frame(1));
        let stream = |count: u32| {
            let clock = Arc::new(MockClock::default());
            let mut device = Device { clock: clock.clone(), free_at: Mutex::default() };
            let count = NonZeroU32::new(count).unwrap();
            timed_stream(clock.as_ref(), count, &mut device, [&a, &b], &ReceiverBuffer::default()).unwrap().unwrap()
        };
        let [[one, one_latency], [three, three_latency]] = [1, 3].map(stream);
        assert!((one - 0.007).abs() < 1e-9 && (one_latency - 0.007).abs() < 1e-9, "{one} {one_latency}");
        // 24 frames of 6 ms after the first preparation.
        assert!((three - 0.145 / 24.0).abs() < 1e-9, "{three}");
        assert!(three_latency > 0.016 && three_latency < 0.019, "{three_latency}");
        let mut steady = Steady(Arc::new(MockClock::default()));
        let clock = MockClock::default();
        let none = timed_stream(&clock, NonZeroU32::MIN, &mut steady, [&a, &b], &ReceiverBuffer::default()).unwrap();
        assert_eq!(none, None);
    }
}
