//! Scenes from the tables of scene files, every value checked.

use super::document::{
    AnimationTable, CameraTable, Document, KeyframeTable, LightTable, MAX_FRAMES, Meshes, ObjectTable,
};
use super::environment::environment;
use super::source::{Source, named_notes, stem};
use super::values::{albedo, checked, length, place, radiance};
use super::{framing, reflectance, subsurface};
use crate::camera::check_resolution;
use crate::keys::Spanned;
use crate::scene::DEFAULT_FRAMES_PER_SEC;
use crate::{
    Camera, Environment, Material, Mesh, Motion, Object, Pose, Scene, SceneError, Skin, SphereLight, builtin, doubts,
    mesh, text,
};
use glam::{Quat, Vec3};
use std::ops::Range;
use std::sync::Arc;

type Result<T> = std::result::Result<T, SceneError>;

/// Leaf spheres of an object that doesn't say how many.
pub const DEFAULT_SPHERE_COUNT: usize = 64;

pub(super) fn scene(source: &Source<'_>, document: Document) -> Result<Scene> {
    if document.object.is_empty() {
        return Err(SceneError::new("the scene has no objects")
            .in_file(source.path)
            .with_remedy("add an [[object]] with a mesh or a shape"));
    }
    let (mut meshes, mut notes) = (Meshes::new(), Vec::new());
    let from_file: Vec<bool> = document.object.iter().map(|table| table.get_ref().mesh.is_some()).collect();
    let objects: Vec<Object> = document
        .object
        .into_iter()
        .map(|table| object(source, table, &mut meshes, &mut notes))
        .collect::<Result<_>>()?;
    let lights: Vec<_> = document.light.into_iter().map(|table| light(source, table)).collect::<Result<_>>()?;
    let (environment, turn) = match document.environment {
        Some(table) => environment(source, table, &mut notes)?,
        None => (Environment::constant(if lights.is_empty() { Vec3::ONE } else { Vec3::ZERO }), 0.0),
    };
    let camera = match document.camera {
        Some(table) => camera(source, table.into_inner())?,
        None => framing::camera_that_sees(&objects).map_err(|error| error.in_file(source.path))?,
    };
    let motions = objects.iter().map(|object| &object.motion).chain(lights.iter().map(|(_, motion)| motion));
    let of_skins = objects.iter().filter_map(|object| object.skin.as_ref()).map(|skin| skin.last_key_secs());
    let last_key = motions.filter_map(Motion::last_key_secs).chain(of_skins).fold(0.0, f64::max);
    let (frames_per_sec, frame_count) = animation(source, document.animation, last_key)?;
    let name = document.name.unwrap_or_else(|| stem(source.path));
    if let Some(still) = document.still.as_ref().filter(|still| *still.get_ref() >= frame_count) {
        let problem = format!("still = {} lies behind the last frame, {}", still.get_ref(), frame_count - 1);
        return Err(source.error(still.span(), problem));
    }
    let sizes: Vec<f64> = objects.iter().map(framing::size_of).collect();
    notes.extend(named_notes(source.path, doubts::odd_sizes(&objects, &sizes, &from_file)));
    let mut scene = Scene {
        name: name.clone(),
        objects,
        environment,
        environment_turn: 0.0,
        environment_turn_per_sec: turn,
        lights,
        camera,
        frames_per_sec,
        frame_count,
        bounces: document.bounces,
        notes,
    };
    scene.notes.extend(named_notes(source.path, doubts::camera_inside(&scene).into_iter().collect()));
    // Its name is the file's own.
    Ok(match document.still {
        None => scene,
        Some(index) => Scene { name, ..scene.still_at(index.into_inner()) },
    })
}

/// The pose of what reaches as far as `size` from its origin.
fn pose(
    source: &Source<'_>,
    size: f64,
    translate: Option<&Spanned<[f32; 3]>>,
    rotate: Option<&Spanned<[f32; 4]>>,
    scale: Option<&Spanned<f32>>,
) -> Result<Pose> {
    let mut pose = Pose::IDENTITY;
    if let Some(value) = translate {
        pose.translation = place(source, "translate", value)?;
    }
    if let Some(value) = rotate {
        let unit_axis = |[x, y, z, _]: [f32; 4]| glam::DVec3::new(x.into(), y.into(), z.into()).try_normalize();
        let expected = "[axis_x, axis_y, axis_z, degrees], finite, the axis not zero";
        let fits = |v: [f32; 4]| v[3].is_finite() && unit_axis(v).is_some();
        let turn = checked(source, "rotate", value, expected, fits)?;
        let axis = unit_axis(turn).unwrap_or(glam::DVec3::Y).as_vec3().normalize();
        pose.rotation = Quat::from_axis_angle(axis, turn[3].to_radians());
    }
    if let Some(value) = scale {
        pose.scale = length(source, "scale", value, size)?;
    }
    Ok(pose)
}

