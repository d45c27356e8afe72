//! Directions that each mesh hides from its own vertices, by rays, once per scene.

use crate::{
    mask::kernel::own::{OpenCells, cell_direction, words_of},
    shared::{
        by_mesh::ByMesh,
        triangle_rays::{Start, TriangleRays},
    },
};
use glam::Vec3;
use halfshade_scene::{Mesh, Object, Progress, Scene};
use rayon::prelude::*;
use std::sync::Arc;

/// A mesh and the cells that are open from its vertices.
#[derive(Debug, Clone)]
pub(crate) struct OwnMesh {
    pub(crate) mesh: Arc<Mesh>,
    pub(crate) cells: OpenCells,
}

/// The meshes of all objects, those of one mesh sharing one; `None` for what deforms: nothing that was traced at rest holds
/// there.
pub(crate) fn own_meshes(scene: &Scene, side: usize, progress: &dyn Progress) -> Vec<Option<Arc<OwnMesh>>> {
    progress.start("directions that meshes hide from themselves", scene.objects.len() as u64);
    let mut meshes = ByMesh::new();
    let of = |object: &Object| {
        progress.advance(1);
        meshes.of_rigid(object, |mesh| OwnMesh { mesh: mesh.clone(), cells: open_cells(mesh, side) })
    };
    scene.objects.iter().map(of).collect()
}

fn open_cells(mesh: &Mesh, side: usize) -> OpenCells {
    let rays = TriangleRays::new(mesh);
    let directions: Vec<Vec3> = (0..side * side).map(|cell| cell_direction(side, cell)).collect();
    let per_vertex = words_of(side);
    // Open, too, is what no receiver between vertices looks into.
    let mut words = vec![u32::MAX; per_vertex * mesh.positions.len()];
    words.par_chunks_mut(per_vertex).enumerate().for_each(|(vertex, words)| {
        let (position, normal) = (mesh.positions[vertex], mesh.normals[vertex]);
        let start = Start::on_surface(position, normal);
        for (cell, &direction) in directions.iter().enumerate() {
            let Some(direction) = above(direction, normal) else { continue };
            if rays.blocked(&start, direction, f32::INFINITY) {
                words[cell / 32] &= !(1 << (cell % 32));
            }
        }
    });
    OpenCells { side, words }
}

/// How far below a vertex's horizon a direction may be above that of a point between vertices.
const DEEPEST: f32 = 0.35;

/// A direction, or the one at the horizon that is nearest to it: between vertices that bulge it may be open. `None` far below.
fn above(direction: Vec3, normal: Vec3) -> Option<Vec3> {
    const LEAST: f32 = 0.02;
    let cosine = direction.dot(normal);
    match () {
        () if cosine >= LEAST => Some(direction),
        () if cosine > -DEEPEST => (direction + (LEAST - cosine) * normal).try_normalize(),
        () => None,
    }
}
