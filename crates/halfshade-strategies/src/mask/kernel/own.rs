//! Directions that an object's own mesh hides from points on it: a bit for each cell of an octahedral grid, vertex by
//! vertex, interpolated between vertices.
//!
//! A direction in the object's space is projected onto the octahedron, p = d / (|x| + |y| + |z|), and its lower half folded
//! outwards, as [`halfshade_scene::light::OctahedralGrid`] does; the square is cut into cells.

use glam::Vec3;
use wide::f32x8;

/// Bits of a word.
const WORD: usize = u32::BITS as usize;

/// The cells of the grid that are open, from each vertex of a mesh.
#[derive(Debug, Clone)]
pub(crate) struct OpenCells {
    /// Cells along a side.
    pub(crate) side: usize,
    /// Vertex by vertex, in whole words: a bit is set where nothing is in the way.
    pub(crate) words: Vec<u32>,
}

/// A point of a mesh, and how light space turns into the mesh's.
#[derive(Debug, Clone, Copy)]
pub(crate) struct OwnView<'a> {
    pub(crate) cells: &'a OpenCells,
    /// Vertices and their weights; those that see everything count together.
    pub(crate) vertices: [(u32, f32); 3],
    /// Weight of vertices that see everything.
    pub(crate) open_weight: f32,
    /// Rows.
    pub(crate) object_from_light: [[f32; 3]; 3],
}

/// Words of the cells of one vertex.
pub(crate) fn words_of(side: usize) -> usize {
    (side * side).div_ceil(WORD)
}

impl OpenCells {
    /// Whether nothing is in the way of a vertex.
    pub(crate) fn is_all_open(&self, vertex: usize) -> bool {
        let per_vertex = words_of(self.side);
        self.words[vertex * per_vertex..][..per_vertex].iter().all(|&word| word == u32::MAX)
    }
}

/// Unit direction of the middle of a cell.
pub(crate) fn cell_direction(side: usize, cell: usize) -> Vec3 {
    let place = |i: usize| (2 * i + 1) as f32 / side as f32 - 1.0;
    let (u, v) = (place(cell % side), place(cell / side));
    let y = 1.0 - u.abs() - v.abs();
    let folded = if y >= 0.0 { [u, v] } else { [(1.0 - v.abs()).copysign(u), (1.0 - u.abs()).copysign(v)] };
    Vec3::new(folded[0], y, folded[1]).normalize()
}

impl OwnView<'_> {
    /// How much of each of eight directions is open.
    #[inline(always)]
    pub(crate) fn open(&self, direction: &[f32x8; 3]) -> f32x8 {
        if self.open_weight == 1.0 {
            return f32x8::ONE;
        }
        let rows = &self.object_from_light;
        let turned: [f32x8; 3] = std::array::from_fn(|k| {
            let [x, y, z] = rows[k].map(f32x8::splat);
            direction[0].mul_add(x, direction[1].mul_add(y, direction[2] * z))
        });
        let cells = cells_of(&turned, self.cells.side);
        let per_vertex = words_of(self.cells.side);
        let mut open = f32x8::splat(self.open_weight);
        for (vertex, weight) in self.vertices {
            if weight == 0.0 {
                continue;
            }
            let words = &self.cells.words[vertex as usize * per_vertex..][..per_vertex];
            let bits = cells.map(|cell| (words[cell as usize / WORD] >> (cell as usize % WORD) & 1) as f32);
            open = f32x8::from(bits).mul_add(f32x8::splat(weight), open);
        }
        open
    }
}

/// The cells in which eight directions lie; a direction of 0 has that of the pole.
#[inline(always)]
fn cells_of(direction: &[f32x8; 3], side: usize) -> [i32; 8] {
    let (half, last) = (f32x8::splat(0.5 * side as f32), f32x8::splat(side as f32 - 1.0));
    let [column, line] =
        unfolded(direction).map(|at| at.mul_add(half, half).floor().fast_max(f32x8::ZERO).fast_min(last));
    // Whole numbers far below 2^24: exact.
    line.mul_add(f32x8::splat(side as f32), column).fast_trunc_int().to_array()
}

/// Places on the square that the octahedron unfolds to, from -1 to 1.
#[inline(always)]
pub(crate) fn unfolded([x, y, z]: &[f32x8; 3]) -> [f32x8; 2] {
    let size = (x.abs() + y.abs() + z.abs()).fast_max(f32x8::splat(f32::MIN_POSITIVE));
    let per_size = f32x8::ONE / size;
    let (x_part, z_part) = ((*x * per_size).abs(), (*z * per_size).abs());
    let upper = y.simd_ge(f32x8::ZERO);
    let u = upper.select(x_part, f32x8::ONE - z_part).copysign(*x);
    let v = upper.select(z_part, f32x8::ONE - x_part).copysign(*z);
    [u, v]
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_middle_of_a_cell_lies_in_it() {
        for side in [4, 7, 24, 64] {
            for cell in 0..side * side {
                let direction = cell_direction(side, cell);
                let found = cells_of(&direction.to_array().map(f32x8::splat), side);
                // Cells that a fold crosses have their middle on an edge of the octahedron, at odd sides.
                let same = cell_direction(side, found[0] as usize).distance(direction) < 1e-5;
                assert!(same, "{side} {cell}: {}", found[0]);
            }
        }
    }

    #[test]
    fn what_lies_between_vertices_is_between_what_they_see() {
        let side = 8;
        let mut words = vec![0; 3 * words_of(side)];
        words[words_of(side)..2 * words_of(side)].fill(u32::MAX);
        let cells = OpenCells { side, words };
        let identity = [[1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]];
        let view = OwnView {
            cells: &cells,
            vertices: [(0, 0.5), (1, 0.25), (2, 0.25)],
            open_weight: 0.0,
            object_from_light: identity,
        };
        assert_eq!(view.open(&[f32x8::ONE, f32x8::ZERO, f32x8::ZERO]), f32x8::splat(0.25));
    }
}
