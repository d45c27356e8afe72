//! Cameras and punctual lights of a glTF document, where their nodes stand at rest.

use super::nodes::label;
use crate::camera::check_resolution;
use crate::mesh::assemble::LARGEST_COORDINATE;
use crate::mesh::file_scene::{Punctual, PunctualKind};
use crate::{Camera, SceneError};
use ::gltf::camera::Projection;
use ::gltf::json::Value;
use ::gltf::{Document, Node};
use glam::{DMat4, DVec3, Vec3};

const LIGHTS: &str = "KHR_lights_punctual";

/// Rows of pictures: glTF says of pictures only their shape.
const ROWS: u32 = 600;
/// Degrees by which a camera may be rolled without a word.
const ROLL_TOLERANCE: f32 = 0.5;

/// Cameras and lights, and what of them is left out.
#[derive(Default)]
pub(super) struct Stage {
    pub(super) camera: Option<Camera>,
    pub(super) lights: Vec<Punctual>,
    pub(super) notes: Vec<String>,
}

impl Stage {
    /// Adds what a node has, which stands at `world_from_node`.
    pub(super) fn add(
        &mut self,
        document: &Document,
        node: &Node<'_>,
        world_from_node: DMat4,
        moves: bool,
    ) -> Result<(), SceneError> {
        let name = label(node);
        let found = self.lights.len();
        let had_camera = self.camera.is_some();
        if let Some(camera) = node.camera() {
            match camera.projection() {
                _ if had_camera => self.notes.push(format!("{name}: a further camera left out")),
                Projection::Orthographic(_) => self.notes.push(format!("{name}: an orthographic camera left out")),
                Projection::Perspective(lens) => {
                    let view = view(&world_from_node, lens.yfov(), lens.aspect_ratio());
                    let (camera, is_rolled) = view.map_err(|problem| SceneError::new(format!("{name}: {problem}")))?;
                    if is_rolled {
                        self.notes.push(format!("{name}: the camera's roll is left out"));
                    }
                    self.camera = Some(camera);
                }
            }
        }
        if let Some(index) = node.extension_value(LIGHTS) {
            let light = index.get("light").and_then(Value::as_u64).and_then(|index| {
                let lights = document.as_json().extensions.as_ref()?.others.get(LIGHTS)?.get("lights")?;
                lights.get(usize::try_from(index).ok()?)
            });
            let missing = || SceneError::new(format!("{name}: it names a light that doesn't exist"));
            self.light(&name, light.ok_or_else(missing)?, &world_from_node)?;
        }
        if moves && (self.lights.len() > found || self.camera.is_some() != had_camera) {
            self.notes.push(format!("{name}: the movement of a camera or light is left out"));
        }
        Ok(())
    }

    fn light(&mut self, name: &str, light: &Value, world_from_node: &DMat4) -> Result<(), SceneError> {
        let wrong = |what: &str| SceneError::new(format!("{name}: the {what} of its light is no number that is one"));
        let number = |value: &Value, what: &str| {
            let number = value.as_f64().filter(|number| (0.0..=f64::from(f32::MAX)).contains(number));
            number.ok_or_else(|| wrong(what))
        };
        let intensity = light.get("intensity").map_or(Ok(1.0), |value| number(value, "intensity"))?;
        let color = match light.get("color") {
            None => DVec3::ONE,
            Some(color) => {
                let channel = |c: usize| number(color.get(c).unwrap_or(&Value::Null), "colour");
                DVec3::new(channel(0)?, channel(1)?, channel(2)?)
            }
        };
        let kind = match light.get("type").and_then(Value::as_str) {
            Some("point") => PunctualKind::Point { position: world_from_node.w_axis.truncate() },
            Some("directional") => {
                let direction = world_from_node.z_axis.truncate().try_normalize();
                let lost = || SceneError::new(format!("{name}: a directional light shines nowhere"));
                PunctualKind::Directional { toward: direction.ok_or_else(lost)? }
            }
            other => {
                self.notes.push(format!("{name}: a light of type `{}` left out", other.unwrap_or("").escape_debug()));
                return Ok(());
            }
        };
        let is_near = |p: DVec3| p.is_finite() && p.abs().max_element() <= f64::from(LARGEST_COORDINATE);
        if matches!(kind, PunctualKind::Point { position } if !is_near(position)) {
            return Err(SceneError::new(format!("{name}: its light lies too far out to compute with")));
        }
        if light.get("range").is_some() {
            self.notes.push(format!("{name}: the `range` of its light is left out"));
        }
        self.lights.push(Punctual { kind, intensity: intensity * color });
        Ok(())
    }
}

/// A camera that looks along -Z of its node, and whether it is rolled.
fn view(world_from_node: &DMat4, vertical_fov: f32, aspect: Option<f32>) -> Result<(Camera, bool), String> {
    let axis = |axis: glam::DVec4| axis.truncate().normalize_or_zero();
    let (eye, forward) = (world_from_node.w_axis.truncate(), -axis(world_from_node.z_axis));
    let width = (ROWS as f32 * aspect.unwrap_or(4.0 / 3.0)).round();
    let camera = Camera {
        eye: eye.as_vec3(),
        // As far away as the scene's middle would be: single precision then keeps the direction.
        target: (eye + forward * eye.length().max(1.0)).as_vec3(),
        vertical_fov_degrees: vertical_fov.to_degrees(),
        // Casts saturate: what can't be a side is refused.
        resolution: [width as u32, ROWS],
    };
    let is_near = |p: Vec3| p.is_finite() && p.abs().max_element() <= LARGEST_COORDINATE;
    if !(is_near(camera.eye) && is_near(camera.target)) || camera.eye == camera.target {
        return Err(format!("its camera looks from {} to {}", camera.eye, camera.target));
    }
    if !(camera.vertical_fov_degrees > 0.0 && camera.vertical_fov_degrees < 180.0) {
        return Err(format!("the field of view of its camera is {vertical_fov} radians"));
    }
    check_resolution(camera.resolution)?;
    let up = axis(world_from_node.y_axis).as_vec3();
    Ok((camera, up.angle_between(camera.up()).to_degrees() > ROLL_TOLERANCE))
}