/// The motion of what reaches as far as `size` from its origin.
fn keyframes(source: &Source<'_>, size: f64, table: &Spanned<Vec<Spanned<KeyframeTable>>>) -> Result<Motion> {
    if table.get_ref().is_empty() {
        return Err(source.error(table.span(), "keyframe is empty; give at least one, or none"));
    }
    let mut keys: Vec<(f64, Pose)> = Vec::new();
    for key in table.get_ref() {
        let KeyframeTable { time, translate, rotate, scale } = key.get_ref();
        let previous = keys.last().map_or(f64::NEG_INFINITY, |(time, _)| *time);
        let fits = |t: f64| t.is_finite() && t > previous;
        let time = checked(source, "time", time, "finite and later than that of the keyframe before", fits)?;
        keys.push((time, pose(source, size, translate.as_ref(), rotate.as_ref(), scale.as_ref())?));
    }
    Ok(Motion::Keyframes(keys))
}

fn object(
    source: &Source<'_>,
    table: Spanned<ObjectTable>,
    meshes: &mut Meshes,
    notes: &mut Vec<String>,
) -> Result<Object> {
    let span: Range<usize> = table.span();
    let table = table.into_inner();
    let (mesh, skin, default_name, is_plane) = match (&table.mesh, &table.shape) {
        (Some(name), None) => {
            let path = source.resolve(name.get_ref());
            let (mesh, skin) = mesh_and_skin(source, name, &table, meshes, notes)?;
            (mesh, skin, stem(&path), false)
        }
        (None, Some(name)) => {
            let unknown =
                || source.error(name.span(), text::unknown("shape", name.get_ref(), builtin::SHAPES.iter().copied()));
            let mesh = builtin::shape(name.get_ref()).ok_or_else(unknown)?;
            let misplaced = [
                ("animation belongs to a glTF mesh", table.animation.as_ref().map(Spanned::span)),
                ("colors belongs to a mesh file", table.colors.as_ref().map(Spanned::span)),
                ("unit_size belongs to a mesh file", table.unit_size.as_ref().map(Spanned::span)),
            ];
            if let Some((what, span)) = misplaced.into_iter().find_map(|(what, span)| Some((what, span?))) {
                return Err(source.error(span, format!("{what}, and this is a shape")));
            }
            (Arc::new(mesh), None, name.get_ref().clone(), name.get_ref() == "plane")
        }
        _ => return Err(source.error(span, "an object needs either a mesh or a shape")),
    };
    let mut material = Material::new(match &table.albedo {
        Some(value) => albedo(source, "albedo", value)?,
        None => Vec3::splat(0.8),
    });
    if let Some(path) = &table.albedo_texture {
        material.texture = Some(source.texture("albedo_texture", path, &mesh, &default_name)?);
    }
    if let Some(table) = &table.reflectance {
        material.reflectance = reflectance::reflectance(source, table.get_ref(), material.albedo)?;
        material.gloss_variation = reflectance::variation(source, table.get_ref(), &mesh, &default_name)?;
    }
    material.subsurface = table.subsurface.as_ref().map(|table| subsurface::subsurface(source, table)).transpose()?;
    let size = match &skin {
        Some(skin) => skin.reach(&mesh),
        None => mesh.positions.iter().map(|p| f64::from(p.abs().max_element())).fold(0.0, f64::max),
    };
    let still = pose(source, size, table.translate.as_ref(), table.rotate.as_ref(), table.scale.as_ref())?;
    let motion = match &table.keyframe {
        None => Motion::Still(still),
        Some(keys) if table.translate.is_none() && table.rotate.is_none() && table.scale.is_none() => {
            keyframes(source, size, keys)?
        }
        Some(keys) => {
            return Err(source
                .error(keys.span(), "keyframe stands beside translate, rotate or scale")
                .with_remedy("put them into the keyframes"));
        }
    };
    Ok(Object {
        sphere_count: table.spheres.unwrap_or(if is_plane { 0 } else { DEFAULT_SPHERE_COUNT }),
        fit: table.fit.unwrap_or_default(),
        cluster_count: table.clusters,
        skin,
        ..Object::new(table.name.unwrap_or(default_name), mesh).material(material).motion(motion)
    })
}

