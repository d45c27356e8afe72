//! The square before a light, and spheres as discs on it [Meunier2009, 5.3, figure 8].
//!
//! The paper puts a unit square before the cone of the light, at a distance where the cone just fits, and projects blockers
//! onto its plane. Seen from the receiver a sphere is a cap of directions; on a plane that is an ellipse, on the sphere's
//! stereographic projection from the direction opposite to the light's it is exactly a disc. For the cap of axis s and angular
//! radius β about a light of direction a, with `A = s·a + cos β`,
//!
//! ```text
//! centre = (s·t, s·b)/A        radius = sin β/A        the light itself: 0 and tan(σ/2)
//! ```
//!
//! Both projections agree for small lights, and this one has no end at a right angle. Lengths are in radii of the light's
//! disc.

use super::mask::Disc;
use crate::shared::vector::dot;
use wide::f32x8;

/// Discs grow no larger than this, in units of the projection: their edge is as good as straight.
const STRAIGHT: f32 = 1e3;

/// Where one receiver sees one light.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Square {
    /// Tangent, bitangent, and the direction of the light.
    frame: [[f32; 3]; 3],
    /// tan(σ/2).
    extent: f32,
    /// Sine of the light's angular radius σ.
    pub(crate) sine: f32,
    /// Distance of the light's centre, and of the circle in which it is seen.
    center: f32,
    reach: f32,
}

impl Square {
    /// The square before a light with its centre at `offset` from the receiver; `None` from within it, or if it has no size.
    pub(crate) fn new(offset: [f32; 3], radius: f32) -> Option<Self> {
        let [x, y, z] = offset;
        let squared = x.mul_add(x, y.mul_add(y, z * z));
        let reach_squared = squared - radius * radius;
        if !(reach_squared > 0.0 && radius > 0.0 && squared.is_finite()) {
            return None;
        }
        let inverse = squared.sqrt().recip();
        let axis = offset.map(|x| x * inverse);
        let sine = (radius * inverse).min(1.0);
        let cosine = reach_squared.sqrt() * inverse;
        let extent = (sine / (1.0 + cosine)).max(1e-6);
        Some(Self { frame: frame_about(axis), extent, sine, center: inverse.recip(), reach: reach_squared.sqrt() })
    }

    /// The square before a light infinitely far away; `None` if it has no size.
    pub(crate) fn far(direction: [f32; 3], sine: f32) -> Option<Self> {
        Some(Self { center: f32::INFINITY, reach: f32::INFINITY, ..Self::new(direction, sine)? })
    }

    /// The square over half of all directions: those about the third of three axes at right angles.
    pub(crate) fn hemisphere(frame: [[f32; 3]; 3]) -> Self {
        Self { frame, extent: 1.0, sine: 1.0, center: f32::INFINITY, reach: f32::INFINITY }
    }

    /// Direction of the light's centre.
    pub(crate) fn axis(&self) -> [f32; 3] {
        self.frame[2]
    }

    /// `dist` of [Meunier2009, 5.3] for a square of side 1, `1/(2 tan σ)`.
    pub(crate) fn distance(&self) -> f32 {
        0.5 * (1.0 - self.sine * self.sine).sqrt() / self.sine.max(1e-6)
    }

    /// `1 - cos σ`.
    pub(crate) fn versine(&self) -> f32 {
        self.sine * self.sine / (1.0 + (1.0 - self.sine * self.sine).sqrt())
    }

    /// How far the light begins along directions of these cosines to its centre's; past its edge as at its edge.
    #[inline(always)]
    fn surface(&self, cosine: f32x8) -> f32x8 {
        if self.reach == f32::INFINITY {
            return f32x8::splat(f32::INFINITY);
        }
        let (along, reach_squared) = (cosine * f32x8::splat(self.center), f32x8::splat(self.reach * self.reach));
        let under = along.mul_sub(along, reach_squared);
        let meets = cosine.simd_gt(f32x8::ZERO) & under.simd_gt(f32x8::ZERO);
        meets.select(reach_squared / (along + under.fast_max(f32x8::ZERO).sqrt()), f32x8::splat(self.reach))
    }

