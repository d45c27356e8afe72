//! Hierarchies of meshes, and the one over objects.

use super::cutouts::Holes;
use crate::{
    GpuError,
    hierarchy::{Hierarchy, MOST_IN_LEAF, Node, STACK},
    receivers::{KernelSpace, affine_rows},
};
use bytemuck::{Pod, Zeroable};
use glam::{DMat3, DVec3, Vec3};
use halfshade_rays::binary::around;
use halfshade_scene::{Frame, Mesh, Pose};
use std::sync::Arc;

/// Corners in the space of the object, as `ray_traced/frame.wgsl` reads them.
#[repr(C)]
#[derive(Debug, Clone, Copy, Pod, Zeroable)]
pub struct DeviceTriangle {
    pub(crate) a: [f32; 3],
    pub(crate) holes: u32,
    pub(crate) b: [f32; 3],
    pub(crate) padding: u32,
    pub(crate) c: [f32; 3],
    pub(crate) more_padding: u32,
}

/// The hierarchy of one mesh within the buffers.
#[derive(Debug, Clone, Copy)]
pub(super) struct Placed {
    first_node: usize,
    depth: usize,
    /// Corners of its box; `None` if nothing of it can be met.
    bounds: Option<[Vec3; 2]>,
}

/// Hierarchies and triangles of all meshes, as they are on the device; before them room for the hierarchy over objects.
#[derive(Default)]
pub(super) struct Meshes {
    pub(super) nodes: Vec<Node>,
    pub(super) triangles: Vec<DeviceTriangle>,
    /// Those of each object.
    pub(super) of_object: Vec<Placed>,
    pub(super) is_deformed: bool,
}

impl Meshes {
    /// All that a frame shows, with the holes in the mesh of each object.
    pub(super) fn of(frame: &Frame<'_>, holes: &[Holes]) -> Self {
        let objects = &frame.scene.objects;
        let mut meshes = Self {
            nodes: vec![Node::zeroed(); room_for_objects(objects.len())],
            is_deformed: frame.deformed.iter().any(Option::is_some),
            ..Self::default()
        };
        let mut known: Vec<(&Arc<Mesh>, Placed)> = Vec::new();
        for (number, (object, holes)) in objects.iter().zip(holes).enumerate() {
            let shared = known.iter().find(|(mesh, _)| object.skin.is_none() && Arc::ptr_eq(mesh, &object.mesh));
            let placed = match shared {
                Some((_, placed)) => *placed,
                None => {
                    let placed = meshes.add(&object.mesh, frame.positions(number), holes);
                    if object.skin.is_none() {
                        known.push((&object.mesh, placed));
                    }
                    placed
                }
            };
            meshes.of_object.push(placed);
        }
        meshes
    }

    fn add(&mut self, mesh: &Mesh, positions: &[Vec3], holes: &[u32]) -> Placed {
        let (first_node, first_triangle) = (self.nodes.len(), self.triangles.len());
        let corners = mesh.triangles.iter().map(|triangle| triangle.map(|vertex| positions[vertex as usize]));
        let holes = holes.iter().copied().chain(std::iter::repeat(0));
        let triangles: Vec<([Vec3; 3], u32)> =
            corners.zip(holes).filter(|(corners, _)| corners.iter().all(|corner| corner.is_finite())).collect();
        let boxes: Vec<[Vec3; 2]> =
            triangles.iter().map(|([a, b, c], _)| [a.min(*b).min(*c), a.max(*b).max(*c)]).collect();
        let bounds = around(boxes.iter().copied());
        let padding = bounds.map_or(0.0, padding_of);
        let padded: Vec<[Vec3; 2]> = boxes.iter().map(|corners| widened(*corners, padding)).collect();
        let hierarchy = Hierarchy::new(&padded, MOST_IN_LEAF);
        self.nodes.extend(hierarchy.nodes.iter().map(|node| moved(node, first_node, first_triangle)));
        self.triangles.extend(hierarchy.order.iter().map(|&slot| {
            let (corners, holes) = triangles[slot as usize];
            let [a, b, c] = corners.map(|corner| corner.to_array());
            DeviceTriangle { a, holes, b, padding: 0, c, more_padding: 0 }
        }));
        let bounds = bounds.map(|corners| widened(corners, padding));
        Placed { first_node, depth: hierarchy.depth, bounds }
    }

