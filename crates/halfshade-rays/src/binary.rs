//! Binary hierarchies of boxes.

use glam::Vec3;

/// Slices along an axis among which a split of many boxes is looked for.
const BINS: usize = 32;

/// Boxes up to which every split is tried.
const FEW: usize = 32;

/// A node: a box, and its two children or its primitives.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct BinaryNode {
    /// Low and high corner.
    pub corners: [Vec3; 2],
    /// The first child, the second being the next node; of a leaf the first of its primitives in [`Binary::order`].
    pub first: u32,
    /// Primitives of a leaf; 0 for a node with children.
    pub count: u32,
}

/// A hierarchy over boxes: the root is node 0, and a child comes after its parent.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct Binary {
    /// Nodes; none if there are no boxes.
    pub nodes: Vec<BinaryNode>,
    /// Primitives in the order in which leaves name them.
    pub order: Vec<u32>,
    /// Levels of nodes.
    pub depth: usize,
}

/// A box, and the number of its primitive.
#[derive(Debug, Clone, Copy)]
struct Item {
    corners: [Vec3; 2],
    primitive: u32,
}

impl Item {
    /// Twice the middle.
    fn middle(&self) -> Vec3 {
        self.corners[0] + self.corners[1]
    }
}

impl Binary {
    /// Over boxes, each from a low to a high corner, all finite, with so many primitives in a leaf at most.
    ///
    /// Boxes are split from the top down where the expected cost of both sides is least: the area of a side, which rays meet it in
    /// proportion to, times the tests of what is in it, of which one takes `together` primitives \[Wald2007\]. That may give as many
    /// levels as there are boxes: if there are more than `deepest`, boxes are halved in the middle of their order along the longest axis
    /// instead.
    pub fn new(boxes: &[[Vec3; 2]], most_in_leaf: u32, together: usize, deepest: usize) -> Self {
        let cheapest = |items: &mut [Item]| cheapest_split(items, together);
        let binary = Self::split(boxes, most_in_leaf as usize, deepest, cheapest);
        // No faster for rays, but with no more levels than the number of boxes has bits.
        binary.or_else(|| Self::split(boxes, most_in_leaf as usize, usize::MAX, halves)).unwrap_or_default()
    }

    /// A hierarchy by a way to reorder boxes and split them in two, which gives how many are on the first side; `None` if it gets too
    /// deep.
    fn split(
        boxes: &[[Vec3; 2]],
        most_in_leaf: usize,
        deepest: usize,
        side: impl Fn(&mut [Item]) -> usize,
    ) -> Option<Self> {
        let mut items: Vec<Item> =
            boxes.iter().zip(0..).map(|(&corners, primitive)| Item { corners, primitive }).collect();
        let unset = BinaryNode { corners: [Vec3::ZERO; 2], first: 0, count: 0 };
        let mut binary = Self { nodes: vec![unset; boxes.len().min(1)], ..Self::default() };
        let mut open: Vec<(usize, usize, usize, usize)> = binary.nodes.iter().map(|_| (0, 0, items.len(), 1)).collect();
        while let Some((place, first, end, depth)) = open.pop() {
            if depth > deepest {
                return None;
            }
            binary.depth = binary.depth.max(depth);
            let items = &mut items[first..end];
            let corners = around(items.iter().map(|item| item.corners)).unwrap_or_default();
            if items.len() <= most_in_leaf.max(1) {
                binary.nodes[place] = BinaryNode { corners, first: first as u32, count: items.len() as u32 };
                continue;
            }
            let half = first + side(items);
            let here = binary.nodes.len();
            binary.nodes[place] = BinaryNode { corners, first: here as u32, count: 0 };
            binary.nodes.extend([unset; 2]);
            open.extend([(here, first, half, depth + 1), (here + 1, half, end, depth + 1)]);
        }
        binary.order = items.iter().map(|item| item.primitive).collect();
        Some(binary)
    }
}

/// Orders items along the longest axis of their middles.
fn halves(items: &mut [Item]) -> usize {
    let [low, high] = around(items.iter().map(|item| [item.middle(); 2])).unwrap_or_default();
    sort(items, (high - low).max_position());
    items.len() / 2
}

fn sort(items: &mut [Item], axis: usize) {
    items.sort_unstable_by(|a, b| a.middle()[axis].total_cmp(&b.middle()[axis]).then(a.primitive.cmp(&b.primitive)));
}

