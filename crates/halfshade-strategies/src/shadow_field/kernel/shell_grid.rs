//! Places between the sample points of a field: the two shells around each, and four points of a shell's grid.

use wide::{f32x8, i32x8};

/// For each of eight distances from the centre the number of the next shell outward, and the shares of the shells
/// within and without.
///
/// `radii` ascend from 0, and `outer` has the next shell outward for every `step` of distance. Past the last shell its
/// share falls with the square of the distance.
#[inline(always)]
pub(crate) fn between_shells(distance: f32x8, radii: &[f32], outer: &[u8], step: f32) -> ([usize; 8], [f32x8; 2]) {
    let outermost = f32x8::splat(radii[radii.len() - 1]);
    let beyond = distance.simd_ge(outermost);
    // Looked up: a search would take as long as the interpolation.
    let steps = distance.fast_min(outermost) * f32x8::splat(step.recip());
    let last = outer.len() - 1;
    let outer = steps.fast_trunc_int().to_array().map(|step| usize::from(outer[(step as usize).min(last)]));
    let radius = |inward: usize| f32x8::from(outer.map(|outer| radii[outer - inward]));
    let (from, to) = (radius(1), radius(0));
    // Rounding may lead to the shell next to the right one, whose end is the same.
    let share = ((distance - from) / (to - from)).fast_max(f32x8::ZERO).fast_min(f32x8::ONE);
    let shrunk = outermost / distance;
    (outer, [beyond.select(f32x8::ZERO, f32x8::ONE - share), beyond.select(shrunk * shrunk, share)])
}

/// Around each of eight places the four points of a grid, and their weights, of sum 1.
#[derive(Debug)]
pub(crate) struct Corners {
    places: [i32x8; 4],
    weights: [f32x8; 4],
}

impl Corners {
    /// Across the seam of longitudes as anywhere, and over a pole to the opposite longitude. The resolutions are powers of
    /// two: no division.
    #[inline(always)]
    pub(crate) fn new(resolution: f32x8, u: f32x8, v: f32x8) -> Self {
        let half = f32x8::HALF;
        let (x, y) = (u.mul_sub(resolution, half), v.mul_sub(resolution, half));
        let (column, row) = (x.floor(), y.floor());
        let (s, t) = (x - column, y - row);
        let sides = resolution.fast_trunc_int();
        let at = |column: f32x8, row: f32x8| {
            let over = row.simd_lt(f32x8::ZERO) | row.simd_ge(resolution);
            // One point alone is its own opposite: what is half a column too many is cut off.
            let column = column + over.select(half * resolution, f32x8::ZERO);
            let row = row.fast_min(resolution - f32x8::ONE).fast_max(f32x8::ZERO);
            row.fast_trunc_int() * sides + (column.fast_trunc_int() & (sides - i32x8::ONE))
        };
        let one = f32x8::ONE;
        let (next_column, next_row) = (column + one, row + one);
        Self {
            places: [at(column, row), at(next_column, row), at(column, next_row), at(next_column, next_row)],
            weights: [(one - s) * (one - t), s * (one - t), (one - s) * t, s * t],
        }
    }

    /// The four points and weights of one lane.
    #[inline(always)]
    pub(crate) fn lane(&self, k: usize) -> [(usize, f32); 4] {
        std::array::from_fn(|i| (self.places[i].as_array()[k] as usize, self.weights[i].as_array()[k]))
    }
}
