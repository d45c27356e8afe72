//! Hierarchies of boxes for kernels: one per mesh, which stays on the device, and one over the objects of a frame.
//!
//! A node is 64 bytes and holds the boxes of its two children, so that one read decides about both
//! [Aila and Laine 2009]. A child is a node by its number, or a leaf: the highest bit, then the number of primitives less
//! one in three bits, then the first primitive.

use bytemuck::{Pod, Zeroable};
use glam::Vec3;
use halfshade_rays::binary::{Binary, BinaryNode};

/// Most entries of a ray's stack, as the shader has them: a level of both hierarchies takes one.
pub(crate) const STACK: usize = 56;

/// Most levels of a binary hierarchy, the leaves among them: the ways down two of them fit a stack.
const DEEP: usize = STACK / 2;

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

impl Hierarchy {
    /// Over boxes, each from a low to a high corner, with so many primitives in a leaf at most.
    pub(crate) fn new(boxes: &[[Vec3; 2]], most_in_leaf: u32) -> Self {
        let binary = Binary::new(boxes, most_in_leaf.min(MOST_IN_LEAF), 1, DEEP);
        let mut hierarchy = Self { nodes: Vec::new(), order: binary.order, depth: binary.depth.max(2) - 1 };
        // Places among the nodes that have children, since those are what the device has.
        let mut inner = 0;
        let numbers: Vec<u32> = (binary.nodes.iter())
            .map(|node| {
                inner += u32::from(node.count == 0);
                inner.saturating_sub(1)
            })
            .collect();
        let code = |place: usize| match binary.nodes[place] {
            BinaryNode { count: 0, .. } => numbers[place],
            BinaryNode { first, count, .. } => leaf(first, count),
        };
        match binary.nodes.as_slice() {
            // A root must have two children: the other one is empty.
            [root] => hierarchy.nodes.push(Node { left: code(0), ..boxed(root.corners, EMPTY) }),
            nodes => hierarchy.nodes.extend(nodes.iter().filter(|node| node.count == 0).map(|node| {
                let [left, right] = [node.first as usize, node.first as usize + 1];
                let both = boxed(nodes[left].corners, nodes[right].corners);
                Node { left: code(left), right: code(right), ..both }
            })),
        }
        hierarchy
    }
}

fn leaf(first: u32, count: u32) -> u32 {
    LEAF | (count.clamp(1, MOST_IN_LEAF) - 1) << COUNT_SHIFT | first
}

/// A box that is met by no ray: finite, so that none makes a NaN of it, and behind itself, so that none enters.
const EMPTY: [Vec3; 2] = [Vec3::splat(1e30), Vec3::splat(-1e30)];

/// A node with these boxes, its children to be filled in.
fn boxed(left: [Vec3; 2], right: [Vec3; 2]) -> Node {
    let ([left_low, left_high], [right_low, right_high]) =
        (left.map(|corner| corner.to_array()), right.map(|corner| corner.to_array()));
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
            for hierarchy in [Hierarchy::new(&boxes, MOST_IN_LEAF), Hierarchy::new(&boxes, 1)] {
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
