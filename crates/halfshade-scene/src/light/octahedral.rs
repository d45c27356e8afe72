//! A table over directions: the sphere unfolded onto a square through an octahedron, interpolated over triangles.

use glam::Vec3;
use wide::f32x8;

/// Nodes on the octahedral unfolding of the sphere, `2 · half + 1` along each side.
///
/// A unit direction d is projected onto the octahedron, p = d / (|x| + |y| + |z|); the upper half (y ≥ 0) is drawn as
/// (u, v) = (p.x, p.z), the lower half folded outwards over the four edges of the diamond |u| + |v| = 1. Cells are cut
/// along those edges, and values are interpolated linearly over the two triangles of a cell: three reads, continuous,
/// and of second order everywhere, which bilinear interpolation is not in the cells that a fold crosses.
///
/// Error of a function with second derivative at most c (per radian²): about c/2 · (1.5 / half)² at worst.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct OctahedralGrid {
    half: usize,
}

/// Three nodes and their weights, of sum 1.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct OctahedralWeights {
    /// Indices of the nodes.
    pub nodes: [usize; 3],
    /// Their weights, not negative up to rounding.
    pub weights: [f32; 3],
}

impl OctahedralGrid {
    /// A grid with `half` cells from the centre to each side, at least 1.
    pub const fn new(half: usize) -> Self {
        Self { half: if half == 0 { 1 } else { half } }
    }

    /// Number of nodes.
    pub const fn node_count(&self) -> usize {
        (2 * self.half + 1) * (2 * self.half + 1)
    }

    /// Unit direction of node `node`.
    pub fn direction(&self, node: usize) -> Vec3 {
        let side = 2 * self.half + 1;
        let coordinate = |i: usize| (i as f32 - self.half as f32) / self.half as f32;
        let (u, v) = (coordinate(node % side), coordinate(node / side));
        let y = 1.0 - u.abs() - v.abs();
        let p = if y >= 0.0 {
            Vec3::new(u, y, v)
        } else {
            Vec3::new((1.0 - v.abs()).copysign(u), y, (1.0 - u.abs()).copysign(v))
        };
        p.normalize()
    }

    /// The nodes around unit `direction`, and their weights. Any finite vector that is not zero will do; what is not
    /// finite, or zero, gets the weights of some direction.
    #[inline]
    pub fn lookup(&self, direction: Vec3) -> OctahedralWeights {
        let size = direction.x.abs() + direction.y.abs() + direction.z.abs();
        let scale = 1.0 / size.max(f32::MIN_POSITIVE);
        let (x, z) = ((direction.x * scale).abs(), (direction.z * scale).abs());
        let (a, b) = if direction.y >= 0.0 { (x, z) } else { (1.0 - z, 1.0 - x) };
        let half = self.half as f32;
        // `max` and `min` before the cast: NaN becomes 0.
        let (a, b) = ((a * half).max(0.0).min(half), (b * half).max(0.0).min(half));
        let (i, j) = ((a as usize).min(self.half - 1), (b as usize).min(self.half - 1));
        let (s, t) = (a - i as f32, b - j as f32);
        let node = |i: usize, j: usize| {
            let column = if direction.x < 0.0 { self.half - i } else { self.half + i };
            let row = if direction.z < 0.0 { self.half - j } else { self.half + j };
            row * (2 * self.half + 1) + column
        };
        let (near, weights) = if s + t <= 1.0 {
            (node(i, j), [1.0 - s - t, s, t])
        } else {
            (node(i + 1, j + 1), [s + t - 1.0, 1.0 - t, 1.0 - s])
        };
        OctahedralWeights { nodes: [near, node(i + 1, j), node(i, j + 1)], weights }
    }

    /// Cells from the centre to the side.
    pub fn cells(&self) -> usize {
        self.half
    }

