//! Times of a group, all strategies in turn.

use super::{group::Group, record::Record, setup::Setup};
use crate::{Clock, Device, HarnessError, clock::time_secs, results::Sample, shading::shade_all};
use halfshade_scene::{Frame, RadianceBuffer, ReceiverBuffer};
use halfshade_strategy::{Baked, StrategyError};

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
    let neighbour = scene.frame(if frame.index > 0 { frame.index - 1 } else { 1 });
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
            let sample =
                timed_frame(tools.clock, *device, baked.as_mut(), [&neighbour, frame], &group.receivers, &mut radiance)
                    .map_err(|error| {
                        HarnessError::input(format!("{key}: a frame failed while it was timed: {error}"))
                    })?;
            if !warming_up {
                record.add_sample(key, sample)?;
            }
            tools.progress.advance(1);
        }
    }
    Ok(())
}

/// One frame by the clock, after its neighbour was prepared untimed.
fn timed_frame(
    clock: &dyn Clock,
    device: Device,
    baked: &mut dyn Baked,
    [neighbour, frame]: [&Frame<'_>; 2],
    receivers: &ReceiverBuffer,
    radiance: &mut RadianceBuffer,
) -> Result<Sample, StrategyError> {
    baked.prepare(neighbour)?;
    let (prepare_secs, prepared) = time_secs(clock, || baked.prepare(frame));
    let prepared = prepared?;
    let (shade_secs, ()) = time_secs(clock, || shade_all(prepared.as_ref(), receivers.view(), radiance));
    let (read_back_secs, read) = time_secs(clock, || prepared.read_back(radiance.view_mut()));
    read?;
    let read_back_secs = (!device.is_cpu()).then_some(read_back_secs);
    Ok(Sample { prepare_secs, shade_secs, read_back_secs, device_secs: prepared.device_secs() })
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::{clock::mock::MockClock, results::TimeFigures};
    use glam::Vec3;
    use halfshade_scene::{Environment, RadianceMut, Receivers, Scene};
    use halfshade_strategy::{Footprint, Prepared};
    use std::{sync::Arc, time::Duration};

    /// Takes 2 ms to prepare the frame it is asked for and 100 ms for any other, and 5 ms to shade.
    struct Steady(Arc<MockClock>);

    impl Baked for Steady {
        fn footprint(&self) -> Footprint {
            Footprint::default()
        }

        fn prepare(&mut self, frame: &Frame<'_>) -> Result<Box<dyn Prepared + '_>, StrategyError> {
            self.0.advance(Duration::from_millis(if frame.index == 7 { 2 } else { 100 }));
            Ok(Box::new(&*self))
        }
    }

    impl Prepared for &Steady {
        fn shade(&self, _receivers: Receivers<'_>, _out: RadianceMut<'_>) {
            self.0.advance(Duration::from_millis(5));
        }
    }

    #[test]
    fn preparing_and_shading_are_charged_apart_and_the_neighbour_is_free() {
        let scene = Scene { frame_count: 10, ..Scene::at_rest("empty", Vec::new(), Environment::constant(Vec3::ONE)) };
        let clock = Arc::new(MockClock::default());
        let mut receivers = ReceiverBuffer::default();
        receivers.push(Vec3::ZERO, Vec3::Y, Vec3::ONE, 0);
        let mut radiance = RadianceBuffer::zeros(1);
        let mut steady = Steady(clock.clone());
        let (neighbour, frame) = (scene.frame(6), scene.frame(7));
        let sample =
            timed_frame(clock.as_ref(), Device::Cpu, &mut steady, [&neighbour, &frame], &receivers, &mut radiance)
                .unwrap();
        assert_eq!(sample, Sample::new(0.002, 0.005));
        let figures = TimeFigures::of(1.0, 2, vec![sample; 3]);
        assert!((figures.frames_per_sec.unwrap() - 1.0 / 0.007).abs() < 1e-9);
    }
}
