//! A scene: objects that move, light that falls on them, a camera that looks.

use crate::{Camera, Environment, Motion, Object, SphereLight};
use glam::Vec3;

/// Most bounces that a scene may ask for: at an albedo of 0.8 what is left is 0.03 of the light.
pub const MAX_BOUNCES: usize = 16;

/// Frames per second of a scene that doesn't say how many.
pub const DEFAULT_FRAMES_PER_SEC: f64 = 30.0;

/// A scene on which every strategy and the truth are run.
#[derive(Debug, Clone)]
pub struct Scene {
    /// Name for tables.
    pub name: String,
    /// The objects. A blocker is an object whose `sphere_count` is not 0; the truth traces every mesh.
    pub objects: Vec<Object>,
    /// Infinitely distant light.
    pub environment: Environment,
    /// Turn of the environment around +Y at the first frame, in radians.
    pub environment_turn: f32,
    /// The same, radians per second: dynamic light.
    pub environment_turn_per_sec: f32,
    /// Local spherical lights, with their motion (position of the pose moves the centre, scale the radius).
    pub lights: Vec<(SphereLight, Motion)>,
    /// The camera of pictures. Its eye is also where glossy receivers are seen from, vertices too.
    pub camera: Camera,
    /// Frames per second of the animation's time line.
    pub frames_per_sec: f64,
    /// Length of the animation in frames, at least 1.
    pub frame_count: usize,
    /// Number of bounces of light: 0 is direct light alone. At most [`MAX_BOUNCES`].
    pub bounces: usize,
    /// Notes on what was repaired or left out when files were read, for people; each names its file.
    pub notes: Vec<String>,
}

impl Scene {
    /// A scene in which nothing moves: direct light only, no local lights, a small picture from (0, 0, 1).
    pub fn at_rest(name: impl Into<String>, objects: Vec<Object>, environment: Environment) -> Self {
        Self {
            name: name.into(),
            objects,
            environment,
            environment_turn: 0.0,
            environment_turn_per_sec: 0.0,
            lights: Vec::new(),
            camera: Camera { eye: Vec3::Z, target: Vec3::ZERO, vertical_fov_degrees: 40.0, resolution: [16, 12] },
            frames_per_sec: DEFAULT_FRAMES_PER_SEC,
            frame_count: 1,
            bounces: 0,
            notes: Vec::new(),
        }
    }

    /// Turn of the environment around +Y at `time_secs`, in radians.
    pub fn environment_turn_at(&self, time_secs: f64) -> f32 {
        (f64::from(self.environment_turn) + f64::from(self.environment_turn_per_sec) * time_secs) as f32
    }

    /// Whether any object reflects anything beside its diffuse part.
    pub fn is_glossy(&self) -> bool {
        self.objects.iter().any(|object| object.material.is_glossy())
    }

    /// Whether light passes below the surface of any object.
    pub fn is_translucent(&self) -> bool {
        self.objects.iter().any(|object| object.material.subsurface.is_some())
    }

    /// Sum of the vertices of all objects: the number of vertex receivers.
    pub fn vertex_count(&self) -> usize {
        self.objects.iter().map(|object| object.mesh.positions.len()).sum()
    }

    /// Sum of the spheres of all objects whose sphere set is built.
    pub fn built_sphere_count(&self) -> usize {
        self.objects.iter().filter_map(|object| object.spheres.as_ref()).map(|set| set.spheres.len()).sum()
    }
}
