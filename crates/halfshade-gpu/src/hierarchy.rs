//! Hierarchies of boxes for kernels: one per mesh, which stays on the device, and one over the objects of a frame.
//!
//! A node is 64 bytes and holds the boxes of its two children, so that one read decides about both
//! [Aila and Laine 2009]. A child is a node by its number, or a leaf: the highest bit, then the number of primitives less
//! one in three bits, then the first primitive.

use bytemuck::{Pod, Zeroable};
use glam::{Vec3, Vec3A};
use obvhs::{
    Boundable, BvhBuildParams,
    aabb::Aabb,
    bvh2::{Bvh2, builder::build_bvh2},
};
use std::time::Duration;

/// Most entries of a ray's stack, as the shader has them: a level of both hierarchies takes one.
pub(crate) const STACK: usize = 56;

/// Levels from which on a hierarchy is built in another way: two of them fit a stack.
const DEEP: usize = STACK / 2 - 1;

const LEAF: u32 = 1 << 31;
const COUNT_SHIFT: u32 = 28;

/// Most primitives of a leaf.
pub(crate) const MOST_IN_LEAF: u32 = 4;

/// Two children, as `ray_traced/traverse.wgsl` reads them.
#[repr(C)]
#[derive(Debug, Clone, Copy, Pod, Zeroable)]
pub struct Node {
    pub(crate) left_low: [f32; 3],
    pub(crate) left: u32,
    pub(crate) left_high: [f32; 3],
    pub(crate) right: u32,
    pub(crate) right_low: [f32; 3],
    pub(crate) padding: u32,
    pub(crate) right_high: [f32; 3],
    pub(crate) more_padding: u32,
}

/// A hierarchy: the root is node 0.
#[derive(Debug, Default)]
pub(crate) struct Hierarchy {
    pub(crate) nodes: Vec<Node>,
    /// Primitives in the order in which leaves name them.
    pub(crate) order: Vec<u32>,
    /// Levels of nodes.
    pub(crate) depth: usize,
}

struct Padded(Aabb);

impl Boundable for Padded {
    fn aabb(&self) -> Aabb {
        self.0
    }
}

impl Hierarchy {
    /// Over boxes, each from a low to a high corner, with so many primitives in a leaf at most.
    pub(crate) fn new(boxes: &[[Vec3; 2]], most_in_leaf: u32) -> Self {
        let padded: Vec<Padded> =
            boxes.iter().map(|[low, high]| Padded(Aabb::new(Vec3A::from(*low), Vec3A::from(*high)))).collect();
        if padded.is_empty() {
            return Self::default();
        }
        let bottom_up = Self::bottom_up(&padded, most_in_leaf);
        if bottom_up.depth <= DEEP { bottom_up } else { Self::by_halves(boxes) }
    }

    fn bottom_up(padded: &[Padded], most_in_leaf: u32) -> Self {
        let params =
            BvhBuildParams { max_prims_per_leaf: most_in_leaf.min(MOST_IN_LEAF), ..BvhBuildParams::medium_build() };
        let bvh = build_bvh2(padded, params, &mut Duration::default());
        let mut hierarchy = Self { nodes: Vec::new(), order: bvh.primitive_indices.clone(), depth: 0 };
        match bvh.nodes.first() {
            // A root must have two children: the other one is empty.
            Some(root) if root.is_leaf() => {
                hierarchy.depth = 1;
                hierarchy
                    .nodes
                    .push(Node { left: code(root.first_index, root.prim_count), ..boxed(*root.aabb(), Aabb::INVALID) });
            }
            Some(_) => hierarchy.add_inner_nodes(&bvh),
            None => {}
        }
        hierarchy
    }

    /// Split in the middle of their order along the longest axis, again and again: no faster for rays, but as many levels as
    /// the number of boxes has bits, where many boxes are the same.
    fn by_halves(boxes: &[[Vec3; 2]]) -> Self {
        let mut hierarchy = Self { nodes: vec![Node::zeroed()], ..Self::default() };
        let mut order: Vec<u32> = (0..boxes.len() as u32).collect();
        let middle = |slot: u32| boxes[slot as usize][0] + boxes[slot as usize][1];
        let mut open = vec![(0usize, 0usize, boxes.len(), 1usize)];
        while let Some((node, first, end, depth)) = open.pop() {
            hierarchy.depth = hierarchy.depth.max(depth);
            let slots = &mut order[first..end];
            let [low, high] = around(slots.iter().map(|&slot| [middle(slot); 2])).unwrap_or_default();
            let axis = (high - low).max_position();
            slots.sort_by(|&a, &b| middle(a)[axis].total_cmp(&middle(b)[axis]));
            let half = first + (end - first).div_ceil(2);
            let mut child = |first: usize, end: usize| {
                if end - first <= 1 {
                    return code(first as u32, 1);
                }
                let number = hierarchy.nodes.len();
                hierarchy.nodes.push(Node::zeroed());
                open.push((number, first, end, depth + 1));
                number as u32
            };
            let (left, right) = (child(first, half), child(half, end));
            let of = |slots: &[u32]| {
                let corners = around(slots.iter().map(|&slot| boxes[slot as usize]));
                corners.map_or(Aabb::INVALID, |[low, high]| Aabb::new(Vec3A::from(low), Vec3A::from(high)))
            };
            let both = boxed(of(&order[first..half]), of(&order[half..end]));
            hierarchy.nodes[node] = Node { left, right, ..both };
        }
        hierarchy.order = order;
        hierarchy
    }

