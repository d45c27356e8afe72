//! Eight triangles at a time, in single precision: which of them a ray may cross.

use crate::{
    binary::around,
    ray::Ray,
    triangle::{Crossing, Shear, crossing},
};
use glam::{DVec3, Vec3};
use wide::f32x8;

/// How far rounding may move an edge function of a triangle that is crossed, in units of its width times how far away it is:
/// 40 for rounding the differences from the corners, the shear and the products; and some room.
const EDGE_ROUNDING: f32 = 48.0 * f32::EPSILON;

/// How far rounding may move the distance from a triangle's plane times twice its area, in units of the square of its width times
/// how far away it is: 27 for rounding the sides, their product, and the differences from a corner; and some room.
const PLANE_ROUNDING: f32 = 32.0 * f32::EPSILON;

/// Triangles by corner and axis.
#[derive(Debug, Clone)]
#[repr(align(64))]
pub(crate) struct Block {
    corners: [[f32x8; 3]; 3],
    /// Largest difference of coordinates of two corners.
    width: f32x8,
    /// Places in the list of triangles.
    pub(crate) triangles: [u32; 8],
    /// Lanes that have a triangle.
    pub(crate) count: usize,
    /// A bit for each lane whose triangle can be met.
    used: u32,
}

/// A ray as blocks see it.
#[derive(Debug, Clone)]
pub(crate) struct BlockRay {
    ray: Ray,
    shear: Shear,
    /// Along the sheared axes, in two parts, so that differences from what is near are as exact as what is near is small.
    origin: [[f32; 2]; 3],
    by: [f32; 2],
    direction: [f32; 3],
    /// How far behind its origin it meets anything, and some room.
    reach: f32,
}

impl BlockRay {
    #[inline(always)]
    pub(crate) fn new(ray: Ray) -> Self {
        let shear = Shear::of(ray.direction);
        Self {
            ray,
            shear,
            origin: shear.axes.map(|axis| {
                let high = ray.origin[axis] as f32;
                [high, (ray.origin[axis] - f64::from(high)) as f32]
            }),
            by: shear.by.map(|by| by as f32),
            direction: shear.axes.map(|axis| ray.direction[axis] as f32),
            reach: 1.0001 * ray.reach as f32,
        }
    }
}

impl Block {
    /// Up to eight triangles, with their places in a list.
    pub(crate) fn new(triangles: impl IntoIterator<Item = (u32, [Vec3; 3])>) -> Self {
        let corners = [[f32x8::ZERO; 3]; 3];
        let mut block = Self { corners, width: f32x8::ZERO, triangles: [0; 8], count: 0, used: 0 };
        for (lane, (triangle, corners)) in triangles.into_iter().take(8).enumerate() {
            block.triangles[lane] = triangle;
            block.count = lane + 1;
            block.set(lane, Some(corners));
        }
        block
    }

    /// Moves a triangle, or leaves it out.
    pub(crate) fn set(&mut self, lane: usize, corners: Option<[Vec3; 3]>) {
        let [a, b, c] = corners.unwrap_or_default();
        for (rows, corner) in self.corners.iter_mut().zip([a, b, c]) {
            for (row, value) in rows.iter_mut().zip(corner.to_array()) {
                row.as_mut_array()[lane] = value;
            }
        }
        let width = (a.max(b).max(c) - a.min(b).min(c)).max_element();
        self.width.as_mut_array()[lane] = width;
        self.used = if corners.is_some() { self.used | 1 << lane } else { self.used & !(1 << lane) };
    }

    /// The corners of a triangle.
    #[inline(always)]
    fn corners(&self, lane: usize) -> [DVec3; 3] {
        self.corners.map(|rows| DVec3::from_array(rows.map(|row| f64::from(row.as_array()[lane]))))
    }

    /// The box around its triangles; `None` if there are none.
    pub(crate) fn bounds(&self) -> Option<[Vec3; 2]> {
        let corners = (0..8).filter(|lane| self.used >> lane & 1 == 1).flat_map(|lane| self.corners(lane));
        around(corners.map(|corner| [corner.as_vec3(); 2]))
    }

    /// Whether `counts` says so of any triangle that the ray crosses.
    #[inline(always)]
    pub(crate) fn any(&self, ray: &BlockRay, mut counts: impl FnMut(Crossing) -> bool) -> bool {
        let mut crossed = self.crossed(ray);
        while crossed != 0 {
            let lane = crossed.trailing_zeros() as usize & 7;
            crossed &= crossed - 1;
            let found = crossing(self.corners(lane), self.triangles[lane], &ray.ray, &ray.shear);
            if found.is_some_and(&mut counts) {
                return true;
            }
        }
        false
    }

    /// A bit for each triangle that the line of a ray crosses or, as far as single precision can tell, may cross.
    #[inline(always)]
    fn crossed(&self, ray: &BlockRay) -> u32 {
        let row = |corner: usize, i: usize| self.corners[corner][ray.shear.axes[i]];
        let from_origin = |corner: usize, i: usize| {
            let [high, low] = ray.origin[i].map(f32x8::splat);
            row(corner, i) - high - low
        };
        let [(ax, ay, az), (bx, by, _), (cx, cy, _)] = [0, 1, 2].map(|corner| {
            let z = from_origin(corner, 2);
            let sheared = |i: usize| z.mul_neg_add(f32x8::splat(ray.by[i]), from_origin(corner, i));
            (sheared(0), sheared(1), z)
        });
        let u = bx.mul_sub(cy, by * cx);
        let v = cx.mul_sub(ay, cy * ax);
        let w = ax.mul_sub(by, ay * bx);
        // Where a ray passes by farther than the triangle is wide, no rounding makes it cross.
        let doubt = f32x8::splat(EDGE_ROUNDING) * self.width * (az.abs() + self.width);
        let least = u.fast_min(v).fast_min(w);
        let greatest = u.fast_max(v).fast_max(w);
        let is_passed = least.simd_lt(-doubt) & greatest.simd_gt(doubt);
        let crossed = !is_passed.to_bitmask() & self.used;
        if crossed == 0 {
            return 0;
        }
        // Most of what is left lies behind, on the surface that the ray has just left.
        let [p, q] = [1, 2].map(|corner| [0, 1, 2].map(|i| row(corner, i) - row(0, i)));
        let normal = [0, 1, 2].map(|i| {
            let (j, k) = ((i + 1) % 3, (i + 2) % 3);
            p[j].mul_sub(q[k], p[k] * q[j])
        });
        let a = [0, 1, 2].map(|i| from_origin(0, i));
        let dot = |a: [f32x8; 3]| a[0].mul_add(normal[0], a[1].mul_add(normal[1], a[2] * normal[2]));
        let (ahead, facing) = (dot(a), dot(ray.direction.map(f32x8::splat)));
        let doubt = f32x8::splat(PLANE_ROUNDING) * self.width * self.width;
        let distance = a[0].abs().fast_max(a[1].abs()).fast_max(a[2].abs());
        let is_behind = (ahead * facing).simd_lt(f32x8::ZERO)
            & facing.abs().simd_gt(doubt)
            & ahead.abs().simd_gt(facing.abs().mul_add(f32x8::splat(ray.reach), doubt * distance));
        crossed & !is_behind.to_bitmask()
    }
}
