//! The triangles of one mesh, for rays.

use crate::{
    binary::around,
    block::{Block, BlockRay},
    ray::Ray,
    space::Space,
    triangle::Crossing,
    wide_hierarchy::{BoxRay, WideHierarchy},
};
use glam::Vec3;

/// Triangles of a leaf.
const MOST_IN_LEAF: usize = 8;

/// Triangles in a hierarchy of boxes. Both faces of a triangle are met.
///
/// Watertight: a ray meets one of two triangles that share an edge or a vertex it is aimed at. What is met is found in double
/// precision; single precision only leaves out what can't be.
#[derive(Debug, Clone)]
pub struct MeshRays {
    hierarchy: WideHierarchy,
    /// By the codes of leaves.
    blocks: Vec<Block>,
    space: Space,
    bounds: Option<[Vec3; 2]>,
}

/// The corners of a triangle, if it has three that are finite.
fn corners_of(positions: &[Vec3], triangle: [u32; 3]) -> Option<[Vec3; 3]> {
    let corners = triangle.map(|vertex| positions.get(vertex as usize).copied().unwrap_or(Vec3::NAN));
    corners.iter().all(|corner| corner.is_finite()).then_some(corners)
}

impl MeshRays {
    /// For triangles with these vertices. One with a vertex that isn't finite, or isn't there, is met by no ray.
    pub fn new(positions: &[Vec3], triangles: &[[u32; 3]]) -> Self {
        let known: Vec<(u32, [Vec3; 3])> = (triangles.iter().enumerate())
            .filter_map(|(number, triangle)| Some((number as u32, corners_of(positions, *triangle)?)))
            .collect();
        let bounds = around(known.iter().flat_map(|(_, corners)| *corners).map(|corner| [corner; 2]));
        let space = Space::around(bounds);
        let placed = |corners: [Vec3; 3]| corners.map(|corner| space.place(corner.as_dvec3()).as_vec3());
        let known: Vec<(u32, [Vec3; 3])> =
            known.into_iter().map(|(number, corners)| (number, placed(corners))).collect();
        let boxes: Vec<[Vec3; 2]> = known.iter().map(|(_, [a, b, c])| [a.min(*b).min(*c), a.max(*b).max(*c)]).collect();
        let mut blocks = Vec::new();
        let hierarchy = WideHierarchy::new(&boxes, MOST_IN_LEAF, |slots| {
            blocks.push(Block::new(slots.iter().map(|&slot| known[slot as usize])));
            (blocks.len() - 1) as u32
        });
        Self { hierarchy, blocks, space, bounds }
    }

    /// Moves the triangles to where their vertices are now. Their hierarchy is kept, and fits less well the more they move
    /// apart.
    pub fn refit(&mut self, positions: &[Vec3], triangles: &[[u32; 3]]) {
        let corners = triangles.iter().filter_map(|&triangle| corners_of(positions, triangle));
        self.bounds = around(corners.flatten().map(|corner| [corner; 2]));
        self.space = Space::around(self.bounds);
        for block in &mut self.blocks {
            for lane in 0..block.count {
                let triangle = triangles.get(block.triangles[lane] as usize);
                let corners = triangle.and_then(|&triangle| corners_of(positions, triangle));
                let placed = |corners: [Vec3; 3]| corners.map(|corner| self.space.place(corner.as_dvec3()).as_vec3());
                block.set(lane, corners.map(placed));
            }
        }
        self.hierarchy.refit(|leaf| self.blocks[leaf as usize].bounds());
    }

    /// Low and high corner of the box around the triangles; `None` if no ray meets any.
    pub fn bounds(&self) -> Option<[Vec3; 2]> {
        self.bounds
    }

    /// Half the largest extent, give or take a factor of two.
    pub fn half_extent(&self) -> f64 {
        self.space.length_outside(1.0)
    }

    /// Whether `counts` says so of any triangle that the ray crosses; they come in no particular order, and no more after the
    /// first that counts.
    #[inline]
    pub fn any(&self, ray: &Ray, mut counts: impl FnMut(&Crossing) -> bool) -> bool {
        let Some((ray, skipped)) = self.space.place_ray(ray) else { return false };
        let block_ray = BlockRay::new(ray);
        self.hierarchy.any(&BoxRay::new(&ray), |leaf| {
            let block = &self.blocks[leaf as usize];
            block.any(&block_ray, |crossing| counts(&self.outside(crossing, skipped)))
        })
    }

    /// The first triangle along the ray that counts.
    #[inline]
    pub fn closest(&self, ray: &Ray, mut counts: impl FnMut(&Crossing) -> bool) -> Option<Crossing> {
        let (ray, skipped) = self.space.place_ray(ray)?;
        let (mut box_ray, block_ray) = (BoxRay::new(&ray), BlockRay::new(ray));
        let (mut limit, mut closest) = (ray.limit, None);
        self.hierarchy.nearest(&mut box_ray, |leaf, box_ray| {
            self.blocks[leaf as usize].any(&block_ray, |crossing| {
                let outside = self.outside(crossing, skipped);
                if crossing.distance < limit && counts(&outside) {
                    limit = crossing.distance;
                    closest = Some(outside);
                }
                false
            });
            box_ray.shorten(limit);
        });
        closest
    }

    /// Memory that it takes.
    pub fn bytes(&self) -> usize {
        size_of_val(self.blocks.as_slice()) + self.hierarchy.bytes()
    }

    /// A crossing with its distance as it is outside of the space of the mesh.
    #[inline(always)]
    fn outside(&self, crossing: Crossing, skipped: f64) -> Crossing {
        crossing.with_distance(self.space.length_outside(crossing.distance + skipped))
    }
}
