//! Content of another renderer's file, on its way to a scene.

use super::view::View;
use crate::file::{DEFAULT_SPHERE_COUNT, camera_that_sees, stem};
use crate::light::EnvironmentMap;
use crate::mesh::LARGEST_COORDINATE;
use crate::scene::MAX_BOUNCES;
use crate::{Environment, Material, Mesh, Motion, Object, Pose, Scene, SceneError, SphereLight};
use glam::{DMat3, DMat4, DQuat, DVec3, Vec3};
use std::collections::BTreeMap;
use std::f64::consts::PI;
use std::path::{Path, PathBuf};
use std::sync::Arc;

/// Most triangles, and most meshes, that a file may stand for, copies included.
const MOST_TRIANGLES: usize = 1 << 25;
const MOST_SHAPES: usize = 1 << 16;

/// Deviation of axes and lengths that is rounding.
const ROUNDING: f64 = 1e-4;

/// A mesh and its place, in the file's space.
#[derive(Debug, Clone)]
pub(super) struct Shape {
    pub(super) name: String,
    pub(super) mesh: Arc<Mesh>,
    pub(super) world_from_mesh: DMat4,
    pub(super) material: Material,
    pub(super) line: usize,
}

/// A sphere that shines, in its own space about its origin.
#[derive(Debug, Clone, Copy)]
pub(super) struct Lamp {
    pub(super) world_from_lamp: DMat4,
    pub(super) radius: f64,
    pub(super) radiance: Vec3,
    pub(super) line: usize,
}

/// Light from infinitely far.
#[derive(Debug, Clone)]
pub(super) enum Distant {
    Constant(Vec3),
    Map { map: EnvironmentMap, world_from_map: DMat4 },
}

/// All that was found in a file, in its own space and order.
#[derive(Debug)]
pub(super) struct Assembly {
    path: PathBuf,
    pub(super) shapes: Vec<Shape>,
    pub(super) lamps: Vec<Lamp>,
    pub(super) distant: Option<Distant>,
    pub(super) view: Option<View>,
    /// Bounces of light; `None` without end.
    pub(super) bounces: Option<usize>,
    notes: Vec<Note>,
    /// Places of notes in the list, by file and text.
    known: BTreeMap<(PathBuf, String), usize>,
    triangles: usize,
}

/// A remark for people about a file.
#[derive(Debug)]
struct Note {
    path: PathBuf,
    /// The first line that it is about.
    line: Option<usize>,
    text: String,
    /// Further lines.
    others: usize,
}

impl Note {
    fn told(self) -> String {
        let line = self.line.map(|line| format!(":{line}")).unwrap_or_default();
        let others = if self.others > 0 { format!(" (and {} times after that)", self.others) } else { String::new() };
        format!("{}{line}: {}{others}", self.path.display(), self.text)
    }
}

impl Assembly {
    pub(super) fn new(path: &Path) -> Self {
        Self {
            path: path.to_owned(),
            shapes: Vec::new(),
            lamps: Vec::new(),
            distant: None,
            view: None,
            bounces: Some(0),
            notes: Vec::new(),
            known: BTreeMap::new(),
            triangles: 0,
        }
    }

    /// Tells people what of a line is left out or approximated; what is so of many lines, once.
    pub(super) fn note(&mut self, path: &Path, line: usize, what: &str) {
        self.add_note(path, Some(line), what);
    }

    /// Tells people what a file's reader noted.
    pub(super) fn note_all(&mut self, path: &Path, notes: Vec<String>) {
        notes.iter().for_each(|note| self.add_note(path, None, note));
    }

    fn add_note(&mut self, path: &Path, line: Option<usize>, text: &str) {
        let key = (path.to_owned(), text.to_owned());
        match self.known.get(&key) {
            Some(&place) => self.notes[place].others += usize::from(line.is_some()),
            None => {
                self.known.insert(key, self.notes.len());
                self.notes.push(Note { path: path.to_owned(), line, text: text.to_owned(), others: 0 });
            }
        }
    }