fn united(a: Option<[Vec3; 2]>, b: Option<[Vec3; 2]>) -> Option<[Vec3; 2]> {
    around(a.into_iter().chain(b))
}

/// A box's area over 2.
pub(crate) fn half_area([low, high]: [Vec3; 2]) -> f32 {
    let size = high - low;
    size.x * size.y + size.y * size.z + size.z * size.x
}

/// Orders items so that the cheapest side comes first.
fn cheapest_split(items: &mut [Item], together: usize) -> usize {
    let tests = |count: usize| count.div_ceil(together) as f32;
    let [low, high] = around(items.iter().map(|item| [item.middle(); 2])).unwrap_or_default();
    let is_few = items.len() <= FEW;
    let slice = |item: &Item, axis: usize| {
        let share = (item.middle()[axis] - low[axis]) / (high[axis] - low[axis]);
        // NaN, where all middles are the same, becomes 0.
        ((share * BINS as f32) as usize).min(BINS - 1)
    };
    // Least cost, its axis, and the first slice, or item, of the second side.
    let mut best = (f32::INFINITY, 0, 0);
    let mut slices = [(0, None); BINS];
    for axis in 0..3 {
        let slices = &mut slices[..if is_few { items.len() } else { BINS }];
        slices.fill((0, None));
        if is_few {
            sort(items, axis);
        }
        for (number, item) in items.iter().enumerate() {
            let slice = &mut slices[if is_few { number } else { slice(item, axis) }];
            *slice = (slice.0 + 1, united(slice.1, Some(item.corners)));
        }
        // Costs of second sides, from the far end.
        let mut seconds = [0.0; BINS];
        let (mut count, mut corners) = (0, None);
        for place in (1..slices.len()).rev() {
            count += slices[place].0;
            corners = united(corners, slices[place].1);
            seconds[place] = corners.map_or(f32::INFINITY, |corners| half_area(corners) * tests(count));
        }
        (count, corners) = (0, None);
        for place in 1..slices.len() {
            count += slices[place - 1].0;
            corners = united(corners, slices[place - 1].1);
            let Some(corners) = corners else { continue };
            let cost = half_area(corners) * tests(count) + seconds[place];
            if cost < best.0 {
                best = (cost, axis, place);
            }
        }
    }
    let (cost, axis, place) = best;
    if cost == f32::INFINITY {
        return halves(items);
    }
    if is_few {
        sort(items, axis);
        return place;
    }
    let mut side = 0;
    for number in 0..items.len() {
        if slice(&items[number], axis) < place {
            items.swap(number, side);
            side += 1;
        }
    }
    side
}

/// The box around boxes.
pub fn around(boxes: impl Iterator<Item = [Vec3; 2]>) -> Option<[Vec3; 2]> {
    boxes.reduce(|[low, high], [a, b]| [low.min(a), high.max(b)])
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
            for binary in [Binary::new(&boxes, 4, 1, 64), Binary::new(&boxes, 1, 8, 64), Binary::new(&boxes, 1, 1, 0)] {
                let mut seen = vec![0; count];
                let mut open = vec![(0, [Vec3::NEG_INFINITY, Vec3::INFINITY])];
                while let Some((place, [low, high])) = open.pop() {
                    let BinaryNode { corners: [a, b], first, count } = binary.nodes[place];
                    assert!(low.cmple(a).all() && high.cmpge(b).all());
                    if count == 0 {
                        assert!(first as usize > place);
                        open.extend([(first as usize, [a, b]), (first as usize + 1, [a, b])]);
                        continue;
                    }
                    for primitive in &binary.order[first as usize..][..count as usize] {
                        seen[*primitive as usize] += 1;
                        let [box_low, box_high] = boxes[*primitive as usize];
                        assert!(a.cmple(box_low).all() && b.cmpge(box_high).all());
                    }
                }
                assert!(seen.iter().all(|&times| times == 1), "{count}: {seen:?}");
            }
        }
        assert!(Binary::new(&[], 1, 1, 64).nodes.is_empty());
        // Each twice as far as the last: split one by one.
        let far: Vec<[Vec3; 2]> =
            (0..100).map(|i| [Vec3::X * 2f32.powi(i), Vec3::X * 2f32.powi(i) + Vec3::ONE]).collect();
        for boxes in [vec![[Vec3::ZERO, Vec3::ONE]; 1000], far] {
            let bounded = Binary::new(&boxes, 1, 1, 11);
            assert!(bounded.depth <= 11, "{}", bounded.depth);
        }
    }
}
