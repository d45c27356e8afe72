//! Hierarchies with eight boxes in a node, which a ray meets all at once \[Wald2008\].

use crate::{
    binary::{Binary, around, half_area},
    ray::Ray,
    space::BOUNDING_RADIUS,
};
use glam::{DVec3, Vec3};
use wide::f32x8;

/// Most levels of a hierarchy: a wide one has no more than the binary one that it is made of.
const DEEPEST: usize = 64;

const LEAF: u32 = 1 << 31;

/// No child.
const NONE: u32 = u32::MAX;

/// Coordinates of a box that no ray meets: it ends before it begins.
const NOWHERE: f32 = 1e30;

const NO_BOX: [Vec3; 2] = [Vec3::splat(NOWHERE), Vec3::splat(-NOWHERE)];

/// Least component of a direction, so that quotients are finite.
const LEAST_COMPONENT: f64 = 1e-30;

/// By how much boxes grow: what rounding of a ray's origin, its direction and the quotients may move a ray by where nothing lies
/// farther out than [`BOUNDING_RADIUS`], four units in the last place.
const PADDING: f32 = 4.0 * f32::EPSILON * 2.0 * BOUNDING_RADIUS as f32;

/// Eight boxes by axis, and what they hold.
#[derive(Debug, Clone)]
#[repr(align(64))]
struct Node {
    /// Low x, y, z, high x, y, z.
    planes: [f32x8; 6],
    /// A node by its number, or [`LEAF`] and the code of a leaf.
    children: [u32; 8],
    /// A bit for each child.
    used: u32,
}

/// A hierarchy over boxes. A child comes after its parent.
#[derive(Debug, Clone, Default)]
pub(crate) struct WideHierarchy {
    nodes: Vec<Node>,
}

/// A ray as boxes see it.
#[derive(Debug, Clone)]
pub(crate) struct BoxRay {
    inverse: [f32; 3],
    /// Minus the origin over the direction.
    offset: [f32; 3],
    /// Places of the planes that are met first, and last.
    near_planes: [usize; 3],
    far_planes: [usize; 3],
    start: f32,
    limit: f32,
}

impl BoxRay {
    /// A ray in the space of a hierarchy, its origin within [`BOUNDING_RADIUS`].
    #[inline(always)]
    pub(crate) fn new(ray: &Ray) -> Self {
        let size = ray.direction.abs().max(DVec3::splat(LEAST_COMPONENT));
        // Minus 0 has a sign, as its inverse has.
        let inverse = size.recip().copysign(ray.direction);
        let offset = -ray.origin * inverse;
        let backward = ray.direction.is_negative_bitmask() as usize;
        let near = [0, 1, 2].map(|axis| axis + 3 * (backward >> axis & 1));
        Self {
            inverse: inverse.as_vec3().to_array(),
            offset: offset.as_vec3().to_array(),
            near_planes: near,
            far_planes: [3 - near[0], 5 - near[1], 7 - near[2]],
            start: -ray.reach as f32,
            limit: ray.limit as f32,
        }
    }

    /// Ends the ray at `limit`.
    #[inline(always)]
    pub(crate) fn shorten(&mut self, limit: f64) {
        self.limit = limit as f32;
    }
}

impl Node {
    const EMPTY: Self = {
        let (low, high) = (f32x8::new([NOWHERE; 8]), f32x8::new([-NOWHERE; 8]));
        Self { planes: [low, low, low, high, high, high], children: [NONE; 8], used: 0 }
    };

    /// Puts a box, somewhat larger than it is, or none.
    fn set(&mut self, lane: usize, corners: Option<[Vec3; 2]>) {
        let [low, high] = corners.map_or(NO_BOX, |[low, high]| [low - PADDING, high + PADDING]);
        for axis in 0..3 {
            self.planes[axis].as_mut_array()[lane] = low[axis];
            self.planes[3 + axis].as_mut_array()[lane] = high[axis];
        }
    }

    /// The box around its boxes.
    fn around(&self) -> Option<[Vec3; 2]> {
        let corner = |first: usize, lane: usize| {
            Vec3::from_array(std::array::from_fn(|axis| self.planes[first + axis].as_array()[lane]))
        };
        around((0..8).map(|lane| [corner(0, lane), corner(3, lane)]).filter(|corners| *corners != NO_BOX))
    }