    /// Eight spheres on the square: centres and radii of discs, and which of them are in the way of the light, which begins
    /// at `end` behind each of them, or else where it does.
    ///
    /// A sphere behind the light is not. One that begins before it and whose own silhouette lies beyond it shrinks on the
    /// way, so that nothing jumps.
    #[inline(always)]
    fn splat(&self, offset: &[f32x8; 3], radius: f32x8, end: Option<f32x8>) -> ([f32x8; 3], f32x8) {
        let [t, b, a] = self.frame.map(|axis| dot(&axis.map(f32x8::splat), offset));
        let squared = dot(&[t, b, a], &[t, b, a]).fast_max(f32x8::splat(f32::MIN_POSITIVE));
        let distance = squared.sqrt();
        let inverse = f32x8::ONE / distance;
        let end = end.unwrap_or_else(|| self.surface(a * inverse));
        let rim = (squared - radius * radius).fast_max(f32x8::ZERO).sqrt();
        let near = distance - radius;
        let begun = (end - near) / (rim - near).fast_max(distance * f32x8::splat(1e-6));
        let radius = radius * begun.fast_max(f32x8::ZERO).fast_min(f32x8::ONE);
        let (t, b, a) = (t * inverse, b * inverse, a * inverse);
        let sine = (radius * inverse).fast_min(f32x8::ONE);
        let cosine = (f32x8::ONE - sine * sine).sqrt();
        let denominator = a + cosine;
        let scale = f32x8::splat(self.extent.recip());
        let per_denominator = scale / denominator.fast_max(f32x8::splat(1e-3));
        let mut disc = [t * per_denominator, b * per_denominator, sine * per_denominator];
        let wide = denominator.simd_lt(f32x8::splat(1e-3));
        if wide.any() {
            // The cap reaches the opposite direction: what is near the light has an edge as good as straight, at
            // tan((γ-β)/2).
            let across = t.mul_add(t, b * b).sqrt();
            let edge = across.mul_sub(cosine, a * sine)
                / (f32x8::ONE + a.mul_add(cosine, across * sine)).fast_max(f32x8::splat(1e-6));
            // Straight behind, any side will do: the edge is far away.
            let behind = across.simd_lt(f32x8::splat(1e-6));
            let inverse = f32x8::ONE / across.fast_max(f32x8::splat(1e-6));
            let center = (edge + f32x8::splat(STRAIGHT)) * scale;
            let [t, b] = [behind.select(f32x8::ONE, t * inverse), behind.select(f32x8::ZERO, b * inverse)];
            let straight = [t * center, b * center, f32x8::splat(STRAIGHT) * scale];
            disc = std::array::from_fn(|i| wide.select(straight[i], disc[i]));
        }
        let [x, y, r] = disc;
        let reach = r + f32x8::ONE;
        let meets = x.mul_add(x, y * y).simd_lt(reach * reach) & sine.simd_gt(f32x8::ZERO);
        (disc, meets)
    }

    /// Calls with the disc of each of eight spheres that is in the way of the light.
    #[inline(always)]
    pub(crate) fn each_disc(&self, offset: &[f32x8; 3], radius: f32x8, work: impl FnMut(Disc)) {
        self.each_disc_before(None, offset, radius, work);
    }

    /// The same, where light begins at `end` behind each of the spheres.
    #[inline(always)]
    pub(crate) fn each_disc_before(
        &self,
        end: Option<f32x8>,
        offset: &[f32x8; 3],
        radius: f32x8,
        mut work: impl FnMut(Disc),
    ) {
        let (found, meets) = self.splat(offset, radius, end);
        let mut bits = meets.to_bitmask();
        if bits == 0 {
            return;
        }
        let [x, y, r] = found.map(f32x8::to_array);
        while bits != 0 {
            let lane = bits.trailing_zeros() as usize;
            work(Disc { center: [x[lane], y[lane]], radius: r[lane] });
            bits &= bits - 1;
        }
    }

    /// Eight points of the square as unit directions.
    #[inline(always)]
    pub(crate) fn directions(&self, x: f32x8, y: f32x8) -> [f32x8; 3] {
        let (x, y) = (x * f32x8::splat(self.extent), y * f32x8::splat(self.extent));
        let squared = x.mul_add(x, y * y);
        let inverse = f32x8::ONE / (f32x8::ONE + squared);
        let (t, b, a) =
            (x * inverse * f32x8::splat(2.0), y * inverse * f32x8::splat(2.0), (f32x8::ONE - squared) * inverse);
        std::array::from_fn(|i| dot(&self.frame.map(|axis| f32x8::splat(axis[i])), &[t, b, a]))
    }

    /// Length in directions per length on the square, `2 tan(σ/2)/(1 + |x|²)`, at eight points.
    #[inline(always)]
    pub(crate) fn stretch(&self, x: f32x8, y: f32x8) -> f32x8 {
        let extent = f32x8::splat(self.extent);
        let squared = x.mul_add(x, y * y) * extent * extent;
        (extent + extent) / (f32x8::ONE + squared)
    }
}

