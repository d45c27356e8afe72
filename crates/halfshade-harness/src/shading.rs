//! Calling strategies: all of them split and threaded the same way.

use halfshade_scene::{Frame, RadianceBuffer, RadianceMut, Receivers};
use halfshade_strategy::{Baked, Batching, Prepared, StrategyError};

/// Receivers per call: enough to fill the vector units many times over, few enough to share out among threads.
pub const CHUNK: usize = 1024;

/// Shades all receivers: in chunks that the threads of the current pool share, or in one call for who asks for it.
pub fn shade_all(prepared: &dyn Prepared, receivers: Receivers<'_>, out: &mut RadianceBuffer) {
    match prepared.batching() {
        Batching::AnySplit => shade(prepared, receivers, out.view_mut()),
        Batching::WholeFrame => prepared.shade(receivers, out.view_mut()),
    }
}

/// Radiance of all receivers of a frame, prepared, shaded and read back.
pub fn shade_frame(
    baked: &mut dyn Baked,
    frame: &Frame<'_>,
    receivers: Receivers<'_>,
) -> Result<RadianceBuffer, StrategyError> {
    baked.place_receivers(frame, receivers)?;
    let prepared = baked.prepare(frame)?;
    let mut radiance = RadianceBuffer::zeros(receivers.len());
    shade_all(prepared.as_ref(), receivers, &mut radiance);
    prepared.read_back(radiance.view_mut())?;
    Ok(radiance)
}

fn shade(prepared: &dyn Prepared, receivers: Receivers<'_>, out: RadianceMut<'_>) {
    let count = receivers.len();
    if count <= CHUNK {
        return prepared.shade(receivers, out);
    }
    let middle = count.div_ceil(2).next_multiple_of(CHUNK).min(count - 1);
    let (left, right) = out.split_at(middle);
    rayon::join(
        || shade(prepared, receivers.slice(0..middle), left),
        || shade(prepared, receivers.slice(middle..count), right),
    );
}

/// How many values are not finite.
pub fn count_not_finite(radiance: &RadianceBuffer) -> usize {
    radiance.channels.iter().flatten().filter(|value| !value.is_finite()).count()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::toy;
    use glam::Vec3;
    use halfshade_scene::{Environment, ReceiverBuffer, Scene, progress::Silent};

    #[test]
    fn every_receiver_is_shaded_once_however_many_there_are() {
        let scene = Scene::at_rest("empty", Vec::new(), Environment::constant(Vec3::ONE));
        let strategy = &toy::strategies()[0];
        let mut baked = strategy.bake(&scene, &strategy.info().defaults(), &Silent).unwrap();
        let prepared = baked.prepare(&scene.frame(0)).unwrap();
        for count in [0, 1, CHUNK - 1, CHUNK, CHUNK + 1, 2 * CHUNK + 1, 5 * CHUNK - 3] {
            let mut receivers = ReceiverBuffer::default();
            for i in 0..count {
                receivers.push(Vec3::ZERO, Vec3::Y, Vec3::splat(i as f32), 0);
            }
            let mut out = RadianceBuffer { channels: std::array::from_fn(|_| vec![f32::NAN; count]) };
            shade_all(prepared.as_ref(), receivers.view(), &mut out);
            assert_eq!(out.channels, receivers.albedo);
        }
    }

    /// Answers how many receivers its call had.
    struct Counting(Batching);

    impl Prepared for Counting {
        fn batching(&self) -> Batching {
            self.0
        }

        fn shade(&self, receivers: Receivers<'_>, mut out: RadianceMut<'_>) {
            (0..receivers.len()).for_each(|i| out.set(i, Vec3::splat(receivers.len() as f32)));
        }
    }

    #[test]
    fn who_asks_for_the_whole_frame_gets_it_in_one_call() {
        let count = 3 * CHUNK + 5;
        let mut receivers = ReceiverBuffer::default();
        (0..count).for_each(|_| receivers.push(Vec3::ZERO, Vec3::Y, Vec3::ONE, 0));
        let largest = |batching| {
            let mut out = RadianceBuffer::zeros(count);
            shade_all(&Counting(batching), receivers.view(), &mut out);
            out.channels[0].iter().copied().fold(0.0, f32::max)
        };
        assert_eq!(largest(Batching::WholeFrame), count as f32);
        assert!(largest(Batching::AnySplit) <= CHUNK as f32);
    }
}
