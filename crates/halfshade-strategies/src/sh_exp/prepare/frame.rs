//! Frame data: everything that shading reads of a frame.

use super::{
    cuts::Cuts, emitters::SamplePoints, ground::GroundView, light::FrameLight, own::OwnView, state::FrameState,
};
use crate::{
    sh_exp::kernel::gather::RadianceVectors,
    shared::{light_space::LightSpace, placed_lamps::Lamp},
};
use glam::{DMat3, DQuat};
use halfshade_scene::light::is_grey;

/// Spheres and light of a frame.
#[derive(Debug)]
pub(crate) struct FrameData {
    pub(crate) light: FrameLight,
    /// Lights that are handled apart, in light space.
    pub(crate) lamps: Vec<Lamp>,
    pub(crate) space: LightSpace,
    /// A space that turns with the blockers, from light space.
    pub(crate) blockers_from_light: DMat3,
    pub(crate) cuts: Cuts,
    /// How each sphere of every level has turned within its object since rest.
    pub(crate) turns: Vec<DQuat>,
    /// Radiance of every sphere; dark if nothing reflects.
    pub(crate) radiance: RadianceVectors,
    /// Points where light is gathered for the spheres.
    pub(crate) points: SamplePoints,
    /// Objects without spheres as the others see them, if they are to be seen.
    pub(crate) ground: Option<GroundView>,
    /// Objects as they are turned, if their meshes tell what they hide from themselves.
    pub(crate) own: OwnView,
    /// The state that all this was made for; `None` if it is not finished.
    pub(crate) state: Option<FrameState>,
}

impl FrameData {
    /// Under `light`, without objects.
    pub(crate) fn new(light: FrameLight) -> Self {
        Self {
            light,
            lamps: Vec::new(),
            space: LightSpace::default(),
            blockers_from_light: DMat3::IDENTITY,
            cuts: Cuts::default(),
            turns: Vec::new(),
            radiance: RadianceVectors::default(),
            points: SamplePoints::default(),
            ground: None,
            own: OwnView::default(),
            state: None,
        }
    }

    /// Whether no light has a colour.
    pub(crate) fn is_grey(&self) -> bool {
        self.light.by_normal.is_grey() && self.lamps.iter().all(|lamp| is_grey(lamp.radiance))
    }
}
