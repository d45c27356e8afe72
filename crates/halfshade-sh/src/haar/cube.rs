//! The texels of a cube map, in the order in which [`transform`](super::transform) works.

/// Six faces about the origin, at distance 1, of `2^L` by `2^L` texels.
///
/// Faces look along +x, -x, +y, -y, +z, -z; columns run along the next axis in cyclic order, rows along the one after it.
/// Texels are numbered face after face.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Cube {
    levels: u32,
}

impl Cube {
    /// Most levels: a texel's number must fit into 16 bits.
    pub const MOST_LEVELS: u32 = 6;

    /// A cube with `levels` halvings of a face, at most [`MOST_LEVELS`](Self::MOST_LEVELS).
    pub const fn new(levels: u32) -> Self {
        Self { levels: if levels > Self::MOST_LEVELS { Self::MOST_LEVELS } else { levels } }
    }

    /// Texels along an edge.
    pub const fn side(&self) -> usize {
        1 << self.levels
    }

    /// Texels of a face.
    pub const fn face_len(&self) -> usize {
        1 << (2 * self.levels)
    }

    /// All texels.
    #[expect(clippy::len_without_is_empty, reason = "a cube has at least six texels")]
    pub const fn len(&self) -> usize {
        6 * self.face_len()
    }

    /// Column and row of a texel on its face.
    pub fn cell(&self, texel: usize) -> [usize; 2] {
        let (mut column, mut row) = (0, 0);
        for level in 0..self.levels {
            let quarter = (texel >> (2 * level)) & 3;
            column = 2 * column + (quarter & 1);
            row = 2 * row + (quarter >> 1);
        }
        [column, row]
    }

    /// The number of the texel on `face` in this column and row.
    fn texel(&self, face: usize, [column, row]: [usize; 2]) -> usize {
        let mut number = 0;
        for level in 0..self.levels {
            let from = self.levels - 1 - level;
            let quarter = ((column >> from) & 1) | (((row >> from) & 1) << 1);
            number |= quarter << (2 * level);
        }
        face * self.face_len() + number
    }

    /// The unit direction to a point of a texel, at shares `[0, 1]` of its width and height.
    pub fn direction(&self, texel: usize, share: [f64; 2]) -> [f64; 3] {
        let face = texel / self.face_len();
        let cell = self.cell(texel % self.face_len());
        let [s, t] = std::array::from_fn(|i| 2.0 * (cell[i] as f64 + share[i]) / self.side() as f64 - 1.0);
        let axis = face / 2;
        let mut direction = [0.0; 3];
        direction[axis] = if face.is_multiple_of(2) { 1.0 } else { -1.0 };
        direction[(axis + 1) % 3] = s;
        direction[(axis + 2) % 3] = t;
        let length = (1.0 + s * s + t * t).sqrt();
        direction.map(|x| x / length)
    }

    /// The texel that a direction, of any length but 0, points to; 0 for one that is not a number.
    pub fn texel_toward(&self, direction: [f64; 3]) -> usize {
        let size = direction.map(f64::abs);
        let axis = if size[0] >= size[1] && size[0] >= size[2] {
            0
        } else if size[1] >= size[2] {
            1
        } else {
            2
        };
        let face = 2 * axis + usize::from(direction[axis] < 0.0);
        let most = self.side() - 1;
        let cell = [1, 2].map(|next| {
            let share = 0.5 * (direction[(axis + next) % 3] / size[axis] + 1.0);
            ((share * self.side() as f64) as usize).min(most)
        });
        self.texel(face, cell)
    }

    /// Solid angle of a texel, steradian: the difference of `atan(s t / sqrt(1 + s² + t²))` over its corners.
    pub fn solid_angle(&self, texel: usize) -> f64 {
        let [column, row] = self.cell(texel % self.face_len());
        let edge = |i: usize| 2.0 * i as f64 / self.side() as f64 - 1.0;
        let corner = |s: f64, t: f64| (s * t).atan2((1.0 + s * s + t * t).sqrt());
        let [(s0, s1), (t0, t1)] = [column, row].map(|i| (edge(i), edge(i + 1)));
        corner(s1, t1) - corner(s0, t1) - corner(s1, t0) + corner(s0, t0)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::f64::consts::PI;

    #[test]
    fn texels_cover_the_sphere_once() {
        for levels in 0..=4 {
            let cube = Cube::new(levels);
            let sum: f64 = (0..cube.len()).map(|texel| cube.solid_angle(texel)).sum();
            assert!((sum - 4.0 * PI).abs() < 1e-12, "{levels}: {sum}");
            for texel in 0..cube.len() {
                for share in [[0.5, 0.5], [0.01, 0.99], [0.7, 0.2]] {
                    let direction = cube.direction(texel, share);
                    assert!((direction.iter().map(|x| x * x).sum::<f64>() - 1.0).abs() < 1e-12);
                    assert_eq!(cube.texel_toward(direction), texel);
                }
            }
        }
    }

    #[test]
    fn odd_directions_have_a_texel() {
        let cube = Cube::new(3);
        for direction in [[f64::NAN; 3], [0.0; 3], [f64::INFINITY, 1.0, 0.0], [1.0, 1.0, 1.0], [0.0, -1e-300, 0.0]] {
            assert!(cube.texel_toward(direction) < cube.len());
        }
        assert_eq!(Cube::new(40).side(), 64);
    }
}
