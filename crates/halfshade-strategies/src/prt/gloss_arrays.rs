//! Matrices of glossy transfer as plain arrays, for kernels that run elsewhere than on the processor.

use super::{BakedScene, bake::hemisphere::Hemisphere, shade::place::Place};
use glam::{Mat3, Vec3};
use halfshade_scene::{Frame, Receivers};

/// Everything of gloss that holds for all frames of a scene.
#[derive(Debug, Clone, Copy)]
pub struct GlossArrays<'a> {
    /// Fits of lobes, of models with a cosine and of those without, as `halfshade_sh::hemisphere` gives them.
    pub fits: &'a [Vec<f32>; 2],
    /// Normal and tangent of the frame of each matrix.
    pub frames: &'a [[Vec3; 2]],
    /// Matrices of bands² rows of as many numbers, as many for each frame as there are vectors to a row.
    pub matrices: &'a [f32],
}

/// Where a receiver lies between matrices.
#[derive(Debug, Clone, PartialEq)]
pub enum GlossPlace {
    /// Nothing is reflected beside the diffuse part.
    Dull,
    /// Between three matrices with the weights of its vectors, and which fit there is of its lobes.
    Between([usize; 3], usize),
    /// A matrix of its own: one as if nothing hid any light.
    Own([Vec3; 2], Vec<f32>, usize),
}

impl BakedScene {
    /// Gloss of the scene, if anything is glossy.
    pub fn gloss_arrays(&self) -> Option<GlossArrays<'_>> {
        let (table, lobes) = self.transfer.gloss.as_ref().zip(self.lobes.as_ref())?;
        let matrices = &table.values[..table.values.len() - super::kernel::dot::PADDING];
        Some(GlossArrays { fits: &lobes.fits, frames: &table.frames, matrices })
    }

    /// The rotation from the world at the frame that was prepared last into the space of vectors and matrices.
    pub fn baked_from_world(&self) -> Mat3 {
        self.light.baked_from_world
    }

    /// Where receiver `i` lies between matrices, given where it lies between vectors.
    pub fn gloss_place(&self, frame: &Frame<'_>, receivers: &Receivers<'_>, i: usize, place: &Place) -> GlossPlace {
        let rows = self.transfer.gloss.as_ref().and_then(|table| table.objects.get(receivers.object[i] as usize));
        let (Some(rows), Some(lobes)) = (rows.and_then(Option::as_ref), &self.lobes) else { return GlossPlace::Dull };
        match place {
            Place::Dark => GlossPlace::Dull,
            Place::Between(between) => GlossPlace::Between(between.map(|(row, _)| rows.at(row)), rows.weight as usize),
            Place::Open => {
                let turn = self.arrangement.baked_from_world(&frame.world_from_object);
                let normal = (turn * receivers.normal_at(i).as_dvec3()).as_vec3();
                let own = Hemisphere::frame(Vec3::ZERO, normal);
                let matrix = lobes.open_matrix(rows.weight, self.transfer.bands, &own);
                GlossPlace::Own([own.z_axis, own.x_axis].map(|axis| axis.as_vec3()), matrix, rows.weight as usize)
            }
        }
    }
}