/// A frame about a unit axis that turns with it smoothly except straight down, where lights seldom are: a square that
/// turns at once would show.
fn frame_about(axis: [f32; 3]) -> [[f32; 3]; 3] {
    let [x, y, z] = axis;
    // 1 + y without the digits that it would lose near -1.
    let down = if y < 0.0 { x.mul_add(x, z * z) / (1.0 - y) } else { 1.0 + y };
    if down < 1e-5 {
        return [[1.0, 0.0, 0.0], [0.0, 0.0, 1.0], axis];
    }
    let inverse = down.recip();
    let mixed = -x * z * inverse;
    [[1.0 - x * x * inverse, -x, mixed], [mixed, -z, 1.0 - z * z * inverse], axis]
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::shared::test_scenes::random;
    use glam::{DVec3, Vec3};

    fn splat_one(square: &Square, offset: DVec3, radius: f32) -> ([f32; 3], bool) {
        let (disc, meets) = square.splat(&offset.as_vec3().to_array().map(f32x8::splat), f32x8::splat(radius), None);
        (disc.map(|value| value.to_array()[3]), meets.to_array()[3].to_bits() != 0)
    }

    /// A direction lies in the cap exactly where its point lies in the disc.
    #[test]
    fn caps_are_discs() {
        let mut random = random(3);
        let mut vector = |length: f64| {
            DVec3::new(f64::from(random()), f64::from(random()), f64::from(random())).normalize_or(DVec3::Y) * length
        };
        let (mut inside, mut checked) = (0, 0);
        for number in 0..400 {
            // Far away, so that no sphere lies behind where the light begins.
            let light = vector(1.0);
            let square = Square::far(light.as_vec3().to_array(), [0.02, 0.2, 0.6, 0.98][number % 4]).unwrap();
            let offset = vector(2.0);
            let radius = [0.2f32, 1.0, 1.9, 1.999][number / 4 % 4];
            let ([x, y, r], _) = splat_one(&square, offset, radius);
            let cosine = (1.0 - f64::from(radius * radius) / 4.0).sqrt();
            for step in 0..64 {
                let (px, py) = ((step % 8) as f32 / 3.5 - 1.0, (step / 8) as f32 / 3.5 - 1.0);
                let direction =
                    square.directions(f32x8::splat(px), f32x8::splat(py)).map(|v| f64::from(v.to_array()[0]));
                let direction = DVec3::from(direction);
                assert!((direction.length() - 1.0).abs() < 1e-5);
                let off = direction.dot(offset.normalize()) - cosine;
                let within = (px - x).hypot(py - y) - r;
                // Not where both are a matter of rounding, nor where an edge is taken for straight.
                if off.abs() > 2e-3 && r < 100.0 {
                    checked += 1;
                    inside += usize::from(off > 0.0);
                    assert_eq!(off > 0.0, within < 0.0, "{offset} {radius} in {square:?}: {off} {within}");
                }
            }
        }
        assert!(checked > 15_000 && inside > 3_000, "{checked} {inside}");
    }

    #[test]
    fn spheres_behind_the_light_or_beside_it_are_not_in_the_way() {
        let square = Square::new([0.0, 5.0, 0.0], 1.0).unwrap();
        let meets = |y: f64, x: f64, radius: f32| splat_one(&square, DVec3::new(x, y, 0.0), radius).1;
        assert!(meets(2.0, 0.0, 0.3) && !meets(7.0, 0.0, 0.3) && !meets(2.0, 1.0, 0.3) && !meets(-2.0, 0.0, 0.3));
        // On the way past the light a disc shrinks steadily.
        let radii: Vec<f32> =
            (0..200).map(|i| splat_one(&square, DVec3::new(0.0, 4.0 + f64::from(i) * 0.01, 0.0), 0.4).0[2]).collect();
        assert!(radii.windows(2).all(|pair| (pair[0] - pair[1]).abs() < 0.2) && radii[199] == 0.0);
        assert!(Square::new([0.0, 0.5, 0.0], 1.0).is_none() && Square::new([0.0; 3], 0.0).is_none());
    }

    #[test]
    fn frames_are_orthonormal_and_turn_smoothly() {
        let mut random = random(9);
        for _ in 0..100 {
            let axis = DVec3::new(f64::from(random()), f64::from(random()), f64::from(random())).normalize_or(DVec3::X);
            let [t, b, a] = frame_about(axis.as_vec3().to_array());
            let dot = |a, b| Vec3::from_array(a).dot(Vec3::from_array(b));
            assert!(dot(t, b).abs() < 1e-3 && dot(t, a).abs() < 1e-3 && dot(b, a).abs() < 1e-3);
            assert!((dot(t, t) - 1.0).abs() < 1e-3 && (dot(b, b) - 1.0).abs() < 1e-3);
        }
        assert_eq!(frame_about([0.0, -1.0, 0.0])[2], [0.0, -1.0, 0.0]);
    }
}
