//! The product of two functions in the Haar basis: the triple product \[Ng2004\] of two vectors with every basis
//! function.
//!
//! Three wavelets have an integral other than 0 only if they share a square, or two are the same and lie within one
//! quarter of the third. So one walk down the tree of squares finds the product, with the means of both functions over
//! the square at hand. Where one of them has no finer wavelets it is a number, and the other's are scaled.
//!
//! Functions that are constant on texels have products that are: nothing is cut off, unlike with spherical harmonics. So
//! the product of texels, one by one, is the same function; this way is shorter where vectors are sparse.

/// Squares that have wavelets, themselves or within.
struct Occupied(Vec<bool>);

impl Occupied {
    fn new(vector: &[f32]) -> Self {
        let squares = vector.len() / 3;
        let mut occupied = vec![false; squares];
        let mut on_level = vector.len() / 4;
        while on_level > 0 {
            let first = (on_level - 1) / 3;
            for square in 0..on_level {
                let own = (1..4).any(|kind| vector[kind * on_level + square] != 0.0);
                let finer = first + on_level;
                let within =
                    4 * on_level < vector.len() && (0..4).any(|quarter| occupied[finer + square + quarter * on_level]);
                occupied[first + square] = own || within;
            }
            on_level /= 4;
        }
        Self(occupied)
    }

    /// Whether square `square` of the level that has `on_level` of them holds wavelets; texels don't.
    fn at(&self, on_level: usize, square: usize) -> bool {
        self.0.get((on_level - 1) / 3 + square).copied().unwrap_or(false)
    }
}

/// `out = a b` on one face; all have `4^L` coefficients, ordered as [`super`] says.
pub fn product(a: &[f32], b: &[f32], out: &mut [f32]) {
    let walk = Walk { vectors: [a, b], occupied: [Occupied::new(a), Occupied::new(b)] };
    out.fill(0.0);
    if let ([Some(a), Some(b)], false) = ([a.first(), b.first()], out.is_empty()) {
        out[0] = walk.square(1, 0, [*a, *b], out);
    }
}

struct Walk<'a> {
    vectors: [&'a [f32]; 2],
    occupied: [Occupied; 2],
}

impl Walk<'_> {
    /// Writes the product's wavelets of a square and all within it; returns its mean there. `means` are the two
    /// functions'.
    fn square(&self, on_level: usize, square: usize, means: [f32; 2], out: &mut [f32]) -> f32 {
        match [0, 1].map(|which| self.occupied[which].at(on_level, square)) {
            [false, false] => {}
            [true, false] => self.scale(0, on_level, square, means[1], out),
            [false, true] => self.scale(1, on_level, square, means[0], out),
            [true, true] => {
                let size = (on_level as f32).sqrt();
                let finer = [0, 1].map(|which| {
                    let detail = |kind: usize| size * self.vectors[which][kind * on_level + square];
                    quarters(means[which], [detail(1), detail(2), detail(3)])
                });
                let mut product = [0.0; 4];
                for (quarter, value) in product.iter_mut().enumerate() {
                    let means = [finer[0][quarter], finer[1][quarter]];
                    *value = self.square(4 * on_level, square + quarter * on_level, means, out);
                }
                let [a, b, c, d] = product.map(|value| 0.25 * value);
                out[on_level + square] = (a - b + c - d) / size;
                out[2 * on_level + square] = (a + b - c - d) / size;
                out[3 * on_level + square] = (a - b - c + d) / size;
                return a + b + c + d;
            }
        }
        means[0] * means[1]
    }

    /// Where the other function is a number.
    fn scale(&self, which: usize, on_level: usize, square: usize, factor: f32, out: &mut [f32]) {
        for kind in 1..4 {
            out[kind * on_level + square] = factor * self.vectors[which][kind * on_level + square];
        }
        for quarter in 0..4 {
            let within = square + quarter * on_level;
            if self.occupied[which].at(4 * on_level, within) {
                self.scale(which, 4 * on_level, within, factor, out);
            }
        }
    }
}

/// Values of a square's quarters from its mean and its differences, those times the wavelets' height.
fn quarters(mean: f32, [across, down, both]: [f32; 3]) -> [f32; 4] {
    [mean + across + down + both, mean - across + down - both, mean + across - down - both, mean - across - down + both]
}