    /// Where the ray enters each box, and which boxes it enters.
    #[inline(always)]
    fn entered(&self, ray: &BoxRay) -> (f32x8, u32) {
        let met = |axis: usize, plane: usize| {
            self.planes[plane].mul_add(f32x8::splat(ray.inverse[axis]), f32x8::splat(ray.offset[axis]))
        };
        let [x, y, z] = [0, 1, 2].map(|axis| met(axis, ray.near_planes[axis]));
        let first = x.fast_max(y).fast_max(z.fast_max(f32x8::splat(ray.start)));
        let [x, y, z] = [0, 1, 2].map(|axis| met(axis, ray.far_planes[axis]));
        let last = x.fast_min(y).fast_min(z.fast_min(f32x8::splat(ray.limit)));
        (first, first.simd_le(last).to_bitmask() & self.used)
    }
}

impl WideHierarchy {
    /// Over boxes, of which at most `most_in_leaf` share a leaf. `leaf` gets the numbers of its boxes and gives its code, below 2^31.
    pub(crate) fn new(boxes: &[[Vec3; 2]], most_in_leaf: usize, mut leaf: impl FnMut(&[u32]) -> u32) -> Self {
        let binary = Binary::new(boxes, 1, most_in_leaf, DEEPEST);
        let mut hierarchy = Self::default();
        if binary.nodes.is_empty() {
            return hierarchy;
        }
        let collapse = Collapse::new(&binary, most_in_leaf);
        hierarchy.nodes.push(Node::EMPTY);
        let mut open = vec![(collapse.children(0), 0)];
        while let Some((children, number)) = open.pop() {
            for (lane, place) in children.into_iter().enumerate() {
                let is_leaf = collapse.is_leaf(place);
                let child = if is_leaf {
                    LEAF | leaf(&primitives(&binary, place))
                } else {
                    hierarchy.nodes.push(Node::EMPTY);
                    open.push((collapse.children(place), hierarchy.nodes.len() - 1));
                    (hierarchy.nodes.len() - 1) as u32
                };
                let node = &mut hierarchy.nodes[number];
                node.children[lane] = child;
                node.used |= 1 << lane;
                node.set(lane, Some(binary.nodes[place].corners));
            }
        }
        hierarchy
    }

    /// Takes new boxes of the leaves, by their codes, and keeps the order.
    pub(crate) fn refit(&mut self, corners_of_leaf: impl Fn(u32) -> Option<[Vec3; 2]>) {
        for number in (0..self.nodes.len()).rev() {
            for lane in 0..8 {
                let corners = match self.nodes[number].children[lane] {
                    NONE => None,
                    leaf if leaf & LEAF != 0 => corners_of_leaf(leaf & !LEAF),
                    child => self.nodes[child as usize].around(),
                };
                self.nodes[number].set(lane, corners);
            }
        }
    }

    /// Whether `is_met` says so of any leaf that the ray enters; asks no further then.
    #[inline(always)]
    pub(crate) fn any(&self, ray: &BoxRay, mut is_met: impl FnMut(u32) -> bool) -> bool {
        if self.nodes.is_empty() {
            return false;
        }
        // By level a node and those of its children that are still to be visited.
        let mut stack = [(0u32, 0u32); DEEPEST];
        let mut height = 0;
        let (mut number, mut left) = (0, self.nodes[0].entered(ray).1);
        loop {
            if left == 0 {
                if height == 0 {
                    return false;
                }
                height -= 1;
                (number, left) = stack[height];
            }
            let lane = left.trailing_zeros() as usize & 7;
            left &= left - 1;
            let child = self.nodes[number as usize].children[lane];
            if child & LEAF == 0 {
                stack[height] = (number, left);
                height += usize::from(left != 0);
                (number, left) = (child, self.nodes[child as usize].entered(ray).1);
            } else if is_met(child & !LEAF) {
                return true;
            }
        }
    }

    /// Calls `visit` with the leaves that the ray enters, near ones first; it may shorten the ray.
    #[inline(always)]
    pub(crate) fn nearest(&self, ray: &mut BoxRay, mut visit: impl FnMut(u32, &mut BoxRay)) {
        if self.nodes.is_empty() {
            return;
        }
        let mut stack = [(0u32, f32::NEG_INFINITY); 7 * DEEPEST + 1];
        let mut height = 1;
        while height > 0 {
            height -= 1;
            let (code, distance) = stack[height];
            if distance > ray.limit {
                continue;
            }
            if code & LEAF != 0 {
                visit(code & !LEAF, ray);
                continue;
            }
            let node = &self.nodes[code as usize];
            let (distances, mut entered) = node.entered(ray);
            let first = height;
            while entered != 0 {
                let lane = entered.trailing_zeros() as usize & 7;
                entered &= entered - 1;
                let entry = (node.children[lane], distances.as_array()[lane]);
                // The nearest comes last, to be taken first.
                let mut place = height;
                while place > first && stack[place - 1].1 < entry.1 {
                    stack[place] = stack[place - 1];
                    place -= 1;
                }
                stack[place] = entry;
                height += 1;
            }
        }
    }

