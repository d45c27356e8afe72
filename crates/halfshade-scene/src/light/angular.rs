//! Angular maps: the whole sphere of directions in a disc, radius proportional to the angle from its centre.

use super::EnvironmentMap;
use super::image_file::Image;
use glam::{Vec2, Vec3};
use std::f32::consts::{PI, TAU};

/// Subdivisions of a texel per axis; the mean over a texel is taken of so many squared samples.
const SAMPLES_PER_AXIS: usize = 4;

/// The latitude-longitude map of a square angular map of `n` by `n` texels, of 2n by n texels.
///
/// A direction at angle θ from the image's centre lies at radius r = θ/π of the disc inscribed in the square
/// (\[Debevec1998\]). Right of the centre is to the right of one who looks toward the centre from inside, up is up; the
/// centre looks `forward` radians from -Z toward +X. Texels whose centres lie outside of the disc are never read:
/// probes carry captions there. Each texel is the mean of samples of equal solid angle, so that the mean over all
/// directions is kept up to sampling (below 1 % for real probes).
pub(super) fn from_angular(image: &Image, forward: f32) -> Option<EnvironmentMap> {
    let n = image.width;
    let (width, height) = (2 * n, n);
    let mut texels = Vec::with_capacity(width * height);
    for row in 0..height {
        for column in 0..width {
            let mut sum = Vec3::ZERO;
            for i in 0..SAMPLES_PER_AXIS * SAMPLES_PER_AXIS {
                let (across, down) = (i % SAMPLES_PER_AXIS, i / SAMPLES_PER_AXIS);
                let share = |part: usize| (part as f32 + 0.5) / SAMPLES_PER_AXIS as f32;
                let azimuth = ((column as f32 + share(across)) / width as f32 - 0.5) * TAU - forward;
                let edge = |row: usize| (PI * row as f32 / height as f32).cos();
                let y = edge(row) + (edge(row + 1) - edge(row)) * share(down);
                let horizontal = (1.0 - y * y).max(0.0).sqrt();
                let direction = Vec3::new(horizontal * azimuth.sin(), y, -horizontal * azimuth.cos());
                // Divided before they are added up, so that no sum of finite ones is infinite.
                sum += texel_toward(image, direction) / (SAMPLES_PER_AXIS * SAMPLES_PER_AXIS) as f32;
            }
            texels.push(sum);
        }
    }
    EnvironmentMap::new(width, height, texels)
}

/// The texel of an angular map toward unit `direction`, its centre being -Z.
fn texel_toward(image: &Image, direction: Vec3) -> Vec3 {
    let n = image.width as f32;
    let around = Vec2::new(direction.x, direction.y);
    // atan2 instead of acos: exact near the centre and near the rim.
    let radius = around.length().atan2(-direction.z) / PI;
    let outward = around.normalize_or(Vec2::X);
    let index = |radius: f32| {
        let disc = radius * outward;
        [0.5 * (1.0 + disc.x), 0.5 * (1.0 - disc.y)].map(|t| ((t * n) as usize).min(image.width - 1))
    };
    let in_disc = |[column, row]: [usize; 2]| {
        let center = |i: usize| 2.0 * (i as f32 + 0.5) / n - 1.0;
        Vec2::new(center(column), center(row)).length() <= 1.0
    };
    let mut texel = index(radius);
    if !in_disc(texel) {
        // One and a half texels inward a texel's centre is inside for sure.
        texel = index((1.0 - 3.0 / n).clamp(0.0, radius));
    }
    image.texels[texel[1] * image.width + texel[0]]
}

#[cfg(test)]
mod tests {
    use super::*;
    use glam::DVec3;

    /// An angular map of `radiance`, with something unusable outside of the disc.
    fn painted(n: usize, radiance: impl Fn(Vec3) -> Vec3) -> Image {
        let coordinate = |i: usize| 2.0 * (i as f32 + 0.5) / n as f32 - 1.0;
        let texel = |i: usize| {
            let disc = Vec2::new(coordinate(i % n), -coordinate(i / n));
            let angle = PI * disc.length();
            let around = disc.normalize_or_zero() * angle.sin();
            if disc.length() <= 1.0 { radiance(around.extend(-angle.cos())) } else { Vec3::splat(1e9) }
        };
        Image { width: n, height: n, texels: (0..n * n).map(texel).collect() }
    }

    #[test]
    fn the_largest_radiance_stays_finite() {
        let map = from_angular(&painted(4, |_| Vec3::splat(f32::MAX)), 0.3).unwrap();
        assert!(map.texels().iter().all(|texel| *texel == Vec3::splat(f32::MAX)), "{:?}", map.texels());
    }

    #[test]
    fn directions_come_back_where_they_were_painted() {
        let radiance = |d: Vec3| Vec3::ONE + d;
        let map = from_angular(&painted(128, radiance), 0.0).unwrap();
        for direction in
            [Vec3::X, Vec3::Y, Vec3::NEG_Y, Vec3::NEG_Z, Vec3::new(0.6, 0.48, 0.64), Vec3::new(-0.1, 0.1, 1.0)]
        {
            let direction = direction.normalize();
            assert!(map.radiance(direction).distance(radiance(direction)) < 0.08, "{direction}");
        }
        let turned = from_angular(&painted(128, radiance), PI / 2.0).unwrap();
        assert!(turned.radiance(Vec3::X).distance(radiance(Vec3::NEG_Z)) < 0.08);
        assert!(turned.radiance(Vec3::Z).distance(radiance(Vec3::X)) < 0.08);
    }

    #[test]
    fn the_mean_over_all_directions_is_kept_and_the_corners_are_masked() {
        let map = from_angular(&painted(64, |d| Vec3::new(1.0, d.y.max(0.0), d.z * d.z)), 0.3).unwrap();
        assert!(map.mean_radiance().distance(DVec3::new(1.0, 0.25, 1.0 / 3.0)) < 2e-3, "{}", map.mean_radiance());
    }
}
