//! From the texels of an object's cube to those of the light's: wavelets don't turn, texels are looked up.

use super::projection::HaarBasis;
use halfshade_sh::haar::cube::Cube;

/// Per texel of the light's cube four texels of the object's, and what faces they are on.
#[derive(Debug)]
pub(super) struct Turn {
    /// `None` where both cubes are the same.
    sources: Option<Vec<[u16; 4]>>,
    /// Per face of the light's cube the faces of the object's that it meets: bits.
    meets: [u8; 6],
}

impl Turn {
    /// By the rotation from light space to object space, row by row.
    pub(super) fn new(basis: &HaarBasis, object_from_light: [[f32; 3]; 3]) -> Self {
        let cube = basis.cube;
        let rows = object_from_light.map(|row| row.map(f64::from));
        let source = |texel, share| {
            let direction = cube.direction(texel, share);
            let turned = rows.map(|row| row.iter().zip(direction).map(|(a, b)| a * b).sum());
            cube.texel_toward(turned) as u16
        };
        let shares = [[0.25, 0.25], [0.75, 0.25], [0.25, 0.75], [0.75, 0.75]];
        let sources: Vec<[u16; 4]> = (0..cube.len()).map(|texel| shares.map(|share| source(texel, share))).collect();
        let mut meets = [0; 6];
        for (texel, four) in sources.iter().enumerate() {
            for &source in four {
                meets[texel / cube.face_len()] |= 1 << (usize::from(source) / cube.face_len());
            }
        }
        let is_same = sources.iter().enumerate().all(|(texel, four)| four.iter().all(|&i| usize::from(i) == texel));
        Self { sources: (!is_same).then_some(sources), meets }
    }

    /// Whether a face of the light's cube meets any of these faces of the object's.
    pub(super) fn meets(&self, face: usize, faces: u8) -> bool {
        self.meets[face] & faces != 0
    }

    /// Hands out, for each texel of a face of the light's cube, what the object's texels hold: the mean of four.
    #[inline(always)]
    pub(super) fn each(&self, cube: Cube, face: usize, object: &[f32], mut use_value: impl FnMut(usize, f32)) {
        let first = face * cube.face_len();
        match &self.sources {
            None => {
                for (k, value) in object[first..first + cube.face_len()].iter().enumerate() {
                    use_value(k, *value);
                }
            }
            Some(sources) => {
                for (k, four) in sources[first..first + cube.face_len()].iter().enumerate() {
                    let [a, b, c, d] = four.map(|source| object[usize::from(source)]);
                    use_value(k, 0.25 * ((a + b) + (c + d)));
                }
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::{super::super::settings::Coding, *};
    use glam::{Mat3, Vec3};

    #[test]
    fn a_turned_function_is_looked_up() {
        let basis = HaarBasis::new(32, 0.05, Coding::Tree);
        let cube = basis.cube;
        let smooth = |direction: Vec3| 1.0 + direction.x + 0.5 * direction.y * direction.z;
        let object: Vec<f32> = basis.directions.iter().map(|&direction| smooth(direction)).collect();
        let rotation = Mat3::from_axis_angle(Vec3::new(0.6, 0.0, 0.8), 0.7);
        for (rotation, bound) in [(rotation, 0.05), (Mat3::IDENTITY, 0.0), (Mat3::from_rotation_y(0.3), 0.05)] {
            let turn = Turn::new(&basis, rotation.transpose().to_cols_array_2d());
            for face in 0..6 {
                turn.each(cube, face, &object, |k, value| {
                    let exact = smooth(rotation * basis.directions[face * cube.face_len() + k]);
                    assert!((value - exact).abs() <= bound, "{value} {exact}");
                });
            }
        }
        assert!(Turn::new(&basis, Mat3::IDENTITY.to_cols_array_2d()).sources.is_none());
    }
}
