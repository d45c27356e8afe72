//! Receivers in batches: spheres are seen by eight at a time, directions are looked into receiver by receiver.

mod batch;
mod gloss;
mod shader;

pub(crate) use shader::{GlossTables, Shader};

use batch::Batch;
use halfshade_scene::{RadianceMut, Receivers};
use halfshade_strategy::Prepared;

impl Prepared for Shader<'_> {
    fn shade(&self, receivers: Receivers<'_>, mut out: RadianceMut<'_>) {
        let mut batch = Batch::new(self);
        for start in (0..receivers.len()).step_by(8) {
            let end = (start + 8).min(receivers.len());
            batch.shade(receivers, start..end, &mut out);
        }
    }
}
