//! Time of single frames.

use crate::{
    Clock, Device,
    clock::time_secs,
    results::{Sample, TimeFigures},
    shading::shade_all,
};
use halfshade_scene::{Frame, RadianceBuffer, ReceiverBuffer};
use halfshade_strategy::{Baked, StrategyError};

/// The frame before, or the one after the first: what is prepared, untimed, before a frame is timed, so that what a frame changes is
/// really new to it.
pub fn neighbour<'a>(frame: &Frame<'a>) -> Frame<'a> {
    frame.scene.frame(if frame.index > 0 { frame.index - 1 } else { 1 })
}

/// One frame by the clock, after its neighbour was prepared untimed.
pub fn timed_frame(
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
    Ok(Sample { read_back_secs, device_secs: prepared.device_secs(), ..Sample::new(prepare_secs, shade_secs) })
}

/// Times of `rounds` frames after one that is thrown away; nothing is said of baking.
///
/// # Errors
/// Whatever stops a strategy.
pub fn frame_times(
    clock: &dyn Clock,
    device: Device,
    baked: &mut dyn Baked,
    frame: &Frame<'_>,
    receivers: &ReceiverBuffer,
    rounds: usize,
) -> Result<TimeFigures, StrategyError> {
    let neighbour = neighbour(frame);
    let mut radiance = RadianceBuffer::zeros(receivers.len());
    let mut round = || timed_frame(clock, device, baked, [&neighbour, frame], receivers, &mut radiance);
    round()?;
    let samples = (0..rounds).map(|_| round()).collect::<Result<Vec<_>, _>>()?;
    Ok(TimeFigures::of(0.0, rayon::current_num_threads(), samples))
}

#[cfg(test)]
pub(crate) mod tests {
    use super::*;
    use crate::clock::mock::MockClock;
    use glam::Vec3;
    use halfshade_scene::{Environment, RadianceMut, Receivers, Scene};
    use halfshade_strategy::{Footprint, Prepared};
    use std::{sync::Arc, time::Duration};

    /// Takes 2 ms to prepare the frame it is asked for and 100 ms for any other, and 5 ms to shade.
    pub(crate) struct Steady(pub(crate) Arc<MockClock>);

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
        let figures = frame_times(clock.as_ref(), Device::Cpu, &mut steady, &frame, &receivers, 3).unwrap();
        assert_eq!(figures.samples.len(), 3);
        assert!((figures.frames_per_sec.unwrap() - 1.0 / 0.007).abs() < 1e-9);
    }
}
