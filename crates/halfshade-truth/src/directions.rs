//! Directions from points of the unit square: cosine-weighted over a hemisphere, uniform over a cap.
//!
//! Written without branches and in single precision, so that loops over a batch fill the vector units.

use glam::{DVec3, Vec3};

/// Two unit vectors that complete a unit vector to a right-handed orthonormal frame (\[Duff2017\]).
#[inline]
pub(crate) fn tangents(axis: DVec3) -> [DVec3; 2] {
    let sign = 1.0_f64.copysign(axis.z);
    let a = -1.0 / (sign + axis.z);
    let b = axis.x * axis.y * a;
    [
        DVec3::new(1.0 + sign * axis.x * axis.x * a, sign * b, -sign * axis.x),
        DVec3::new(b, sign + axis.y * axis.y * a, -axis.y),
    ]
}

/// A frame in single precision: two tangents and the axis.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Axes {
    pub(crate) tangent: Vec3,
    pub(crate) bitangent: Vec3,
    pub(crate) axis: Vec3,
}

impl Axes {
    pub(crate) fn around(axis: DVec3) -> Self {
        let [tangent, bitangent] = tangents(axis);
        Self { tangent: tangent.as_vec3(), bitangent: bitangent.as_vec3(), axis: axis.as_vec3() }
    }

    /// The direction `sin_polar · (cos φ tangent + sin φ bitangent) + cos_polar · axis` with φ = 2π `turn`.
    #[inline(always)]
    pub(crate) fn direction(&self, sin_polar: f32, cos_polar: f32, turn: f32) -> [f32; 3] {
        let (sin, cos) = sin_cos_turns(turn);
        let (x, y) = (sin_polar * cos, sin_polar * sin);
        [
            x * self.tangent.x + y * self.bitangent.x + cos_polar * self.axis.x,
            x * self.tangent.y + y * self.bitangent.y + cos_polar * self.axis.y,
            x * self.tangent.z + y * self.bitangent.z + cos_polar * self.axis.z,
        ]
    }
}

/// Sine and cosine of 2π `turn` for `turn` in [0, 1]; absolute error below 2e-7.
#[inline(always)]
pub(crate) fn sin_cos_turns(turn: f32) -> (f32, f32) {
    let quarters = 4.0 * turn;
    let nearest = (quarters + 0.5).floor();
    let x = (quarters - nearest) * std::f32::consts::FRAC_PI_2;
    let x2 = x * x;
    // Taylor series on [-π/4, π/4]: the next terms are below 4e-9 and 3e-8.
    let sin = x * (1.0 + x2 * (-1.0 / 6.0 + x2 * (1.0 / 120.0 + x2 * (-1.0 / 5040.0 + x2 * (1.0 / 362_880.0)))));
    let cos = 1.0 + x2 * (-0.5 + x2 * (1.0 / 24.0 + x2 * (-1.0 / 720.0 + x2 * (1.0 / 40_320.0))));
    let quadrant = nearest as i32 & 3;
    let (s, c) = if quadrant & 1 == 0 { (sin, cos) } else { (cos, sin) };
    (if quadrant & 2 == 0 { s } else { -s }, if (quadrant + 1) & 2 == 0 { c } else { -c })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn sines_and_cosines_agree_with_the_standard_library() {
        for i in 0..=100_000 {
            let turn = i as f32 / 100_000.0;
            let (sin, cos) = sin_cos_turns(turn);
            let (s, c) = (std::f64::consts::TAU * f64::from(turn)).sin_cos();
            assert!((f64::from(sin) - s).abs() < 2e-7 && (f64::from(cos) - c).abs() < 2e-7, "{turn}");
        }
    }

    #[test]
    fn frames_are_orthonormal() {
        for i in 0..1000 {
            let z = -1.0 + 2.0 * f64::from(i) / 999.0;
            let (sin, cos) = f64::from(i).sin_cos();
            let axis = DVec3::new(cos * (1.0 - z * z).sqrt(), sin * (1.0 - z * z).sqrt(), z);
            let [t, b] = tangents(axis);
            assert!(t.cross(b).distance(axis) < 1e-12 && t.dot(b).abs() < 1e-12 && (t.length() - 1.0).abs() < 1e-12);
        }
    }
}
