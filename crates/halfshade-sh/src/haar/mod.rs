//! Haar wavelets on the faces of a cube [Guerrero2007, 3.4], after \[Ng2004\].
//!
//! A function of direction is constant on every texel of a [`cube`] map. On each face, seen as a unit square, it is a sum
//! of 2D Haar wavelets: orthonormal over the square (not over the sphere, on which texels differ in size), made by
//! [`transform`]. Few of their coefficients hold what many spherical harmonics can't: an edge.
//!
//! A face of `4^L` texels has as many coefficients. The scaling function, 1, has index 0; wavelet `t` (0: left less
//! right, 1: top less bottom, 2: the product of their signs) of square `s` on level `l`, `2^l` in size, has index `(1 +
//! t) 4^l + s`. Squares are numbered so that quarter `k` of square `s` on level `l` is `s + k 4^l`: the last texel
//! number has the finest quarter in front. So every level is one butterfly over contiguous memory, in place.
//!
//! [`product`] multiplies two functions without leaving the basis.

pub mod cube;
pub mod product;
pub mod transform;

#[cfg(test)]
mod tests {
    use super::{cube::Cube, product, transform};
    use rand::{RngExt, SeedableRng};
    use rand_pcg::Pcg64Mcg;

    /// A basis function at a texel by its definition, from the texel's place on the face.
    fn basis(levels: u32, index: usize, [column, row]: [f64; 2]) -> f64 {
        if index == 0 {
            return 1.0;
        }
        let level = (0..levels).rfind(|&level| index >= 1 << (2 * level)).unwrap();
        let (kind, square) = (index / (1 << (2 * level)) - 1, index % (1 << (2 * level)));
        // The square's corner: its quarters from the coarsest, which stand last in its number, to the finest.
        let (mut x, mut y) = (0.0, 0.0);
        for depth in 0..level {
            let quarter = (square >> (2 * depth)) & 3;
            x += (quarter & 1) as f64 * 0.5_f64.powi(depth as i32 + 1);
            y += (quarter >> 1) as f64 * 0.5_f64.powi(depth as i32 + 1);
        }
        let size = 0.5_f64.powi(level as i32);
        let (u, v) = ((column - x) / size, (row - y) / size);
        if !(0.0..1.0).contains(&u) || !(0.0..1.0).contains(&v) {
            return 0.0;
        }
        let sign = |x: f64| if x < 0.5 { 1.0 } else { -1.0 };
        let value = [sign(u), sign(v), sign(u) * sign(v)][kind];
        value / size
    }

    const LEVELS: u32 = 3;

    /// Values of all basis functions by texel of a face.
    fn table() -> Vec<Vec<f64>> {
        let cube = Cube::new(LEVELS);
        (0..cube.face_len())
            .map(|texel| {
                let [column, row] = cube.cell(texel).map(|x| (x as f64 + 0.5) / cube.side() as f64);
                (0..cube.face_len()).map(|index| basis(LEVELS, index, [column, row])).collect()
            })
            .collect()
    }

    fn noise(seed: u64, count: usize) -> Vec<f32> {
        let mut random = Pcg64Mcg::seed_from_u64(seed);
        (0..count).map(|_| random.random_range(-0.5..0.5)).collect()
    }

    #[test]
    fn the_definition_is_orthonormal_and_the_transform_follows_it() {
        let table = table();
        let count = table.len();
        for i in 0..count {
            for j in 0..count {
                let integral: f64 = table.iter().map(|row| row[i] * row[j]).sum::<f64>() / count as f64;
                assert!((integral - f64::from(u8::from(i == j))).abs() < 1e-12, "{i} {j}: {integral}");
            }
        }
        let coefficients = noise(1, count);
        let mut face = coefficients.clone();
        transform::inverse(&mut face);
        for (found, row) in face.iter().zip(&table) {
            let expected: f64 = row.iter().zip(&coefficients).map(|(y, c)| y * f64::from(*c)).sum();
            assert!((f64::from(*found) - expected).abs() < 1e-5, "{found} {expected}");
        }
        transform::forward(&mut face);
        assert!(face.iter().zip(&coefficients).all(|(a, b)| (a - b).abs() < 1e-6));
    }

    /// Against the sum over all tripling coefficients, ∫ Ψ_i Ψ_j Ψ_k, by quadrature over the texels.
    #[test]
    fn the_product_is_that_of_the_tripling_coefficients() {
        let table = table();
        let count = table.len();
        let (mut a, mut b) = (noise(2, count), noise(3, count));
        // Whole subtrees without wavelets, as sparse vectors have them.
        a.iter_mut().enumerate().filter(|(i, _)| i % 5 > 1).for_each(|(_, x)| *x = 0.0);
        b.iter_mut().enumerate().filter(|(i, _)| *i > 4 && i % 7 != 3).for_each(|(_, x)| *x = 0.0);
        let mut found = vec![0.0; count];
        product::product(&a, &b, &mut found);
        for (k, found) in found.iter().enumerate() {
            let mut expected = 0.0;
            for row in &table {
                let value = |list: &[f32]| row.iter().zip(list).map(|(y, c)| y * f64::from(*c)).sum::<f64>();
                expected += value(&a) * value(&b) * row[k] / count as f64;
            }
            assert!((f64::from(*found) - expected).abs() < 1e-5, "{k}: {found} {expected}");
        }
    }

    #[test]
    fn few_tripling_coefficients_are_not_zero() {
        // [Ng2004]: all three the scaling function; the same square and three kinds; or two the same and one that
        // contains them.
        let table = table();
        let triple = |i: usize, j: usize, k: usize| {
            table.iter().map(|row| row[i] * row[j] * row[k]).sum::<f64>() / table.len() as f64
        };
        assert!((triple(0, 0, 0) - 1.0).abs() < 1e-12);
        let at = |level: u32, kind: usize, square: usize| (1 + kind) * (1 << (2 * level)) + square;
        let three = triple(at(2, 0, 5), at(2, 1, 5), at(2, 2, 5));
        assert!((three - 4.0).abs() < 1e-12, "2^l: {three}");
        assert!(triple(at(2, 0, 5), at(2, 1, 5), at(2, 1, 5)).abs() < 1e-12);
        // Square 5 on level 2 is a quarter of square 1 on level 1.
        assert!((triple(at(2, 0, 5), at(2, 0, 5), at(1, 0, 1)).abs() - 2.0).abs() < 1e-12);
        assert!(triple(at(2, 0, 5), at(2, 0, 5), at(1, 0, 2)).abs() < 1e-12);
    }

    #[test]
    fn edges_take_few_wavelets() {
        let cube = Cube::new(5);
        let mut blocked: Vec<f32> =
            (0..cube.len()).map(|texel| f32::from(u8::from(cube.direction(texel, [0.5, 0.5])[2] > 0.9))).collect();
        let exact = blocked.clone();
        for face in blocked.chunks_exact_mut(cube.face_len()) {
            transform::forward(face);
        }
        let mut order: Vec<usize> = (0..blocked.len()).collect();
        order.sort_by(|&i, &j| blocked[j].abs().total_cmp(&blocked[i].abs()));
        order[cube.len() / 20..].iter().for_each(|&i| blocked[i] = 0.0);
        for face in blocked.chunks_exact_mut(cube.face_len()) {
            transform::inverse(face);
        }
        let off: f32 = blocked.iter().zip(&exact).map(|(a, b)| (a - b).abs()).sum::<f32>() / cube.len() as f32;
        assert!(off < 1e-3, "{off}");
    }
}
