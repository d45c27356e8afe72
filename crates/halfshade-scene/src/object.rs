//! An object of a scene: its surface, how it reflects, where it is, the spheres that stand for it.

use crate::{
    Deformed, Gloss, GlossVariation, Material, Mesh, Motion, Pose, Skin, SphereFit, SphereSet, Texture, light::is_grey,
};
use glam::{DVec3, Vec3};
use std::sync::Arc;

/// One object: rigid, or deformed by a skin.
#[derive(Debug, Clone)]
pub struct Object {
    /// A name for messages and tables.
    pub name: String,
    /// Surface, in object space.
    pub mesh: Arc<Mesh>,
    /// Material.
    pub material: Material,
    /// Number of leaf spheres that approximate it as a blocker; 0: it receives only.
    pub sphere_count: usize,
    /// Aim of their fit.
    pub fit: SphereFit,
    /// The sphere set in object space, once built (see [`crate::spheres`]); empty when `sphere_count` is 0.
    pub spheres: Option<Arc<SphereSet>>,
    /// Number of receiver clusters of its vertices ([Guerrero2007, 4.1]); 0: left to the strategy.
    pub cluster_count: usize,
    /// Pose over time.
    pub motion: Motion,
    /// Deformation of the mesh over time; the mesh and its spheres are those at rest.
    pub skin: Option<Arc<Skin>>,
}

impl Object {
    /// A still white object that receives only: diffuse, in world space, without spheres.
    pub fn new(name: impl Into<String>, mesh: impl Into<Arc<Mesh>>) -> Self {
        Self {
            name: name.into(),
            mesh: mesh.into(),
            material: Material::default(),
            sphere_count: 0,
            fit: SphereFit::default(),
            spheres: None,
            cluster_count: 0,
            motion: Motion::Still(Pose::IDENTITY),
            skin: None,
        }
    }

    /// Whether its diffuse reflectance is grey everywhere, as far as can be told without looking into textures.
    pub fn is_grey(&self) -> bool {
        let has_grey_medium = self.material.subsurface.is_none_or(|medium| medium.is_grey());
        let has_texture = self.material.texture.is_some() || !self.mesh.textures.is_empty();
        has_grey_medium
            && !has_texture
            && is_grey(self.material.albedo)
            && self.mesh.colors.iter().all(|&color| is_grey(color))
    }

    /// Replaces the material.
    pub fn material(self, material: Material) -> Self {
        Self { material, ..self }
    }

    /// Replaces the material by a diffuse one.
    pub fn albedo(self, albedo: Vec3) -> Self {
        self.material(Material::new(albedo))
    }

    /// Sets how many spheres are to be built.
    pub fn sphere_count(self, sphere_count: usize) -> Self {
        Self { sphere_count, ..self }
    }

    /// Sets what spheres are fitted to when they are built.
    pub fn fit(self, fit: SphereFit) -> Self {
        Self { fit, ..self }
    }

    /// Sets spheres that are built already, their count and fit.
    pub fn spheres(self, spheres: impl Into<Arc<SphereSet>>) -> Self {
        let spheres = spheres.into();
        Self { sphere_count: spheres.spheres.len(), fit: spheres.fit, spheres: Some(spheres), ..self }
    }

    /// Sets the number of receiver clusters.
    pub fn cluster_count(self, cluster_count: usize) -> Self {
        Self { cluster_count, ..self }
    }

    /// Sets the pose over time.
    pub fn motion(self, motion: Motion) -> Self {
        Self { motion, ..self }
    }

    /// Sets one pose for all time.
    pub fn pose(self, pose: Pose) -> Self {
        self.motion(Motion::Still(pose))
    }

    /// Sets the skin that deforms the mesh.
    pub fn skin(self, skin: impl Into<Arc<Skin>>) -> Self {
        Self { skin: Some(skin.into()), ..self }
    }

    /// Vertices at a moment, if it has a skin that fits its mesh.
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
