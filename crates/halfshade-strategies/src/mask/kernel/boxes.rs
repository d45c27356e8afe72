//! Boxes that hide light: grounds, floors and walls.

use wide::f32x8;

/// Part of a box's size by which receivers may lie in it by rounding.
const ROUNDING: f32 = 1e-5;

/// A solid box, or a rectangle where one of its sizes is 0, in light space.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct PlacedBox {
    /// Middle.
    pub center: [f32; 3],
    /// Half of its sizes, along its own axes.
    pub half: [f32; 3],
    /// Rows of the rotation into its own axes.
    pub rotation: [[f32; 3]; 3],
    /// Its object.
    pub object: u32,
}

/// A box as one receiver sees it.
#[derive(Debug, Clone, Copy)]
pub(crate) struct BoxView<'a> {
    placed: &'a PlacedBox,
    /// The receiver from the box's middle, along the box's axes.
    place: [f32; 3],
    /// Nearest crossing that counts.
    nearest: f32,
}

impl<'a> BoxView<'a> {
    /// From `position`.
    pub(crate) fn new(placed: &'a PlacedBox, position: [f32; 3]) -> Self {
        let offset: [f32; 3] = std::array::from_fn(|axis| position[axis] - placed.center[axis]);
        let turned = |row: [f32; 3]| row[0].mul_add(offset[0], row[1].mul_add(offset[1], row[2] * offset[2]));
        let size = placed.half.iter().fold(0.0f32, |most, half| most.max(*half));
        Self { placed, place: placed.rotation.map(turned), nearest: ROUNDING * size }
    }

    /// 0 in lanes whose direction meets the box before `limit`, else 1.
    ///
    /// Between the nearest exit and the farthest entry of the slabs of the three axes [Kay1986].
    #[inline(always)]
    pub(crate) fn open(&self, direction: &[f32x8; 3], limit: f32) -> f32x8 {
        let (mut enter, mut exit) = (f32x8::splat(f32::MIN), f32x8::splat(f32::MAX));
        for axis in 0..3 {
            let [x, y, z] = self.placed.rotation[axis].map(f32x8::splat);
            let along = direction[0].mul_add(x, direction[1].mul_add(y, direction[2] * z));
            // Never 0, so that nothing is 0 times infinity.
            let per_step = f32x8::ONE / along.abs().fast_max(f32x8::splat(1e-20)).copysign(along);
            let (place, half) = (self.place[axis], self.placed.half[axis]);
            let (low, high) = (f32x8::splat(-half - place) * per_step, f32x8::splat(half - place) * per_step);
            enter = enter.fast_max(low.fast_min(high));
            exit = exit.fast_min(low.fast_max(high));
        }
        let is_met =
            exit.simd_ge(enter) & exit.simd_gt(f32x8::splat(self.nearest)) & enter.simd_lt(f32x8::splat(limit));
        is_met.select(f32x8::ZERO, f32x8::ONE)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn slab(half: [f32; 3]) -> PlacedBox {
        let rotation = [[1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]];
        PlacedBox { center: [0.0, -half[1], 0.0], half, rotation, object: 0 }
    }

    #[test]
    fn hides_what_lies_behind_it_and_nothing_else() {
        for thickness in [0.0, 0.5] {
            let slab = slab([2.0, thickness, 1.0]);
            let open = |position: [f32; 3], direction: [f32; 3], limit: f32| {
                BoxView::new(&slab, position).open(&direction.map(f32x8::splat), limit).to_array()[0]
            };
            let (above, far) = ([0.0, 1.0, 0.0], f32::INFINITY);
            assert_eq!(open(above, [0.0, -1.0, 0.0], far), 0.0);
            assert_eq!(open(above, [0.0, 1.0, 0.0], far), 1.0);
            assert_eq!(open(above, [0.6, -0.8, 0.0], far), 0.0);
            assert_eq!(open(above, [0.0, -0.6, 0.8], far), 1.0);
            assert_eq!(open(above, [0.0, -1.0, 0.0], 0.9), 1.0);
            // On it, up and along.
            for direction in [[0.0, 1.0, 0.0], [0.8, 0.6, 0.0], [0.0, 1e-3, 1.0]] {
                assert_eq!(open([0.0; 3], direction, far), 1.0, "{direction:?}");
            }
        }
    }
}
