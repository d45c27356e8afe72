//! A mesh file by itself as a scene.

use super::build::DEFAULT_SPHERE_COUNT;
use super::framing::camera_on;
use super::source::{named_notes, stem};
use crate::light::{KILOCANDELAS_PER_UNIT, SUN_ANGULAR_RADIUS, Sky, Sun};
use crate::mesh::{FileScene, Punctual, PunctualKind, load_scene};
use crate::scene::DEFAULT_FRAMES_PER_SEC;
use crate::{Environment, Mesh, Motion, Object, Pose, Scene, SceneError, SphereLight, builtin};
use glam::{DVec3, Vec3};
use std::f64::consts::PI;
use std::path::Path;

/// Radius of a light that has none, in sizes of the scene: small, but a penumbra.
const POINT_RADIUS: f64 = 0.01;

/// Most frames of a movement.
const MOST_FRAMES: f64 = 1e6;

/// The scene of a mesh file by itself: the mesh at its own scale and place, a grey ground plane under its lowest point, and
/// a camera that sees all of it. Meshes cast shadows by [`DEFAULT_SPHERE_COUNT`] spheres each.
///
/// In a glTF, each part that its first animation moves as a whole is an object that moves, its first perspective camera is the camera,
/// and lights are its punctual ones: a point light is a sphere of a hundredth of the scene's size, whose intensity in candela
/// is radiance · π radius²; a directional one is the sun, whose illuminance in lux is radiance · π sin² of its angular radius.
/// A radiance of 1 is [`KILOCANDELAS_PER_UNIT`]. Without an `environment` the light is the default sky, or the file's own
/// lights alone where it has some.
pub fn from_mesh(path: &Path, environment: Option<Environment>) -> Result<Scene, SceneError> {
    let FileScene { still, moving, camera, lights, mut notes } = load_scene(path)?;
    let parts = moving.into_iter().map(|part| (part.name, part.mesh, part.motion));
    let still = still.map(|mesh| (stem(path), mesh, Motion::Still(Pose::IDENTITY)));
    let parts: Vec<(String, Mesh, Motion)> = still.into_iter().chain(parts).collect();
    let bounds = parts.iter().filter_map(|(_, mesh, motion)| {
        let pose = motion.at(0.0);
        super::framing::box_of(&mesh.positions, &pose)
    });
    let bounds = bounds.reduce(|a, b| (a.0.min(b.0), a.1.max(b.1)));
    let (min, max) = bounds.ok_or_else(|| SceneError::new("the mesh is empty").in_file(path))?;
    let size = (max - min).length();
    let center = 0.5 * (min + max);
    let ground = Object::new("ground", builtin::shapes::plane(128)).albedo(Vec3::splat(0.5)).pose(Pose {
        // Wide enough that the penumbra of a light 30 degrees high ends on it.
        scale: 1.5 * size as f32,
        ..Pose::from_translation(DVec3::new(center.x, min.y, center.z).as_vec3())
    });
    let has_lights = !lights.is_empty();
    let (spheres, suns) = sized(lights, size).map_err(|error| error.in_file(path))?;
    let mut environment = match environment {
        Some(environment) => environment,
        None if has_lights => Environment::constant(Vec3::ZERO),
        None => Sky::default().environment()?,
    };
    if has_lights {
        notes.push(format!(
            "lights without a size are spheres of radius {:.3e}, or as large as the sun",
            POINT_RADIUS * size
        ));
    }
    for sun in suns {
        match environment.sun {
            None => environment.sun = Some(sun),
            Some(_) => notes.push("a directional light is left out: there is a sun already".to_owned()),
        }
    }
    let last_key = parts.iter().filter_map(|(_, _, motion)| motion.last_key_secs()).fold(0.0, f64::max);
    let mut objects: Vec<Object> = (parts.into_iter())
        .map(|(name, mesh, motion)| {
            let object = Object::new(name, mesh).albedo(Vec3::splat(0.8)).motion(motion);
            object.sphere_count(DEFAULT_SPHERE_COUNT)
        })
        .collect();
    objects.push(ground);
    let framed = || camera_on(min, max).map_err(|error| error.in_file(path));
    Ok(Scene {
        camera: camera.map_or_else(framed, Ok)?,
        lights: spheres.into_iter().map(|light| (light, Motion::Still(Pose::IDENTITY))).collect(),
        frame_count: 1 + (last_key * DEFAULT_FRAMES_PER_SEC).ceil().min(MOST_FRAMES - 1.0) as usize,
        notes: named_notes(path, notes),
        ..Scene::at_rest(stem(path), objects, environment)
    })
}

/// Lights with a size, for a scene as large as `size`.
fn sized(lights: Vec<Punctual>, size: f64) -> Result<(Vec<SphereLight>, Vec<Sun>), SceneError> {
    let (mut spheres, mut suns) = (Vec::new(), Vec::new());
    for Punctual { kind, intensity } in lights {
        let per_unit = 1000.0 * KILOCANDELAS_PER_UNIT;
        let radius = POINT_RADIUS * size;
        let area = match kind {
            PunctualKind::Point { .. } => PI * radius * radius,
            PunctualKind::Directional { .. } => PI * SUN_ANGULAR_RADIUS.sin().powi(2),
        };
        let radiance = (intensity / (area * per_unit)).as_vec3();
        if !radiance.is_finite() {
            return Err(SceneError::new(format!("a light of intensity {intensity} is too bright for its size")));
        }
        match kind {
            PunctualKind::Point { position } => {
                spheres.push(SphereLight { center: position.as_vec3(), radius: radius as f32, radiance });
            }
            PunctualKind::Directional { toward } => {
                let angular_radius = SUN_ANGULAR_RADIUS as f32;
                suns.push(Sun { direction: toward.as_vec3().normalize(), angular_radius, radiance });
            }
        }
    }
    Ok((spheres, suns))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn intensity_and_illuminance_are_kept() {
        let intensity = DVec3::new(100.0, 50.0, 0.0);
        let [point, sun] = [
            PunctualKind::Point { position: DVec3::new(0.0, 5.0, 0.0) },
            PunctualKind::Directional { toward: DVec3::new(0.6, 0.8, 0.0) },
        ]
        .map(|kind| sized(vec![Punctual { kind, intensity }], 2.0).unwrap());
        let per_unit = (1000.0 * KILOCANDELAS_PER_UNIT) as f32;
        // E = I cos θ / d², lux.
        let found = per_unit * point.0[0].irradiance(Vec3::ZERO, Vec3::Y);
        assert!(found.distance(Vec3::new(4.0, 2.0, 0.0)) < 1e-3, "{found}");
        let found = per_unit * sun.1[0].irradiance(Vec3::Y);
        assert!(found.distance(Vec3::new(80.0, 40.0, 0.0)) < 1e-2, "{found}");
        let bright = Punctual { kind: PunctualKind::Point { position: DVec3::ZERO }, intensity: DVec3::splat(3e38) };
        assert!(sized(vec![bright], 1e-6).is_err());
    }
}
