//! Eight points of light space in the space of an object, and in the coordinates of its shells.

use std::f32::consts::FRAC_1_PI;
use wide::f32x8;

/// Points relative to `center` along the axes of the object, without its scale; the rotation is given row by row.
#[inline(always)]
pub(crate) fn object_axes(position: &[f32x8; 3], center: &[f32; 3], object_from_light: &[[f32; 3]; 3]) -> [f32x8; 3] {
    let offset: [f32x8; 3] = std::array::from_fn(|axis| position[axis] - f32x8::splat(center[axis]));
    object_from_light.map(|row| {
        let [a, b, c] = row.map(f32x8::splat);
        a.mul_add(offset[0], b.mul_add(offset[1], c * offset[2]))
    })
}

/// Distance from the centre in radii of the object, longitude and latitude as shares of the whole, from [`object_axes`].
#[inline(always)]
pub(crate) fn shell_coordinates([x, y, z]: [f32x8; 3], inverse_radius: f32) -> [f32x8; 3] {
    let distance = (x * x + y * y + z * z).sqrt();
    let cosine = y / distance.fast_max(f32x8::splat(f32::MIN_POSITIVE));
    let polar = cosine.fast_max(-f32x8::ONE).fast_min(f32x8::ONE).acos();
    let v = polar * f32x8::splat(FRAC_1_PI);
    let u = z.atan2(x) * f32x8::splat(0.5 * FRAC_1_PI);
    [distance * f32x8::splat(inverse_radius), u, v]
}
