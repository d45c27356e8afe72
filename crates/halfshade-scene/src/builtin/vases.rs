//! Five vases on a ground box ([Guerrero2007, 6]: 15k vertices, 20 leaf spheres, 35 clusters).

use super::choreography::{FRAME_COUNT, FRAMES_PER_SEC, keyframes, upright, wave};
use super::ground::ground;
use super::lathe::lathe;
use super::profile::spline_profile;
use super::studio;
use crate::{Camera, Mesh, Object, Scene};
use glam::Vec3;
use std::f64::consts::PI;

const SEGMENTS: usize = 48;
const PROFILE_POINTS: usize = 42;
/// Vases stand this high above the ground, so that no two faces coincide.
const GAP: f32 = 0.004;

/// One vase: its profile's control points (radius, height), glaze, place, and how it moves.
struct Vase {
    name: &'static str,
    /// Outline from the bottom's middle outward, up, over the rim, and down the throat to the middle again.
    controls: &'static [[f64; 2]],
    glaze: [f32; 3],
    /// Colour of the bands and the foot.
    trim: [f32; 3],
    /// Heights between which the trim is painted.
    bands: &'static [[f32; 2]],
    place: [f32; 2],
    slide: [f32; 2],
    phase: f64,
    /// Leaf spheres: 20 in all, more where the shape has more parts.
    spheres: usize,
}

/// Throats end a hand's breadth below the neck, where no eye and little light gets to: the solid below is what a few
/// spheres can follow.
const VASES: [Vase; 5] = [
    Vase {
        name: "amphora",
        controls: &[
            [0.0, 0.0],
            [0.17, 0.0],
            [0.21, 0.015],
            [0.19, 0.07],
            [0.14, 0.13],
            [0.24, 0.30],
            [0.40, 0.58],
            [0.45, 0.84],
            [0.36, 1.06],
            [0.17, 1.17],
            [0.125, 1.29],
            [0.135, 1.42],
            [0.20, 1.50],
            [0.225, 1.53],
            [0.205, 1.56],
            [0.15, 1.53],
            [0.09, 1.42],
            [0.085, 1.27],
            [0.08, 1.12],
            [0.0, 1.09],
        ],
        glaze: [0.72, 0.29, 0.16],
        trim: [0.12, 0.09, 0.08],
        bands: &[[-1.0, 0.10], [0.80, 0.88], [0.92, 0.95], [1.44, 2.0]],
        place: [0.0, -0.35],
        slide: [0.0, 0.12],
        phase: 0.0,
        spheres: 4,
    },
    Vase {
        name: "bottle",
        controls: &[
            [0.0, 0.0],
            [0.20, 0.0],
            [0.25, 0.01],
            [0.33, 0.10],
            [0.37, 0.26],
            [0.33, 0.43],
            [0.20, 0.55],
            [0.085, 0.66],
            [0.062, 0.86],
            [0.058, 1.06],
            [0.075, 1.18],
            [0.105, 1.225],
            [0.10, 1.25],
            [0.065, 1.23],
            [0.036, 1.15],
            [0.032, 1.0],
            [0.03, 0.84],
            [0.0, 0.82],
        ],
        glaze: [0.10, 0.38, 0.42],
        trim: [0.75, 0.70, 0.55],
        bands: &[[0.50, 0.54], [1.19, 2.0]],
        place: [-1.02, 0.06],
        slide: [0.14, 0.0],
        phase: 0.25,
        spheres: 4,
    },
    Vase {
        name: "gourd",
        controls: &[
            [0.0, 0.0],
            [0.15, 0.0],
            [0.19, 0.01],
            [0.19, 0.05],
            [0.3, 0.12],
            [0.43, 0.26],
            [0.46, 0.42],
            [0.38, 0.58],
            [0.23, 0.67],
            [0.175, 0.73],
            [0.21, 0.79],
            [0.27, 0.87],
            [0.26, 0.97],
            [0.15, 1.04],
            [0.10, 1.11],
            [0.095, 1.20],
            [0.14, 1.29],
            [0.16, 1.315],
            [0.14, 1.335],
            [0.095, 1.29],
            [0.062, 1.20],
            [0.06, 1.12],
            [0.055, 1.05],
            [0.0, 1.03],
        ],
        glaze: [0.82, 0.80, 0.74],
        trim: [0.10, 0.17, 0.45],
        bands: &[[-1.0, 0.05], [0.16, 0.20], [0.36, 0.52], [0.69, 0.77], [1.26, 2.0]],
        place: [0.70, 0.60],
        slide: [0.06, 0.05],
        phase: 0.6,
        spheres: 5,
    },
    Vase {
        name: "flute",
        controls: &[
            [0.0, 0.0],
            [0.19, 0.0],
            [0.23, 0.01],
            [0.21, 0.06],
            [0.125, 0.12],
            [0.11, 0.21],
            [0.16, 0.36],
            [0.205, 0.62],
            [0.21, 0.90],
            [0.22, 1.12],
            [0.30, 1.27],
            [0.345, 1.315],
            [0.335, 1.345],
            [0.275, 1.30],
            [0.185, 1.19],
            [0.155, 1.10],
            [0.13, 1.03],
            [0.0, 1.01],
        ],
        glaze: [0.70, 0.50, 0.14],
        trim: [0.42, 0.16, 0.10],
        bands: &[[-1.0, 0.09], [1.24, 2.0]],
        place: [1.16, -0.36],
        slide: [-0.05, 0.12],
        phase: 0.4,
        spheres: 4,
    },
    Vase {
        name: "jar",
        controls: &[
            [0.0, 0.0],
            [0.18, 0.0],
            [0.225, 0.01],
            [0.24, 0.09],
            [0.29, 0.32],
            [0.36, 0.58],
            [0.37, 0.76],
            [0.29, 0.89],
            [0.19, 0.93],
            [0.175, 0.98],
            [0.205, 1.035],
            [0.22, 1.055],
            [0.20, 1.075],
            [0.165, 1.05],
            [0.135, 0.98],
            [0.14, 0.90],
            [0.15, 0.80],
            [0.0, 0.72],
        ],
        glaze: [0.33, 0.45, 0.22],
        trim: [0.80, 0.74, 0.58],
        bands: &[[0.60, 0.63], [0.66, 0.74], [0.77, 0.80], [1.03, 2.0]],
        place: [-0.42, 0.80],
        slide: [-0.06, 0.08],
        phase: 0.85,
        spheres: 3,
    },
];

