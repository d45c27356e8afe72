//! Receivers in batches [Meunier2009, 4.3, 5.3 and 5.4]: spheres in the way of each light, their mask, the sum of integrals.

mod counts;
mod receivers;
mod reflectance;
mod shared_masks;
mod stages;
mod surroundings;
mod visibility;

use super::{bake::tables::Tables, prepare::frame::FrameData, settings::Settings};
pub(super) use counts::Counters;
use halfshade_scene::{RadianceMut, Receivers};
use halfshade_strategy::Prepared;
use receivers::Shading;
pub use stages::Stage;
use stages::{Once, Twice};

/// A frame ready to be shaded.
pub(super) struct Shader<'a> {
    pub(super) settings: &'a Settings,
    pub(super) tables: &'a Tables,
    pub(super) frame: &'a FrameData,
    pub(super) counters: &'a Counters,
    /// A stage that runs twice.
    pub(super) repeated: Option<Stage>,
}

impl Prepared for Shader<'_> {
    fn shade(&self, receivers: Receivers<'_>, out: RadianceMut<'_>) {
        let Self { settings, tables, frame, counters, .. } = self;
        counters.add(&match self.repeated {
            None => Shading::new(settings, tables, frame, Once).run(receivers, out),
            Some(stage) => Shading::new(settings, tables, frame, Twice(stage)).run(receivers, out),
        });
    }
}
