//! From the texels of an object's cube to those of the light's: wavelets don't rotate, texels are looked up.

use halfshade_sh::haar::cube::Cube;

/// Per texel of the light's cube four texels of the object's, and what faces they are on.
#[derive(Debug)]
pub(crate) struct TexelMap {
    /// `None` where both cubes are the same.
    sources: Option<Vec<[u16; 4]>>,
    /// Per face of the light's cube the faces of the object's that it meets: bits.
    meets: [u8; 6],
}

impl TexelMap {
    /// The map of a rotation from light space to object space, row by row.
    pub(crate) fn new(cube: Cube, object_from_light: [[f32; 3]; 3]) -> Self {
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
    pub(crate) fn meets(&self, face: usize, faces: u8) -> bool {
        self.meets[face] & faces != 0
    }

    /// The object's texels for each of the light's; `None` where both cubes are the same.
    pub(crate) fn sources(&self) -> Option<&[[u16; 4]]> {
        self.sources.as_deref()
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::shadow_field::{bake::haar::projection::HaarBasis, kernel::texels::each_remapped, settings::Coding};
    use glam::{Mat3, Vec3};

    #[test]
    fn a_turned_function_is_looked_up() {
        let basis = HaarBasis::new(32, 0.05, Coding::Tree);
        let cube = basis.cube;
        let smooth = |direction: Vec3| 1.0 + direction.x + 0.5 * direction.y * direction.z;
        let object: Vec<f32> = basis.directions.iter().map(|&direction| smooth(direction)).collect();
        let rotation = Mat3::from_axis_angle(Vec3::new(0.6, 0.0, 0.8), 0.7);
        for (rotation, bound) in [(rotation, 0.05), (Mat3::IDENTITY, 0.0), (Mat3::from_rotation_y(0.3), 0.05)] {
            let map = TexelMap::new(cube, rotation.transpose().to_cols_array_2d());
            for face in 0..6 {
                let first = face * cube.face_len();
                each_remapped([first, cube.face_len()], &object, map.sources(), |k, value| {
                    let exact = smooth(rotation * basis.directions[first + k]);
                    assert!((value - exact).abs() <= bound, "{value} {exact}");
                });
            }
        }
        assert!(TexelMap::new(cube, Mat3::IDENTITY.to_cols_array_2d()).sources.is_none());
    }
}
