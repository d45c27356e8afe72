//! Visibility past the receivers' own object, interpolated between vertices and turned into light space.

use super::OwnSpheres;
use crate::{
    sh_exp::{
        bake::own::{OwnTables, OwnVectors},
        prepare::own::OwnView,
    },
    shared::{
        rotate::{rotated, visible},
        vector::dot,
        vertex_vectors::interpolated,
    },
};
use halfshade_scene::{Mesh, SurfacePoint, light::OctahedralGrid};
use halfshade_sh::kernel::ShBatch;
use wide::f32x8;

/// An object as its own receivers see it.
pub(crate) struct OwnOcclusion<'a> {
    mesh: &'a Mesh,
    /// Per vertex what is blocked, in object space; empty if nothing is.
    vectors: &'a [f32],
    /// Blocks of the rotation into light space.
    rotation: &'a [f32],
    /// Per vertex a bit per node of the grid of directions in object space, 1 where the mesh hides it; empty where no lamp asks, or
    /// nothing is hidden.
    hidden: &'a [u32],
    grid: &'a OctahedralGrid,
    /// Rows of the rotation from light space.
    object_from_light: &'a [[f32; 3]; 3],
    pub(crate) spheres: OwnSpheres,
}

impl<'a> OwnOcclusion<'a> {
    /// Own occlusion of an object; `None` if its spheres stand for it.
    pub(crate) fn of(tables: &'a OwnTables, view: &'a OwnView, object: u32) -> Option<Self> {
        let number = object as usize;
        let OwnVectors { mesh, values, hidden } = tables.of(number)?;
        Some(Self {
            mesh,
            vectors: values,
            rotation: &view.rotations[number],
            hidden,
            grid: &tables.grid,
            object_from_light: &view.object_from_light[number],
            spheres: view.spheres[number],
        })
    }

    /// The mask of the receivers that know what their own object hides; and visibility past it if it hides anything, 1 in
    /// the other lanes.
    #[inline(always)]
    pub(crate) fn visibility<const N: usize>(
        &self,
        surface: impl Fn(usize) -> SurfacePoint,
    ) -> (f32x8, Option<ShBatch<N>>) {
        if self.vectors.is_empty() {
            let known = |lane| f32::from(u8::from(surface(lane).weights_in_front(self.mesh).is_some()));
            return (f32x8::from(std::array::from_fn::<f32, 8, _>(known)).simd_gt(f32x8::ZERO), None);
        }
        let (blocked, known) = interpolated::<N>(self.mesh, self.vectors, surface);
        (known, Some(visible(&rotated(&blocked, self.rotation))))
    }

    /// How much the own object leaves of a small light along `direction`, receiver by receiver; 1 where that isn't known.
    #[inline(never)]
    pub(crate) fn open(&self, direction: &[f32x8; 3], surface: impl Fn(usize) -> SurfacePoint) -> f32x8 {
        if self.hidden.is_empty() {
            return f32x8::ONE;
        }
        let in_object = self.object_from_light.map(|row| dot(&row.map(f32x8::splat), direction));
        let (nodes, weights) = self.grid.lookup_batch(&in_object);
        let weights = weights.map(f32x8::to_array);
        let words = self.grid.node_count().div_ceil(32);
        f32x8::from(std::array::from_fn::<f32, 8, _>(|lane| {
            let Some(between) = surface(lane).weights_in_front(self.mesh) else { return 1.0 };
            let hidden = |vertex: usize, corner: usize| {
                let node = nodes[corner][lane] as usize;
                weights[corner][lane] * ((self.hidden[vertex * words + node / 32] >> (node % 32)) & 1) as f32
            };
            let of_vertex = |(vertex, weight): (usize, f32)| weight * (0..3).map(|k| hidden(vertex, k)).sum::<f32>();
            1.0 - between.parts().map(of_vertex).sum::<f32>()
        }))
    }
}
