//! A grid of points, and weights between them.

use glam::{UVec3, Vec3};

/// Points in equal steps along three axes.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct Grid {
    low: Vec3,
    step: f32,
    /// Points along each axis, at least 2.
    counts: UVec3,
}

/// Eight points around a place, and their weights of sum 1.
pub(crate) type Around = [(usize, f32); 8];

impl Grid {
    /// Points around a box, with so many steps along its longest side.
    pub(crate) fn around([low, high]: [Vec3; 2], steps: usize) -> Self {
        let extent = (high - low).max(Vec3::ZERO);
        let step = extent.max_element() / steps as f32;
        let step = if step.is_normal() { step } else { 1.0 };
        let counts = (extent / step - 1e-3).ceil().max(Vec3::ONE).as_uvec3() + 1;
        let middle = low + 0.5 * extent;
        Self { low: middle - 0.5 * step * (counts - 1).as_vec3(), step, counts }
    }

    /// Numbers that tell it from another one.
    pub(crate) fn key(&self) -> ([f32; 4], [u32; 3]) {
        let [x, y, z] = self.low.to_array();
        ([x, y, z, self.step], self.counts.to_array())
    }

    /// Number of points.
    pub(crate) fn len(&self) -> usize {
        self.counts.to_array().map(|count| count as usize).iter().product()
    }

    /// Number of steps along each axis.
    pub(crate) fn steps(&self) -> [usize; 3] {
        self.counts.to_array().map(|count| count as usize - 1)
    }

    /// A point by its number: x counts fastest.
    pub(crate) fn point(&self, number: usize) -> Vec3 {
        self.low + self.step * self.cell(number).as_vec3()
    }

    /// Points next to one, along edges, faces and through cells.
    pub(crate) fn neighbours(&self, number: usize) -> impl Iterator<Item = usize> {
        let (cell, counts) = (self.cell(number).as_ivec3(), self.counts.as_ivec3());
        (0..27).filter(|&k| k != 13).filter_map(move |k| {
            let other = cell + glam::IVec3::new(k % 3, k / 3 % 3, k / 9) - 1;
            let is_inside = other.min_element() >= 0 && other.cmplt(counts).all();
            is_inside.then(|| self.number(other.as_uvec3()))
        })
    }

    /// Trilinear weights; a place outside has those of the nearest place inside.
    #[inline]
    pub(crate) fn weights(&self, place: Vec3) -> Around {
        let last = (self.counts - 1).as_vec3();
        // Places that are no numbers are at the first point.
        let along = ((place - self.low) / self.step).max(Vec3::ZERO).min(last);
        let cell = along.as_uvec3().min(self.counts - 2);
        let share = along - cell.as_vec3();
        let sides = [Vec3::ONE - share, share];
        std::array::from_fn(|corner| {
            let bits = UVec3::new(corner as u32 & 1, corner as u32 >> 1 & 1, corner as u32 >> 2);
            let [x, y, z] = bits.to_array().map(|bit| bit as usize);
            (self.number(cell + bits), sides[x].x * sides[y].y * sides[z].z)
        })
    }

    fn cell(&self, number: usize) -> UVec3 {
        let (x, y) = (self.counts.x as usize, self.counts.y as usize);
        UVec3::new((number % x) as u32, (number / x % y) as u32, (number / (x * y)) as u32)
    }

    fn number(&self, cell: UVec3) -> usize {
        let [x, y, z] = cell.to_array().map(|along| along as usize);
        (z * self.counts.y as usize + y) * self.counts.x as usize + x
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn linear_functions_are_exact_inside_and_held_outside() {
        let grid = Grid::around([Vec3::new(-1.0, 2.0, 0.0), Vec3::new(3.0, 3.5, 1.0)], 8);
        assert_eq!((grid.steps(), grid.len()), ([8, 3, 2], 9 * 4 * 3));
        let linear = |p: Vec3| 0.3 + p.dot(Vec3::new(0.5, -0.2, 0.7));
        let found = |place: Vec3| -> f32 {
            grid.weights(place).iter().map(|&(number, weight)| weight * linear(grid.point(number))).sum()
        };
        for place in
            [Vec3::new(0.0, 2.5, 0.5), Vec3::new(3.0, 3.5, 1.0), Vec3::new(-1.0, 2.0, 0.0), Vec3::new(2.99, 2.01, 0.77)]
        {
            assert!((found(place) - linear(place)).abs() < 1e-5, "{place}");
        }
        assert!((found(Vec3::new(9.0, 2.5, 0.5)) - linear(Vec3::new(3.0, 2.5, 0.5))).abs() < 1e-5);
        for end in [Vec3::NAN, Vec3::INFINITY, Vec3::NEG_INFINITY, Vec3::splat(f32::MAX)] {
            assert!(
                grid.weights(end).iter().all(|&(number, weight)| number < grid.len() && weight.is_finite()),
                "{end}"
            );
        }
    }

    #[test]
    fn a_box_without_extent_has_a_grid() {
        for corner in [Vec3::ZERO, Vec3::splat(1e6)] {
            let grid = Grid::around([corner; 2], 16);
            assert_eq!(grid.len(), 8);
            assert_eq!(grid.neighbours(0).count(), 7);
            assert!(grid.weights(corner).iter().all(|(_, weight)| (weight - 0.125).abs() < 0.1));
        }
    }
}