    /// Adds a mesh and its place.
    pub(super) fn add(&mut self, shape: Shape) -> Result<(), SceneError> {
        self.triangles = self.triangles.saturating_add(shape.mesh.triangles.len());
        if self.triangles > MOST_TRIANGLES || self.shapes.len() >= MOST_SHAPES {
            let problem = format!(
                "its meshes and their copies are more than {MOST_SHAPES}, or have more than {MOST_TRIANGLES} triangles"
            );
            let error = SceneError::new(problem).in_file(&self.path).at_line(shape.line);
            return Err(error.with_remedy("export fewer, or simpler ones"));
        }
        self.shapes.push(shape);
        Ok(())
    }

    /// The scene, turned so that +Y is up in the picture.
    pub(super) fn finish(mut self) -> Result<Scene, SceneError> {
        if self.shapes.is_empty() {
            return Err(SceneError::new("the scene has no meshes that are read")
                .in_file(&self.path)
                .with_remedy("export shapes as triangles"));
        }
        let world_from_file = self.view.as_ref().map_or(DMat4::IDENTITY, View::upright);
        let objects = self.shapes.iter().map(|shape| {
            placed(shape, &world_from_file).map_err(|error| error.in_file(&self.path).at_line(shape.line))
        });
        let objects: Vec<Object> = objects.collect::<Result<_, _>>()?;
        let (mut lights, mut notes) = (Vec::new(), Vec::new());
        for lamp in &self.lamps {
            let (light, is_uniform) = lamp.light(&world_from_file).map_err(|error| error.in_file(&self.path))?;
            if !is_uniform {
                notes.push((lamp.line, "a lamp's scale is not uniform: it is a sphere of the same volume here"));
            }
            lights.push((light, Motion::Still(Pose::IDENTITY)));
        }
        let path = self.path.clone();
        notes.into_iter().for_each(|(line, note)| self.note(&path, line, note));
        let (environment, turn) = match self.distant.take() {
            None => (Environment::constant(if lights.is_empty() { Vec3::ONE } else { Vec3::ZERO }), 0.0),
            Some(Distant::Constant(radiance)) => (Environment::constant(radiance), 0.0),
            Some(Distant::Map { map, world_from_map }) => self.turned(map, &(world_from_file * world_from_map)),
        };
        let bounces = self.bounces.unwrap_or(usize::MAX);
        if bounces > MAX_BOUNCES {
            self.note_all(
                &path,
                vec![format!("light bounces without end, or more often than {MAX_BOUNCES} times, as here")],
            );
        }
        let camera = match &self.view {
            Some(view) => view.camera(&world_from_file).map_err(|error| error.in_file(&self.path))?,
            None => camera_that_sees(&objects).map_err(|error| error.in_file(&self.path))?,
        };
        Ok(Scene {
            environment_turn: turn,
            lights,
            camera,
            bounces: bounces.min(MAX_BOUNCES),
            notes: self.notes.into_iter().map(Note::told).collect(),
            ..Scene::at_rest(stem(&self.path), objects, environment)
        })
    }

    /// A map by its turn around +Y; resampled if it is turned otherwise.
    fn turned(&mut self, map: EnvironmentMap, world_from_map: &DMat4) -> (Environment, f32) {
        let axes = DMat3::from_mat4(*world_from_map);
        let up = axes.y_axis.normalize_or(DVec3::Y);
        if up.distance(DVec3::Y) < ROUNDING && axes.determinant() > 0.0 {
            let toward = axes.z_axis;
            let turn = toward.x.atan2(toward.z);
            return (Environment::map(map), if turn.abs() < ROUNDING { 0.0 } else { turn as f32 });
        }
        let path = self.path.clone();
        self.note_all(
            &path,
            vec!["the environment isn't turned around the vertical: it is looked up texel by texel".into()],
        );
        let map_from_world = axes.inverse();
        let texels = (0..map.texels().len()).map(|texel| {
            let direction = map_from_world * map.texel_direction(texel).as_dvec3();
            map.radiance(direction.normalize_or(DVec3::Y).as_vec3())
        });
        let turned = EnvironmentMap::new(map.width(), map.height(), texels.collect());
        (turned.map_or(Environment::constant(Vec3::ZERO), Environment::map), 0.0)
    }
}