/// The mesh of a file, with a skin if an animation deforms it, read once.
fn mesh_and_skin(
    source: &Source<'_>,
    name: &Spanned<String>,
    table: &ObjectTable,
    meshes: &mut Meshes,
    notes: &mut Vec<String>,
) -> Result<(Arc<Mesh>, Option<Arc<Skin>>)> {
    let path = &source.resolve(name.get_ref());
    let (animation, colors) = (table.animation.as_ref(), table.colors.as_ref());
    let told = colors.map(|colors| *colors.get_ref());
    if let (Some(_), Some(colors)) = (animation, colors) {
        let problem = "vertex colours of a glTF, which alone has animations, are linear by its specification";
        return Err(source.error(colors.span(), problem).with_remedy("leave `colors` out"));
    }
    let is_unit_size = table.unit_size.as_ref().is_some_and(|it| *it.get_ref());
    if let (Some(_), Some(unit_size)) = (animation, table.unit_size.as_ref().filter(|_| is_unit_size)) {
        let problem = "a mesh with an animation keeps its own size, which its skeleton has too";
        return Err(source
            .error(unit_size.span(), problem)
            .with_remedy("leave unit_size out, and give scale and translate"));
    }
    let key = (path.clone(), is_unit_size, animation.map(|animation| animation.get_ref().clone()), told);
    if let Some(known) = meshes.get(&key) {
        return Ok(known.clone());
    }
    let (mesh, skin, found) = match animation {
        None => {
            let (mesh, found) = mesh::load_with_colors(path, told).map_err(|error| source.named_at(name, error))?;
            (mesh, None, found)
        }
        Some(animation) => mesh::load_animated_with_notes(path, animation.get_ref()).map_err(|error| {
            // A sound file may lack what the scene asks for, so the place that asks is named as well.
            let asked_at = if path.is_file() { animation.span() } else { name.span() };
            source.error(asked_at, error.to_string())
        })?,
    };
    if let Some(colors) = colors.filter(|_| mesh.colors.is_empty()) {
        let problem = format!("`{}` has no vertex colours but white, so that colors has no place", stem(path));
        return Err(source.error(colors.span(), problem));
    }
    notes.extend(named_notes(path, found));
    let loaded = (Arc::new(if is_unit_size { mesh.in_unit_size() } else { mesh }), skin.map(Arc::new));
    meshes.insert(key, loaded.clone());
    Ok(loaded)
}

fn light(source: &Source<'_>, table: Spanned<LightTable>) -> Result<(SphereLight, Motion)> {
    let LightTable { sphere, radiance: emitted, keyframe } = table.into_inner();
    let light = SphereLight {
        center: place(source, "center", &sphere.center)?,
        radius: length(source, "radius", &sphere.radius, 1.0)?,
        radiance: radiance(source, "radiance", &emitted)?,
    };
    let size = light.center.abs().max_element().max(light.radius);
    let motion = match &keyframe {
        Some(keys) => keyframes(source, size.into(), keys)?,
        None => Motion::Still(Pose::IDENTITY),
    };
    Ok((light, motion))
}

fn camera(source: &Source<'_>, table: CameraTable) -> Result<Camera> {
    let (eye, target) = (place(source, "eye", &table.eye)?, place(source, "target", &table.target)?);
    if (target.as_dvec3() - eye.as_dvec3()).try_normalize().is_none() {
        return Err(source.error(table.target.span(), "the camera's target is its eye: it looks nowhere"));
    }
    let vertical_fov_degrees = match &table.vertical_fov_degrees {
        Some(value) => checked(source, "vertical_fov_degrees", value, "between 0 and 180", |a| a > 0.0 && a < 180.0)?,
        None => 40.0,
    };
    let resolution = match &table.resolution {
        Some(value) => {
            let sides = value.get_ref().map(|side| u32::try_from(side).unwrap_or(0));
            check_resolution(sides).map_err(|problem| source.error(value.span(), format!("resolution: {problem}")))?;
            sides
        }
        None => [800, 600],
    };
    Ok(Camera { eye, target, vertical_fov_degrees, resolution })
}

/// Frames per second and number of frames.
fn animation(source: &Source<'_>, table: Option<AnimationTable>, last_key: f64) -> Result<(f64, usize)> {
    let (frames_per_sec, frame_count) = table.map_or((None, None), |t| (t.frames_per_sec, t.frame_count));
    let frames_per_sec = match &frames_per_sec {
        Some(value) => checked(source, "frames_per_sec", value, "positive, at most 10000", |f| f > 0.0 && f <= 1e4)?,
        None => DEFAULT_FRAMES_PER_SEC,
    };
    let default = 1 + ((last_key * frames_per_sec).ceil() as usize).min(MAX_FRAMES - 1);
    Ok((frames_per_sec, frame_count.unwrap_or(default)))
}

#[cfg(test)]
mod tests;
