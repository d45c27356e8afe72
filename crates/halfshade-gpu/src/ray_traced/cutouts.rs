//! Holes in meshes, as `ray_traced/cutout.wgsl` reads them.

use crate::rows::{Row, fours};
use glam::Vec3;
use halfshade_scene::{
    Mesh, Scene, Texture,
    mesh::AlphaMask,
    texture::{Filter, Wrap},
};
use std::sync::Arc;

/// By triangle of a mesh the row at which its holes begin, 0 for a whole one; empty where all are whole.
pub(super) type Holes = Arc<[u32]>;

/// Adds the holes of all meshes, each mesh and each texture once.
pub(super) fn add_holes(rows: &mut Vec<Row>, scene: &Scene) -> Vec<Holes> {
    let mut meshes: Vec<(&Arc<Mesh>, Holes)> = Vec::new();
    let mut textures = Vec::new();
    let of_object = |mesh| {
        if let Some((_, holes)) = meshes.iter().find(|(known, _)| Arc::ptr_eq(known, mesh)) {
            return holes.clone();
        }
        let holes: Holes = holes_of(rows, &mut textures, mesh).into();
        meshes.push((mesh, holes.clone()));
        holes
    };
    scene.objects.iter().map(|object| &object.mesh).map(of_object).collect()
}

/// Textures that have rows already, and where those begin.
type Known<'a> = Vec<(&'a Arc<Texture>, u32)>;

fn holes_of<'a>(rows: &mut Vec<Row>, textures: &mut Known<'a>, mesh: &'a Mesh) -> Vec<u32> {
    let masks: Vec<(&AlphaMask, u32)> = mesh.masks.iter().map(|mask| (mask, add_mask(rows, textures, mask))).collect();
    if masks.is_empty() {
        return Vec::new();
    }
    let row_of = |triangle: usize| {
        let own = mesh.mask_of(triangle)?;
        let (_, mask) = masks.iter().find(|(mask, _)| std::ptr::eq(*mask, own))?;
        Some(add_corners(rows, mesh, triangle, *mask))
    };
    (0..mesh.triangles.len()).map(row_of).map(Option::unwrap_or_default).collect()
}

/// Adds alpha and texture coordinates of a triangle's corners.
fn add_corners(rows: &mut Vec<Row>, mesh: &Mesh, triangle: usize, mask: u32) -> u32 {
    let first = rows.len() as u32;
    let corners = mesh.triangles[triangle].map(|vertex| vertex as usize);
    let [a, b, c] = corners.map(|vertex| mesh.coverage[vertex].x.to_bits());
    rows.push([a, b, c, mask]);
    let place = |vertex: usize| mesh.texture_coordinates.get(vertex).map_or(Vec3::ZERO, |place| *place);
    rows.extend(fours(corners.map(place).iter().flat_map(|place| [place.x, place.y].map(f32::to_bits))));
    first
}

/// Adds a mask, and its texture if it is a new one.
fn add_mask<'a>(rows: &mut Vec<Row>, textures: &mut Known<'a>, mask: &'a AlphaMask) -> u32 {
    let cutoff = mask.cutoff.to_bits();
    let Some(texture) = &mask.texture else {
        rows.extend([[cutoff, 0, 0, 0], [0; 4]]);
        return rows.len() as u32 - 2;
    };
    let known = textures.iter().find(|(known, _)| Arc::ptr_eq(known, texture)).map(|(_, row)| *row);
    let texels = known.unwrap_or_else(|| {
        let first = rows.len() as u32;
        rows.extend(fours(texture.texels().iter().map(|texel| texel.x.to_bits())));
        textures.push((texture, first));
        first
    });
    let [wrap_u, wrap_v] = texture.wrap().map(|wrap| match wrap {
        Wrap::Repeat => 0,
        Wrap::Mirror => 1,
        Wrap::Clamp => 2,
    });
    let is_nearest = u32::from(texture.filter() == Filter::Nearest);
    rows.push([cutoff, texels, texture.width() as u32, texture.height() as u32]);
    rows.push([wrap_u, wrap_v, is_nearest, 0]);
    rows.len() as u32 - 2
}
