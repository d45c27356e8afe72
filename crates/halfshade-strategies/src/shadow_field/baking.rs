//! What is done once per mesh, whatever the basis.

use super::{
    arrangement::Arrangement,
    basis::{Ball, Storage},
    field::{Field, Shells, Thinning, ball},
    traced::Traced,
    vertices::OwnRays,
};
use halfshade_scene::{
    Cache, Mesh, Progress, Scene,
    cache::{CacheKey, CacheSource},
    mesh::AlphaMask,
};
use halfshade_strategy::StrategyError;
use serde::{Serialize, de::DeserializeOwned};
use std::sync::{Arc, OnceLock};

/// Of what is cached: raised whenever it would come out differently.
const VERSION: u32 = 5;

/// What fields of any basis are baked with.
pub(super) struct Baking<'a> {
    pub(super) cache: &'a Cache,
    pub(super) sampling: Shells,
    pub(super) thinning: Thinning,
    pub(super) storage: Storage,
    pub(super) source: Source,
}

/// Where visibility comes from.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Source {
    Fields,
    /// Rays from the receiver: no interpolation.
    Traced,
    /// Rays for all objects at once: no products either.
    Together,
}

impl Baking<'_> {
    /// The key of what depends on a mesh alone.
    pub(super) fn key(&self, kind: &'static str, mesh: &Mesh) -> CacheKey {
        // Without `..`: what a mesh gains must be thought of here. How it is coloured hides nothing, but for holes.
        let Mesh { positions, normals, triangles, colors: _, texture_coordinates, textures: _, masks, coverage } = mesh;
        let mut key = CacheKey::new(kind, VERSION).value(&(positions, triangles, normals));
        if mesh.has_cutouts() {
            key = key.value(&(coverage, texture_coordinates));
        }
        for AlphaMask { texture, cutoff } in masks {
            key = key.value(&(texture.as_deref(), cutoff));
        }
        key
    }

    /// From the cache if it `fits`, or computed; what is read makes up for so many `steps` of progress.
    pub(super) fn cached<T: Serialize + DeserializeOwned>(
        &self,
        key: &CacheKey,
        fits: impl FnOnce(&T) -> bool,
        (steps, progress): (usize, &dyn Progress),
        compute: impl FnOnce() -> T,
    ) -> Result<T, StrategyError> {
        let found = self.cache.get_or_compute(key, fits, || Ok(compute()));
        let (data, outcome) = found.map_err(|error| StrategyError::Failed(error.to_string()))?;
        if outcome.source == CacheSource::Read {
            progress.advance(steps as u64);
        }
        outcome.notes.iter().for_each(|note| progress.note(note));
        Ok(data)
    }

    /// What `field` and `own` find of every mesh of the scene, once for those that objects share; and where they are.
    pub(super) fn every_mesh<S, O>(
        &self,
        scene: &Scene,
        progress: &dyn Progress,
        field: impl Fn(&MeshRays<'_>, Ball) -> Result<Field<S>, StrategyError>,
        own: impl Fn(&MeshRays<'_>) -> Result<O, StrategyError>,
    ) -> Result<(KnownMeshes<S, O>, Arrangement), StrategyError> {
        progress.start("shadow fields", (scene.objects.len() * self.sampling.len()) as u64);
        let mut known: KnownMeshes<S, O> = Vec::new();
        let mut balls: Vec<Ball> = Vec::new();
        for object in &scene.objects {
            let mesh = &object.mesh;
            let before = &scene.objects[..known.len()];
            if let Some(same) = before.iter().position(|other| Arc::ptr_eq(&other.mesh, mesh)) {
                progress.advance(self.sampling.len() as u64);
                known.push(known[same].clone());
                balls.push(balls[same]);
                continue;
            }
            let (rays, ball) = (MeshRays::new(mesh), ball(mesh));
            let own = own(&rays)?;
            let (field, traced) = match (ball, self.source) {
                (Some(ball), Source::Fields) => (Some(field(&rays, ball)?), None),
                (Some(ball), Source::Traced | Source::Together) => (None, Some(Traced::new(rays.take(), ball))),
                (None, _) => (None, None),
            };
            known.push(Arc::new(Known { field, traced, own }));
            balls.push(ball.unwrap_or(Ball { center: glam::Vec3::ZERO, radius: 0.0 }));
        }
        Ok((known, Arrangement::new(scene, balls)))
    }
}

/// What is known of one mesh.
pub(super) struct Known<S, O> {
    pub(super) field: Option<Field<S>>,
    /// Instead of a field.
    pub(super) traced: Option<Traced>,
    /// Of its vertices.
    pub(super) own: O,
}

/// Per object, shared by those of one mesh.
pub(super) type KnownMeshes<S, O> = Vec<Arc<Known<S, O>>>;

/// A mesh and the hierarchy over it, which is built if anybody asks: what is cached needs no rays.
pub(super) struct MeshRays<'a> {
    pub(super) mesh: &'a Mesh,
    rays: OnceLock<OwnRays>,
}

impl<'a> MeshRays<'a> {
    fn new(mesh: &'a Mesh) -> Self {
        Self { mesh, rays: OnceLock::new() }
    }

    pub(super) fn get(&self) -> &OwnRays {
        self.rays.get_or_init(|| OwnRays::new(self.mesh))
    }

    fn take(self) -> OwnRays {
        self.rays.into_inner().unwrap_or_else(|| OwnRays::new(self.mesh))
    }
}
