//! A light-box: soft coloured area lights in a dim room, as a map.

use crate::Environment;
use crate::light::EnvironmentMap;
use glam::Vec3;

const WIDTH: usize = 128;
const HEIGHT: usize = 64;

/// A rectangular light as seen from the scene, soft at its edges.
struct Panel {
    /// Where its middle stands: azimuth in degrees from -Z toward +X, and elevation.
    azimuth: f32,
    elevation: f32,
    /// Half its width and height in degrees.
    half_size: [f32; 2],
    /// Width in degrees over which its edge fades.
    softness: f32,
    radiance: [f32; 3],
}

const PANELS: [Panel; 4] = [
    // A tall window on the left, daylight.
    Panel { azimuth: -100.0, elevation: 32.0, half_size: [20.0, 26.0], softness: 10.0, radiance: [4.9, 5.5, 6.4] },
    // A softbox high behind the camera, a little to the right.
    Panel { azimuth: 155.0, elevation: 50.0, half_size: [26.0, 14.0], softness: 12.0, radiance: [1.6, 1.4, 1.15] },
    // A warm lamp behind the scene on the right: the most coloured of the shadows.
    Panel { azimuth: 48.0, elevation: 30.0, half_size: [11.0, 11.0], softness: 6.0, radiance: [6.6, 3.6, 1.4] },
    // A faint blue reflector low on the right.
    Panel { azimuth: 105.0, elevation: 8.0, half_size: [22.0, 18.0], softness: 12.0, radiance: [0.35, 0.5, 0.8] },
];

/// A dim room with a daylight window, a softbox, a warm lamp and a cool reflector; radiances range over about 60 : 1.
///
/// Every edge fades over several degrees: most of this light lies in the first bands of spherical harmonics, so what is
/// left of a method's error comes from its visibility and not from the light. Constant below the horizon, where the
/// ground boxes of the built-in scenes hide it anyway.
pub fn studio() -> Environment {
    let texels = (0..HEIGHT)
        .flat_map(|row| (0..WIDTH).map(move |column| (column, row)))
        .map(|(column, row)| {
            let azimuth = ((column as f32 + 0.5) / WIDTH as f32 - 0.5) * 360.0;
            let elevation = 90.0 - (row as f32 + 0.5) / HEIGHT as f32 * 180.0;
            radiance(azimuth, elevation)
        })
        .collect();
    EnvironmentMap::new(WIDTH, HEIGHT, texels).map_or(Environment::constant(Vec3::ONE), Environment::map)
}

fn radiance(azimuth: f32, elevation: f32) -> Vec3 {
    let (floor, wall, ceiling) =
        (Vec3::new(0.10, 0.09, 0.08), Vec3::new(0.12, 0.12, 0.13), Vec3::new(0.17, 0.17, 0.18));
    let room = floor.lerp(wall, smooth_step(-20.0, 5.0, elevation)).lerp(ceiling, smooth_step(30.0, 70.0, elevation));
    PANELS.iter().fold(room, |sum, panel| {
        // Shrink azimuths toward the zenith so that a panel keeps its width on the sphere.
        let turn = (azimuth - panel.azimuth + 540.0).rem_euclid(360.0) - 180.0;
        let across = turn.abs() * elevation.to_radians().cos();
        let inside = |distance: f32, half: f32| {
            1.0 - smooth_step(half - 0.5 * panel.softness, half + 0.5 * panel.softness, distance)
        };
        let weight =
            inside(across, panel.half_size[0]) * inside((elevation - panel.elevation).abs(), panel.half_size[1]);
        sum + weight * Vec3::from(panel.radiance)
    })
}

fn smooth_step(low: f32, high: f32, x: f32) -> f32 {
    let t = ((x - low) / (high - low)).clamp(0.0, 1.0);
    t * t * (3.0 - 2.0 * t)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_studio_spans_a_high_range_without_hard_edges() {
        let mut darkest = f32::INFINITY;
        let mut brightest = 0f32;
        let mut steepest = 0f32;
        for i in 0..3600 {
            for elevation in -89..90 {
                let here = radiance(i as f32 * 0.1 - 180.0, elevation as f32).max_element();
                let beside = radiance(i as f32 * 0.1 - 179.9, elevation as f32).max_element();
                darkest = darkest.min(here);
                brightest = brightest.max(here);
                steepest = steepest.max((here - beside).abs());
            }
        }
        let range = brightest / darkest;
        assert!((40.0..80.0).contains(&range), "{range}");
        assert!(steepest < 0.2, "{steepest} in a tenth of a degree");
    }

    #[test]
    fn the_window_is_on_the_left() {
        let light = studio();
        let (left, right) = (light.radiance(Vec3::new(-0.85, 0.5, 0.15).normalize()), light.radiance(Vec3::X));
        assert!(left.min_element() > 4.0 && right.max_element() < 1.5, "{left} {right}");
    }
}