    /// Hierarchy over objects where they are, and a row of four for each, in the order of its leaves.
    pub(super) fn instances(&mut self, frame: &Frame<'_>, space: &KernelSpace) -> Result<Vec<[[u32; 4]; 4]>, GpuError> {
        let placed: Vec<(usize, [Vec3; 2])> = (self.of_object.iter().zip(&frame.world_from_object).enumerate())
            .filter_map(|(number, (placed, pose))| Some((number, placed_box(placed.bounds?, pose, space)?)))
            .collect();
        let boxes: Vec<[Vec3; 2]> = placed.iter().map(|(_, corners)| *corners).collect();
        let hierarchy = Hierarchy::new(&boxes, 1);
        let deepest = self.of_object.iter().map(|placed| placed.depth).max().unwrap_or(0);
        if hierarchy.depth + deepest + 1 > STACK {
            let problem = format!("hierarchies of {} levels, of {STACK} at most", hierarchy.depth + deepest);
            return Err(GpuError::Refused(problem));
        }
        self.nodes[..hierarchy.nodes.len()].copy_from_slice(&hierarchy.nodes);
        let row = |slot: &u32| {
            let number = placed[*slot as usize].0;
            let [x, y, z] = object_from_kernel(&frame.world_from_object[number], space);
            [
                x.map(f32::to_bits),
                y.map(f32::to_bits),
                z.map(f32::to_bits),
                [self.of_object[number].first_node as u32, 0, 0, 0],
            ]
        };
        Ok(hierarchy.order.iter().map(row).collect())
    }
}

/// Nodes of a hierarchy over so many objects, at most.
pub(super) fn room_for_objects(count: usize) -> usize {
    count.max(1)
}

/// A node of a mesh's own hierarchy, its children numbered as they are among all.
fn moved(node: &Node, first_node: usize, first_triangle: usize) -> Node {
    let code = |child: u32| {
        let by = if child >> 31 == 1 { first_triangle } else { first_node };
        child + by as u32
    };
    Node { left: code(node.left), right: code(node.right), ..*node }
}

/// How much larger boxes are than what lies in them, so that rounding misses nothing.
fn padding_of([low, high]: [Vec3; 2]) -> f32 {
    16.0 * f32::EPSILON * low.abs().max(high.abs()).max_element()
}

fn widened([low, high]: [Vec3; 2], by: f32) -> [Vec3; 2] {
    [low - Vec3::splat(by), high + Vec3::splat(by)]
}

/// The box around an object's box where it is, in the space of kernels; `None` if that isn't finite.
fn placed_box([low, high]: [Vec3; 2], pose: &Pose, space: &KernelSpace) -> Option<[Vec3; 2]> {
    let corner = |k: usize| {
        let pick = |axis: usize| if k >> axis & 1 == 0 { low[axis] } else { high[axis] };
        let point = DVec3::new(f64::from(pick(0)), f64::from(pick(1)), f64::from(pick(2)));
        let world = pose.rotation.as_dquat() * (f64::from(pose.scale) * point) + pose.translation.as_dvec3();
        space.place(world).as_vec3()
    };
    let bounds = around((0..8).map(corner).map(|corner| [corner, corner]))?;
    let bounds = widened(bounds, padding_of(bounds));
    bounds.iter().all(|corner| corner.is_finite()).then_some(bounds)
}

/// Rows of the map from the space of kernels to an object's.
fn object_from_kernel(pose: &Pose, space: &KernelSpace) -> [[f32; 4]; 3] {
    let back = DMat3::from_quat(pose.rotation.as_dquat()).transpose() * f64::from(pose.scale).recip();
    let turn = back * space.rotation.transpose() * space.scale.recip();
    let offset = back * (space.center - pose.translation.as_dvec3());
    affine_rows(turn, offset)
}

/// A space in which all objects have extents near 1.
pub(super) fn space_of(frame: &Frame<'_>, meshes: &Meshes) -> KernelSpace {
    let plain = KernelSpace { rotation: DMat3::IDENTITY, center: DVec3::ZERO, scale: 1.0 };
    let boxes = meshes.of_object.iter().zip(&frame.world_from_object);
    let corners = boxes.filter_map(|(placed, pose)| placed_box(placed.bounds?, pose, &plain)).flatten();
    KernelSpace::of_points(corners.map(|corner| corner.as_dvec3()), DMat3::IDENTITY)
}
