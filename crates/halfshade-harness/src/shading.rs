//! Calling strategies: all of them split and threaded the same way.

use halfshade_scene::{RadianceBuffer, RadianceMut, Receivers};
use halfshade_strategy::Baked;

/// Receivers per call: enough to fill the vector units many times over, few enough to share out among threads.
pub const CHUNK: usize = 1024;

/// Shades all receivers, in chunks that the threads of the current pool share.
pub fn shade_all(baked: &dyn Baked, receivers: Receivers<'_>, out: &mut RadianceBuffer) {
    shade(baked, receivers, out.view_mut());
}

fn shade(baked: &dyn Baked, receivers: Receivers<'_>, out: RadianceMut<'_>) {
    let count = receivers.len();
    if count <= CHUNK {
        return baked.shade(receivers, out);
    }
    let middle = count.div_ceil(2).next_multiple_of(CHUNK).min(count - 1);
    let (left, right) = out.split_at(middle);
    rayon::join(
        || shade(baked, receivers.slice(0..middle), left),
        || shade(baked, receivers.slice(middle..count), right),
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
    use halfshade_strategy::Params;

    #[test]
    fn every_receiver_is_shaded_once_however_many_there_are() {
        let scene = Scene::at_rest("empty", Vec::new(), Environment::constant(Vec3::ONE));
        let strategy = &toy::strategies()[0];
        let params = Params::defaults(&strategy.info().parameters);
        let baked = strategy.bake(&scene, &params, &Silent).unwrap();
        for count in [0, 1, CHUNK - 1, CHUNK, CHUNK + 1, 2 * CHUNK + 1, 5 * CHUNK - 3] {
            let mut receivers = ReceiverBuffer::default();
            for i in 0..count {
                receivers.push(Vec3::ZERO, Vec3::Y, Vec3::splat(i as f32), 0);
            }
            let mut out = RadianceBuffer { channels: std::array::from_fn(|_| vec![f32::NAN; count]) };
            shade_all(baked.as_ref(), receivers.view(), &mut out);
            assert_eq!(out.channels, receivers.albedo);
        }
    }
}