/// An object whose mesh stands in world space.
fn placed(shape: &Shape, world_from_file: &DMat4) -> Result<Object, SceneError> {
    let world_from_mesh = *world_from_file * shape.world_from_mesh;
    let mut mesh = shape.mesh.clone();
    if world_from_mesh != DMat4::IDENTITY {
        let axes = DMat3::from_mat4(world_from_mesh);
        let determinant = axes.determinant();
        if !world_from_mesh.is_finite() || determinant == 0.0 || !determinant.is_finite() {
            return Err(SceneError::new(format!(
                "the transform of shape `{}` flattens it, or is not finite",
                shape.name
            )));
        }
        let normals = axes.inverse().transpose();
        let own = Arc::make_mut(&mut mesh);
        for position in &mut own.positions {
            *position = world_from_mesh.transform_point3(position.as_dvec3()).as_vec3();
        }
        for normal in &mut own.normals {
            *normal = (normals * normal.as_dvec3()).normalize_or(DVec3::Y).as_vec3();
        }
        if determinant < 0.0 {
            own.triangles.iter_mut().for_each(|triangle| triangle.swap(1, 2));
        }
    }
    if mesh.positions.iter().any(|p| !(p.is_finite() && p.abs().max_element() <= LARGEST_COORDINATE)) {
        let problem = format!("shape `{}` reaches farther out than {LARGEST_COORDINATE:e}", shape.name);
        return Err(SceneError::new(problem).with_remedy("choose a larger unit of length"));
    }
    let is_flat = mesh.bounds().is_some_and(|(min, max)| (max - min).min_element() == 0.0);
    let spheres = if is_flat { 0 } else { DEFAULT_SPHERE_COUNT };
    Ok(Object::new(shape.name.clone(), mesh).material(shape.material.clone()).sphere_count(spheres))
}

impl Lamp {
    /// The light, and whether its scale is the same along all axes.
    fn light(&self, world_from_file: &DMat4) -> Result<(SphereLight, bool), SceneError> {
        let matrix = *world_from_file * self.world_from_lamp;
        let axes = DMat3::from_mat4(matrix);
        let lengths = DVec3::from(axes.to_cols_array_2d().map(|axis| DVec3::from(axis).length()));
        let radius = self.radius * axes.determinant().abs().cbrt();
        let light =
            SphereLight { center: matrix.w_axis.truncate().as_vec3(), radius: radius as f32, radiance: self.radiance };
        let largest = light.center.abs().max_element().max(light.radius);
        if !(light.center.is_finite() && light.radius > 0.0 && largest <= LARGEST_COORDINATE) {
            let problem = format!("a lamp at {} of radius {radius:e}", light.center);
            return Err(SceneError::new(problem)
                .at_line(self.line)
                .with_remedy(format!("its radius must be positive, and all of it within {LARGEST_COORDINATE:e}")));
        }
        Ok((light, lengths.max_element() - lengths.min_element() <= ROUNDING * lengths.max_element()))
    }
}

/// A turn of half a circle around +Y, exact.
pub(super) fn half_turn() -> DMat4 {
    DMat4::from_scale(DVec3::new(-1.0, 1.0, -1.0))
}

/// A turn by degrees around an axis.
pub(super) fn rotation(axis: DVec3, degrees: f64) -> Option<DMat4> {
    if degrees.rem_euclid(360.0) == 180.0 && axis.x == 0.0 && axis.z == 0.0 && axis.y != 0.0 {
        return Some(half_turn());
    }
    Some(DMat4::from_quat(DQuat::from_axis_angle(axis.try_normalize()?, degrees * PI / 180.0)))
}
