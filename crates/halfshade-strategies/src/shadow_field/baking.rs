//! What is done once per mesh, whatever the basis.

use super::{
    arrangement::Arrangement,
    basis::{Ball, Storage},
    field::{Shells, Thinning, ball},
    traced::Traced,
    vertices::{OwnRays, Vertices},
};
use halfshade_scene::{
    Cache, Mesh, Progress, Scene,
    cache::{CacheKey, CacheSource},
};
use halfshade_strategy::StrategyError;
use serde::{Serialize, de::DeserializeOwned};
use std::sync::Arc;

/// Of what is cached: raised whenever it would come out differently.
const VERSION: u32 = 3;

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
        CacheKey::new(kind, VERSION).value(&(&mesh.positions, &mesh.triangles, &mesh.normals))
    }

    /// From the cache, or computed; what is read makes up for so many `steps` of progress.
    pub(super) fn cached<T: Serialize + DeserializeOwned>(
        &self,
        key: &CacheKey,
        (steps, progress): (usize, &dyn Progress),
        compute: impl FnOnce() -> T,
    ) -> Result<T, StrategyError> {
        let found = self.cache.get_or_compute(key, || Ok(compute()));
        let (data, outcome) = found.map_err(|error| StrategyError::Failed(error.to_string()))?;
        if outcome.source == CacheSource::Read {
            progress.advance(steps as u64);
        }
        outcome.notes.iter().for_each(|note| progress.note(note));
        Ok(data)
    }

    /// The triangles of a mesh, if they take the place of its field.
    pub(super) fn traced(&self, mesh: &Mesh, ball: Option<Ball>) -> Option<Arc<Traced>> {
        let ball = ball.filter(|_| self.source != Source::Fields)?;
        Some(Arc::new(Traced::new(OwnRays::new(mesh), ball)))
    }

    /// `bake` for every mesh of the scene, once for those that objects share; and where they are.
    pub(super) fn every_mesh<K>(
        &self,
        scene: &Scene,
        progress: &dyn Progress,
        bake: impl Fn(&Mesh) -> Result<K, StrategyError>,
    ) -> Result<(Vec<Arc<K>>, Arrangement), StrategyError> {
        progress.start("shadow fields", (scene.objects.len() * self.sampling.len()) as u64);
        let mut meshes: Vec<(Arc<Mesh>, Arc<K>, Arc<Vertices>)> = Vec::new();
        let (mut known, mut bodies) = (Vec::new(), Vec::new());
        for object in &scene.objects {
            let mesh = &object.mesh;
            let same = meshes.iter().find(|(other, ..)| Arc::ptr_eq(other, mesh));
            let (_, baked, vertices) = match same {
                Some(same) => {
                    progress.advance(self.sampling.len() as u64);
                    same
                }
                None => {
                    meshes.push((mesh.clone(), Arc::new(bake(mesh)?), Arc::new(Vertices::new(mesh))));
                    &meshes[meshes.len() - 1]
                }
            };
            known.push(baked.clone());
            let nowhere = Ball { center: glam::Vec3::ZERO, radius: 0.0 };
            bodies.push((vertices.clone(), ball(mesh).unwrap_or(nowhere)));
        }
        Ok((known, Arrangement::new(bodies.into_iter(), scene)))
    }
}