/// The scene.
pub(super) fn scene() -> Scene {
    let mut objects = vec![ground(Vec3::new(2.2, 0.15, 1.9), [72, 62], Vec3::new(0.62, 0.60, 0.56), 5)];
    objects.extend(VASES.iter().map(|vase| {
        Object::new(vase.name, mesh(vase)).sphere_count(vase.spheres).cluster_count(6).motion(keyframes(|time| {
            let swing = wave(time, 1.0, vase.phase);
            let lift = 0.03 * (1.0 - wave(time, 1.0, vase.phase + 0.1));
            let place =
                Vec3::new(vase.place[0] + vase.slide[0] * swing, GAP + lift, vase.place[1] + vase.slide[1] * swing);
            upright(place, (time * PI / 4.0) as f32 + 2.0 * vase.phase as f32, 1.0)
        }))
    }));
    Scene {
        camera: Camera {
            eye: Vec3::new(0.35, 2.15, 4.6),
            target: Vec3::new(0.05, 0.52, 0.0),
            vertical_fov_degrees: 33.0,
            resolution: [800, 600],
        },
        frames_per_sec: FRAMES_PER_SEC,
        frame_count: FRAME_COUNT,
        ..Scene::at_rest("vases", objects, studio::studio())
    }
}

/// The vase called `name`, as it stands in the scene; it falls in another one.
#[cfg(feature = "physics")]
pub(super) fn vase(name: &str) -> Option<Mesh> {
    VASES.iter().find(|vase| vase.name == name).map(mesh)
}

fn mesh(vase: &Vase) -> Mesh {
    let mut mesh = lathe(&spline_profile(vase.controls, PROFILE_POINTS), SEGMENTS);
    let (glaze, trim) = (Vec3::from(vase.glaze), Vec3::from(vase.trim));
    let banded = |height: f32| vase.bands.iter().any(|[low, high]| (*low..=*high).contains(&height));
    mesh.colors = mesh.positions.iter().map(|p| if banded(p.y) { trim } else { glaze }).collect();
    mesh
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::builtin::shapes::tests::check_solid;
    use crate::builtin::tests::built;
    use glam::DVec2;

    #[test]
    fn vases_are_solid_and_stand_on_their_foot() {
        for vase in &VASES {
            let mesh = mesh(vase);
            check_solid(&mesh);
            let lowest = mesh.positions.iter().map(|p| p.y).fold(f32::INFINITY, f32::min);
            assert!((0.0..0.01).contains(&lowest), "{}: {lowest}", vase.name);
        }
    }

    #[test]
    fn vases_never_touch() {
        let radius = |vase: &Vase| vase.controls.iter().map(|c| c[0] as f32).fold(0.0, f32::max);
        let scene = built("vases");
        for index in 0..scene.frame_count {
            let frame = scene.frame(index);
            for (i, a) in VASES.iter().enumerate() {
                for (j, b) in VASES.iter().enumerate().skip(i + 1) {
                    let between =
                        frame.world_from_object[i + 1].translation - frame.world_from_object[j + 1].translation;
                    let room = between.with_y(0.0).length() - radius(a) - radius(b);
                    assert!(room > 0.03, "{} and {} at frame {index}: {room}", a.name, b.name);
                }
            }
        }
    }

    #[test]
    fn profiles_start_flat_and_bend_gently() {
        for vase in &VASES {
            let points: Vec<DVec2> = spline_profile(vase.controls, PROFILE_POINTS)
                .iter()
                .map(|p| DVec2::new(p.radius.into(), p.height.into()))
                .collect();
            assert!((points[1].y - points[0].y).abs() < 0.05 * points[1].x, "{}", vase.name);
            for three in points.windows(3) {
                let (a, b) = (three[1] - three[0], three[2] - three[1]);
                assert!(a.length() < 0.15 && a.angle_to(b).abs() < 0.9, "{} at {}", vase.name, three[1]);
            }
        }
    }

    #[test]
    fn no_profile_crosses_itself() {
        let side = |a: DVec2, b: DVec2, p: DVec2| (b - a).perp_dot(p - a).signum();
        for vase in &VASES {
            let points: Vec<DVec2> = spline_profile(vase.controls, PROFILE_POINTS)
                .iter()
                .map(|p| DVec2::new(p.radius.into(), p.height.into()))
                .collect();
            for i in 0..points.len() - 1 {
                for j in i + 2..points.len() - 1 {
                    let [a, b, c, d] = [points[i], points[i + 1], points[j], points[j + 1]];
                    let crosses = side(a, b, c) != side(a, b, d) && side(c, d, a) != side(c, d, b);
                    assert!(!crosses, "{}: edges {i} and {j}", vase.name);
                }
            }
        }
    }
}
