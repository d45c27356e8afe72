//! All that shading reads.

use crate::{
    mask::{
        bake::{directions::DirectionSets, lobe_light::LobeLight, own::OwnMesh},
        kernel::{lamp::Spiral, lobe::LobeSpiral, own::OwnView},
        prepare::frame::FrameData,
    },
    shared::irradiance::Irradiance,
};
use halfshade_scene::{Lobe, Receivers, lobe::Lobes, spheres::AdjustRule};
use std::sync::Arc;

/// A frame ready to be shaded.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Shader<'a> {
    pub(crate) frame: &'a FrameData,
    pub(crate) sets: &'a DirectionSets,
    /// Places on each lamp.
    pub(crate) spiral: &'a Spiral,
    /// Directions that each object's mesh hides from itself, if they are known.
    pub(crate) own: &'a [Option<Arc<OwnMesh>>],
    /// Irradiance of everything but lamps.
    pub(crate) rest: &'a Irradiance,
    pub(crate) rule: AdjustRule,
    /// Where anything is glossy.
    pub(crate) gloss: Option<&'a GlossTables>,
    /// Width of an edge in radii of a direction's cell.
    pub(crate) edge: f32,
}

/// Tables for glossy reflectance.
#[derive(Debug, Clone)]
pub(crate) struct GlossTables {
    /// Directions of each lobe.
    pub(crate) spiral: LobeSpiral,
    /// Everything but lamps.
    pub(crate) light: LobeLight,
}

impl Shader<'_> {
    /// The lobes that a receiver shows to the eye, in light space.
    pub(super) fn lobes_of(&self, receivers: &Receivers<'_>, i: usize) -> Lobes {
        let mut turned = Lobes::NONE;
        let Some(lobes) = &self.frame.eye_lobes else { return turned };
        for lobe in lobes.at(receivers, i).iter() {
            turned.push(Lobe { axis: self.frame.space.direction(lobe.axis), ..*lobe });
        }
        turned
    }

    /// Directions that a receiver's own object hides, if they are known where it lies.
    pub(super) fn own_view(&self, receivers: &Receivers<'_>, i: usize) -> Option<OwnView<'_>> {
        let object = receivers.object[i] as usize;
        let own = self.own.get(object)?.as_ref()?;
        let weights = receivers.surface[i].weights_in_front(&own.mesh)?;
        let mut vertices = [(0, 0.0); 3];
        let (mut open_weight, mut count) = (0.0, 0);
        for (place, (vertex, weight)) in vertices.iter_mut().zip(weights.parts()) {
            let is_open = own.cells.is_all_open(vertex);
            if is_open {
                open_weight += weight;
            } else {
                *place = (vertex as u32, weight);
                count += 1;
            }
        }
        if count == 0 {
            open_weight = 1.0;
        }
        let object_from_light = *self.frame.object_from_light.get(object)?;
        Some(OwnView { cells: &own.cells, vertices, open_weight, object_from_light })
    }
}
