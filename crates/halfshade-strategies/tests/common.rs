//! The phases of a strategy, for tests.

use halfshade_scene::{Frame, RadianceBuffer, ReceiverBuffer, Scene, progress::Silent};
use halfshade_strategy::{Baked, Strategy};

/// `strategy` baked for `scene`.
pub(crate) fn baked(strategy: &dyn Strategy, scene: &Scene, settings: &str) -> Box<dyn Baked> {
    let params = strategy.info().parse(settings).unwrap();
    strategy.bake(scene, &params, &Silent).unwrap()
}

/// The receivers of `frame`, prepared and shaded.
pub(crate) fn shade(baked: &mut dyn Baked, frame: &Frame<'_>, receivers: &ReceiverBuffer) -> RadianceBuffer {
    baked.place_receivers(frame, receivers.view()).unwrap();
    let prepared = baked.prepare(frame).unwrap();
    let mut out = RadianceBuffer::zeros(receivers.len());
    prepared.shade(receivers.view(), out.view_mut());
    out
}

/// The receivers of `frame`, by a strategy baked for `scene`.
pub(crate) fn shaded(
    strategy: &dyn Strategy,
    scene: &Scene,
    frame: &Frame<'_>,
    receivers: &ReceiverBuffer,
    settings: &str,
) -> RadianceBuffer {
    shade(baked(strategy, scene, settings).as_mut(), frame, receivers)
}