    /// Memory that it takes.
    pub(crate) fn bytes(&self) -> usize {
        size_of_val(self.nodes.as_slice())
    }
}

/// The cheapest way to make nodes with eight children of a binary hierarchy, by surface areas \[Ylitie2017\].
///
/// A ray meets a node or a leaf in proportion to its area. C(n, i) is the least cost of what is below node n as at most i children
/// of one node: as one it is a leaf, or a node of its own with eight.
struct Collapse<'a> {
    binary: &'a Binary,
    costs: Vec<[f32; 8]>,
    /// By node and number of children: how many of them the first child of the binary node gets; 0 where one less costs no more.
    firsts: Vec<[u8; 8]>,
    is_leaf: Vec<bool>,
}

/// Time that a leaf takes as a multiple of that of a node.
const LEAF_COST: f32 = 1.0;

impl<'a> Collapse<'a> {
    fn new(binary: &'a Binary, most_in_leaf: usize) -> Self {
        let count = binary.nodes.len();
        let (costs, firsts) = (vec![[0.0; 8]; count], vec![[0; 8]; count]);
        let mut collapse = Self { binary, costs, firsts, is_leaf: vec![false; count] };
        let mut primitives = vec![0; count];
        // Children come after their parents.
        for (place, node) in binary.nodes.iter().enumerate().rev() {
            let area = half_area(node.corners);
            let [left, right] = [node.first as usize, node.first as usize + 1];
            primitives[place] = if node.count > 0 { node.count as usize } else { primitives[left] + primitives[right] };
            let as_leaf = if primitives[place] <= most_in_leaf { LEAF_COST * area } else { f32::INFINITY };
            if node.count > 0 {
                collapse.costs[place] = [LEAF_COST * area; 8];
                collapse.is_leaf[place] = true;
                continue;
            }
            let shared = |children: usize| {
                let cost = |first: usize| collapse.costs[left][first - 1] + collapse.costs[right][children - first - 1];
                let best = (1..children).min_by(|&a, &b| cost(a).total_cmp(&cost(b))).unwrap_or(1);
                (best as u8, cost(best))
            };
            let by_count: [(u8, f32); 8] = std::array::from_fn(|i| shared((i + 1).max(2)));
            let as_node = area + by_count[7].1;
            let mut costs = [as_leaf.min(as_node); 8];
            let mut firsts = [0; 8];
            for i in 1..8 {
                let (first, cost) = by_count[i];
                (firsts[i], costs[i]) = if cost < costs[i - 1] { (first, cost) } else { (0, costs[i - 1]) };
            }
            firsts[0] = by_count[7].0;
            collapse.is_leaf[place] = as_leaf <= as_node;
            (collapse.costs[place], collapse.firsts[place]) = (costs, firsts);
        }
        collapse
    }

    fn is_leaf(&self, place: usize) -> bool {
        self.is_leaf[place]
    }

    /// The nodes that are the children of one; itself if it is a leaf.
    fn children(&self, place: usize) -> Vec<usize> {
        if self.is_leaf[place] {
            return vec![place];
        }
        let (first, node) = (self.firsts[place][0] as usize, &self.binary.nodes[place]);
        let mut found = Vec::with_capacity(8);
        let mut open = vec![(node.first as usize, first), (node.first as usize + 1, 8 - first)];
        while let Some((place, children)) = open.pop() {
            // More children that aren't cheaper are fewer.
            let children = (1..=children).rev().find(|&i| i == 1 || self.firsts[place][i - 1] > 0).unwrap_or(1);
            if children == 1 {
                found.push(place);
            } else {
                let (first, node) = (self.firsts[place][children - 1] as usize, &self.binary.nodes[place]);
                open.extend([(node.first as usize, first), (node.first as usize + 1, children - first)]);
            }
        }
        found
    }
}

/// The primitives below a node.
fn primitives(binary: &Binary, root: usize) -> Vec<u32> {
    let (mut found, mut open) = (Vec::new(), vec![root]);
    while let Some(place) = open.pop() {
        let node = &binary.nodes[place];
        if node.count == 0 {
            open.extend([node.first as usize, node.first as usize + 1]);
        } else {
            found.extend(&binary.order[node.first as usize..][..node.count as usize]);
        }
    }
    found
}