    /// Adds the root and all inner nodes below it.
    fn add_inner_nodes(&mut self, bvh: &Bvh2) {
        // Not by recursion, because a degenerate hierarchy may be as deep as it is large.
        let mut open = vec![(0, 0, 1)];
        self.nodes.push(Node::zeroed());
        while let Some((node, number, depth)) = open.pop() {
            self.depth = self.depth.max(depth);
            let first = bvh.nodes[node].first_index as usize;
            let children = [first, first + 1].map(|child| {
                let found = &bvh.nodes[child];
                if found.is_leaf() {
                    return code(found.first_index, found.prim_count);
                }
                let number = self.nodes.len() as u32;
                self.nodes.push(Node::zeroed());
                open.push((child, number, depth + 1));
                number
            });
            let [left, right] = children;
            let both = boxed(*bvh.nodes[first].aabb(), *bvh.nodes[first + 1].aabb());
            self.nodes[number as usize] = Node { left, right, ..both };
        }
    }
}

/// The box around boxes.
pub(crate) fn around(boxes: impl Iterator<Item = [Vec3; 2]>) -> Option<[Vec3; 2]> {
    boxes.reduce(|[low, high], [a, b]| [low.min(a), high.max(b)])
}

fn code(first: u32, count: u32) -> u32 {
    LEAF | (count.clamp(1, MOST_IN_LEAF) - 1) << COUNT_SHIFT | first
}

/// A node with these boxes, its children to be filled in; an invalid box is met by no ray.
fn boxed(left: Aabb, right: Aabb) -> Node {
    let empty = |aabb: &Aabb| !(aabb.min.cmple(aabb.max).all());
    // Finite, so that no ray makes a NaN of it, and behind itself, so that none enters.
    let corners = |aabb: Aabb| {
        if empty(&aabb) { [[1e30; 3], [-1e30; 3]] } else { [aabb.min, aabb.max].map(|corner| corner.to_array()) }
    };
    let ([left_low, left_high], [right_low, right_high]) = (corners(left), corners(right));
    Node { left_low, left: LEAF, left_high, right: LEAF, right_low, padding: 0, right_high, more_padding: 0 }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Every primitive lies in exactly one leaf, and within all boxes above it.
    #[test]
    fn every_primitive_is_found_once_within_its_boxes() {
        for count in [1usize, 2, 3, 5, 1000] {
            let boxes: Vec<[Vec3; 2]> = (0..count)
                .map(|i| {
                    let low = Vec3::new((i * 7 % 31) as f32, (i * 5 % 17) as f32, i as f32 * 0.1);
                    [low, low + Vec3::splat(0.5)]
                })
                .collect();
            for hierarchy in [Hierarchy::new(&boxes, MOST_IN_LEAF), Hierarchy::by_halves(&boxes)] {
                let mut seen = vec![0; count];
                let mut open = vec![(0u32, Vec3::NEG_INFINITY, Vec3::INFINITY)];
                while let Some((child, low, high)) = open.pop() {
                    if child & LEAF == 0 {
                        let node = &hierarchy.nodes[child as usize];
                        for (child, child_low, child_high) in
                            [(node.left, node.left_low, node.left_high), (node.right, node.right_low, node.right_high)]
                        {
                            if child_low[0] <= child_high[0] {
                                open.push((child, Vec3::from(child_low), Vec3::from(child_high)));
                            }
                        }
                        continue;
                    }
                    let (first, more) = (child & ((1 << COUNT_SHIFT) - 1), (child >> COUNT_SHIFT) & 7);
                    for place in first..=first + more {
                        let primitive = hierarchy.order[place as usize] as usize;
                        seen[primitive] += 1;
                        let [box_low, box_high] = boxes[primitive];
                        assert!(low.cmple(box_low).all() && high.cmpge(box_high).all());
                    }
                }
                assert!(seen.iter().all(|&times| times == 1), "{count}: {seen:?}");
                assert!(hierarchy.depth >= 1 && hierarchy.depth <= count.max(2));
            }
        }
        assert!(Hierarchy::new(&[], 1).nodes.is_empty());
        let same = Hierarchy::new(&[[Vec3::ZERO, Vec3::ONE]; 1000], 1);
        assert!(same.depth <= DEEP, "{}", same.depth);
    }
}