    /// [`lookup`](Self::lookup) of eight directions: per corner the eight nodes and the eight weights. Finite, not zero.
    #[inline(always)]
    pub fn lookup_batch(&self, direction: &[f32x8; 3]) -> ([[i32; 8]; 3], [f32x8; 3]) {
        let one = f32x8::ONE;
        let [x, y, z] = *direction;
        let scale = one / (x.abs() + y.abs() + z.abs()).fast_max(f32x8::splat(f32::MIN_POSITIVE));
        let (x_part, z_part) = ((x * scale).abs(), (z * scale).abs());
        let upper = y.simd_ge(f32x8::ZERO);
        let half = f32x8::splat(self.half as f32);
        let place = |inner: f32x8, folded: f32x8| {
            (upper.select(inner, one - folded) * half).fast_max(f32x8::ZERO).fast_min(half)
        };
        let (a, b) = (place(x_part, z_part), place(z_part, x_part));
        let last = half - one;
        let (i, j) = (a.floor().fast_min(last), b.floor().fast_min(last));
        let (s, t) = (a - i, b - j);
        let sum = s + t;
        let far = sum.simd_gt(one);
        let (sign_x, sign_z) = (one.copysign(x), one.copysign(z));
        // Whole numbers far below 2^24: exact.
        let side = f32x8::splat((2 * self.half + 1) as f32);
        let node = |i: f32x8, j: f32x8| -> [i32; 8] {
            let (column, row) = (sign_x.mul_add(i, half), sign_z.mul_add(j, half));
            row.mul_add(side, column).fast_trunc_int().to_array()
        };
        let step = far.select(one, f32x8::ZERO);
        let nodes = [node(i + step, j + step), node(i + one, j), node(i, j + one)];
        (nodes, [(one - sum).abs(), far.select(one - t, s), far.select(one - s, t)])
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn spiral(count: usize) -> impl Iterator<Item = Vec3> {
        (0..count).map(move |i| {
            let y = 1.0 - (2.0 * i as f32 + 1.0) / count as f32;
            let (sin, cos) = (i as f32 * 2.399_963).sin_cos();
            let r = (1.0 - y * y).sqrt();
            Vec3::new(r * cos, y, r * sin)
        })
    }

    #[test]
    fn nodes_find_themselves() {
        let grid = OctahedralGrid::new(5);
        for node in 0..grid.node_count() {
            let found = grid.lookup(grid.direction(node));
            let direction: Vec3 =
                (0..3).map(|k| found.weights[k] * grid.direction(found.nodes[k])).fold(Vec3::ZERO, |a, b| a + b);
            assert!(direction.distance(grid.direction(node)) < 1e-5, "{node}");
        }
    }

    #[test]
    fn eight_at_a_time_find_what_one_finds() {
        let grid = OctahedralGrid::new(7);
        let directions: Vec<Vec3> =
            spiral(4_000).chain([Vec3::X, -Vec3::X, Vec3::Y, -Vec3::Y, Vec3::Z, -Vec3::Z]).collect();
        for eight in directions.windows(8).step_by(3) {
            let batch: [f32x8; 3] =
                std::array::from_fn(|k| f32x8::from(std::array::from_fn::<_, 8, _>(|i| eight[i][k])));
            let (nodes, weights) = grid.lookup_batch(&batch);
            for (lane, &direction) in eight.iter().enumerate() {
                // By the value that is interpolated: on a border either side may be found.
                let value = |nodes: [usize; 3], weights: [f32; 3]| -> Vec3 {
                    (0..3).map(|k| weights[k] * grid.direction(nodes[k])).fold(Vec3::ZERO, |a, b| a + b)
                };
                let one = grid.lookup(direction);
                let batch = value(nodes.map(|n| n[lane] as usize), weights.map(|w| w.to_array()[lane]));
                assert!(batch.distance(value(one.nodes, one.weights)) < 1e-5, "{direction}");
            }
        }
    }

    /// Interpolating a smooth function: the error falls with the square of the spacing, folds or not.
    #[test]
    fn second_order_everywhere() {
        let f = |d: Vec3| (1.3 * d.x - 0.4 * d.y + 0.9 * d.z).exp();
        let worst = |half| {
            let grid = OctahedralGrid::new(half);
            let values: Vec<f32> = (0..grid.node_count()).map(|node| f(grid.direction(node))).collect();
            spiral(20_000)
                .map(|d| {
                    let found = grid.lookup(d);
                    let value: f32 = (0..3).map(|k| found.weights[k] * values[found.nodes[k]]).sum();
                    (value - f(d)).abs()
                })
                .fold(0.0, f32::max)
        };
        let (coarse, fine) = (worst(16), worst(64));
        assert!(coarse < 0.03 && fine < coarse / 12.0, "{coarse} {fine}");
    }

    #[test]
    fn axes_and_rubbish_stay_inside() {
        let grid = OctahedralGrid::new(7);
        let odd = [Vec3::X, Vec3::NEG_X, Vec3::Y, Vec3::NEG_Y, Vec3::Z, Vec3::NEG_Z, Vec3::ZERO, Vec3::NAN, Vec3::MAX];
        for direction in odd {
            assert!(grid.lookup(direction).nodes.iter().all(|&node| node < grid.node_count()), "{direction}");
        }
    }
}
