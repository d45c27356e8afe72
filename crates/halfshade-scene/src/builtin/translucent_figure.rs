//! A figure of marble in a light that turns around it: where it is thin, light shines through.
//!
//! Marble lets light through over a few millimetres [Jensen2001, figure 5]: the figure is fifty times as large as the figurine of
//! three centimetres that it stands for, and so are the paths of light.

use super::choreography::{DURATION_SECS, FRAME_COUNT, FRAMES_PER_SEC};
use super::ground::ground;
use super::polygonize::polygonize;
use super::{figures, studio};
use crate::{Camera, Material, Object, Pose, Scene, Subsurface};
use glam::Vec3;
use std::f64::consts::TAU;

/// It stands this high above the ground, so that no two faces coincide.
const GAP: f32 = 0.004;

/// How much larger than life it is.
const ENLARGED: f32 = 50.0;

/// Marble, in coefficients per metre [Jensen2001, figure 5].
const ABSORPTION: Vec3 = Vec3::new(2.1, 4.1, 7.1);
const REDUCED_SCATTERING: Vec3 = Vec3::new(2190.0, 2620.0, 3000.0);

pub(super) fn scene() -> Scene {
    let marble = Subsurface {
        absorption: ABSORPTION / ENLARGED,
        reduced_scattering: REDUCED_SCATTERING / ENLARGED,
        refractive_index: 1.5,
    };
    let mut mesh = polygonize(&figures::draped_woman(), 0.0295);
    // The stone is of one colour, that of its depth.
    mesh.colors.clear();
    let figure = Object::new("figure", mesh)
        .material(Material { subsurface: Some(marble), ..Material::new(Vec3::ONE) })
        .cluster_count(8)
        .pose(Pose::from_translation(Vec3::new(0.0, GAP, 0.0)));
    let floor = ground(Vec3::new(1.2, 0.08, 1.2), [32, 32], Vec3::new(0.35, 0.33, 0.30), 8);
    Scene {
        environment_turn_per_sec: (TAU / DURATION_SECS) as f32,
        camera: Camera {
            eye: Vec3::new(3.6, 1.7, 2.4),
            target: Vec3::new(0.0, 0.8, 0.0),
            vertical_fov_degrees: 27.0,
            resolution: [600, 800],
        },
        frames_per_sec: FRAMES_PER_SEC,
        frame_count: FRAME_COUNT,
        ..Scene::at_rest("translucent-figure", vec![floor, figure], studio::studio())
    }
}
