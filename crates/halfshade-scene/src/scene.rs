//! A scene: objects that move, light that falls on them, a camera that looks.

use crate::{
    Camera, Deformed, Environment, Gloss, GlossVariation, Material, Mesh, Motion, Skin, SphereLight, SphereSet, Texture,
};
use glam::{DVec3, Vec3};
use std::sync::Arc;

/// Most bounces that a scene may ask for: at an albedo of 0.8 what is left is 0.03 of the light.
pub const MAX_BOUNCES: usize = 16;

/// Frames per second of a scene that doesn't say how many.
pub const DEFAULT_FRAMES_PER_SEC: f64 = 30.0;

/// One object: rigid, or deformed by a skin.
#[derive(Debug, Clone)]
pub struct Object {
    /// A name for messages and tables.
    pub name: String,
    /// Its surface, in object space.
    pub mesh: Arc<Mesh>,
    /// How it reflects.
    pub material: Material,
    /// How many leaf spheres approximate it as a blocker; 0: it receives only.
    pub sphere_count: usize,
    /// The sphere set in object space, once built (see [`crate::spheres`]); empty when `sphere_count` is 0.
    pub spheres: Option<Arc<SphereSet>>,
    /// How many receiver clusters its vertices form ([Guerrero2007, 4.1]); 0: left to the strategy.
    pub cluster_count: usize,
    /// Its pose over time.
    pub motion: Motion,
    /// How its mesh deforms over time; the mesh and its spheres are those at rest.
    pub skin: Option<Arc<Skin>>,
}

/// A scene on which every strategy and the truth are run.
#[derive(Debug, Clone)]
pub struct Scene {
    /// Name for tables.
    pub name: String,
    /// The objects. A blocker is an object whose `sphere_count` is not 0; the truth traces every mesh.
    pub objects: Vec<Object>,
    /// Infinitely distant light.
    pub environment: Environment,
    /// Turn of the environment around +Y, radians per second: dynamic light.
    pub environment_turn_per_sec: f32,
    /// Local spherical lights, with their motion (position of the pose moves the centre, scale the radius).
    pub lights: Vec<(SphereLight, Motion)>,
    /// The camera of pictures. Its eye is also where glossy receivers are seen from, vertices too.
    pub camera: Camera,
    /// Frames per second of the animation's time line.
    pub frames_per_sec: f64,
    /// Length of the animation in frames, at least 1.
    pub frame_count: usize,
    /// How many bounces of light are asked for: 0 is direct light alone. At most [`MAX_BOUNCES`].
    pub bounces: usize,
    /// Notes on what was repaired or left out when files were read, for people; each names its file.
    pub notes: Vec<String>,
}

impl Object {
    /// Its vertices at a moment, if it has a skin that fits its mesh.
    pub fn deformed(&self, time_secs: f64) -> Option<Arc<Deformed>> {
        let skin = self.skin.as_ref().filter(|skin| skin.influences.len() == self.mesh.positions.len())?;
        Some(Arc::new(skin.deform(&self.mesh, time_secs)))
    }

    /// Albedo at a vertex of the mesh.
    pub fn albedo_at_vertex(&self, vertex: usize) -> Vec3 {
        let color = self.mesh.colors.get(vertex).copied().unwrap_or(Vec3::ONE);
        let coordinates = self.mesh.texture_coordinates.get(vertex);
        self.material.albedo * color * coordinates.map_or(Vec3::ONE, |place| self.texel(place.as_dvec3()))
    }

    /// Albedo on a triangle of the mesh, at the point that has these weights of its vertices.
    pub fn albedo_at(&self, triangle: usize, weights: DVec3) -> Vec3 {
        let Mesh { colors, texture_coordinates, .. } = &*self.mesh;
        let mixed = |list: &[Vec3]| self.mesh.interpolated(list, triangle, weights);
        let mut albedo = self.material.albedo;
        if !colors.is_empty() {
            albedo *= mixed(colors).as_vec3();
        }
        if !texture_coordinates.is_empty() {
            albedo *= self.texel(mixed(texture_coordinates));
        }
        albedo
    }

    /// Gloss at a vertex of the mesh.
    pub fn gloss_at_vertex(&self, vertex: usize) -> Gloss {
        let Some(variation) = self.material.varied_gloss() else { return Gloss::NEUTRAL };
        let own = variation.vertices.get(vertex).copied().unwrap_or_default();
        let coordinates = self.mesh.texture_coordinates.get(vertex);
        own.times(coordinates.map_or(Gloss::NEUTRAL, |place| gloss_texel(variation, place.as_dvec3())))
    }

    /// Gloss on a triangle of the mesh, at the point that has these weights of its vertices.
    pub fn gloss_at(&self, triangle: usize, weights: DVec3) -> Gloss {
        let Some(variation) = self.material.varied_gloss() else { return Gloss::NEUTRAL };
        let corners = self.mesh.triangles[triangle].into_iter().zip(weights.as_vec3().to_array());
        let own = |vertex: u32| variation.vertices.get(vertex as usize).copied().unwrap_or_default();
        let mut gloss = Gloss::NEUTRAL;
        if !variation.vertices.is_empty() {
            gloss = Gloss::mixed(corners.map(|(vertex, weight)| (own(vertex), weight)));
        }
        if !self.mesh.texture_coordinates.is_empty() {
            let place = self.mesh.interpolated(&self.mesh.texture_coordinates, triangle, weights);
            gloss = gloss.times(gloss_texel(variation, place));
        }
        gloss
    }

    /// The texture at a coordinate as [`Mesh::texture_coordinates`] has them; white without one.
    fn texel(&self, coordinate: DVec3) -> Vec3 {
        let own = || self.mesh.textures.get(coordinate.z.round() as usize);
        let texture = self.material.texture.as_ref().or_else(own);
        texture.map_or(Vec3::ONE, |texture| texture.at(coordinate.truncate()))
    }
}

/// Gloss by the textures of a variation at a coordinate.
fn gloss_texel(variation: &GlossVariation, coordinate: DVec3) -> Gloss {
    let at = |texture: &Option<Arc<Texture>>| {
        texture.as_ref().map_or(Vec3::ONE, |texture| texture.at(coordinate.truncate()))
    };
    Gloss { specular: at(&variation.specular), exponent: at(&variation.exponent).x }
}

impl Scene {
    /// A scene in which nothing moves: direct light only, no local lights, a small picture from (0, 0, 1).
    pub fn at_rest(name: impl Into<String>, objects: Vec<Object>, environment: Environment) -> Self {
        Self {
            name: name.into(),
            objects,
            environment,
            environment_turn_per_sec: 0.0,
            lights: Vec::new(),
            camera: Camera { eye: Vec3::Z, target: Vec3::ZERO, vertical_fov_degrees: 40.0, resolution: [16, 12] },
            frames_per_sec: DEFAULT_FRAMES_PER_SEC,
            frame_count: 1,
            bounces: 0,
            notes: Vec::new(),
        }
    }

    /// Whether any object reflects anything beside its diffuse part.
    pub fn is_glossy(&self) -> bool {
        self.objects.iter().any(|object| object.material.is_glossy())
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
