//! Once per mesh, whatever the basis: field and own occlusion, cached; once for objects that share a mesh.

use super::{
    basis::Storage,
    bounds::BoundingSphere,
    field::{Field, Thinning},
    projected::ShellLayout,
    traced::TracedMesh,
    vertices::OwnRays,
};
use halfshade_scene::{
    Cache, Mesh, Object, Progress, Scene,
    cache::{CacheKey, CacheSource},
    mesh::AlphaMask,
};
use halfshade_strategy::StrategyError;
use serde::{Serialize, de::DeserializeOwned};
use std::sync::{Arc, OnceLock};

/// Version of cached data: raised whenever it would come out differently.
const VERSION: u32 = 5;

/// Settings of fields of any basis, and the cache.
pub(crate) struct Baking<'a> {
    pub(crate) cache: &'a Cache,
    pub(crate) layout: ShellLayout,
    pub(crate) thinning: Thinning,
    pub(crate) storage: Storage,
    pub(crate) source: Source,
}

/// Where visibility comes from.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum Source {
    Fields,
    /// Rays from the receiver: no interpolation.
    Traced,
    /// Rays for all objects at once: no products either.
    Together,
}

impl Baking<'_> {
    /// The key of data that depends on a mesh alone.
    pub(crate) fn key(&self, kind: &'static str, mesh: &Mesh) -> CacheKey {
        // Without `..`: what a mesh gains must be thought of here. Colours hide nothing, but for holes.
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

    /// Data from the cache if it `fits`, or computed; reading makes up for so many `steps` of progress.
    pub(crate) fn cached<T: Serialize + DeserializeOwned>(
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

    /// The objects of the scene with what `field` and `own` find of their meshes.
    pub(crate) fn every_object<S, O>(
        &self,
        scene: &Scene,
        progress: &dyn Progress,
        field: impl Fn(&MeshRays<'_>, BoundingSphere) -> Result<Field<S>, StrategyError>,
        own: impl Fn(&MeshRays<'_>) -> Result<O, StrategyError>,
    ) -> Result<Vec<BakedObject<S, O>>, StrategyError> {
        progress.start("shadow fields", (scene.objects.len() * self.layout.len()) as u64);
        let mut baked: Vec<BakedObject<S, O>> = Vec::new();
        for Object { name, mesh, .. } in &scene.objects {
            let (bounds, occlusion) = match baked.iter().find(|other| Arc::ptr_eq(&other.mesh, mesh)) {
                Some(same) => {
                    progress.advance(self.layout.len() as u64);
                    (same.bounds, same.occlusion.clone())
                }
                None => {
                    let bounds = BoundingSphere::of_mesh(mesh);
                    let occlusion = self.occlusion(MeshRays::new(mesh), bounds, &field, &own)?;
                    (bounds.unwrap_or(BoundingSphere::NONE), Arc::new(occlusion))
                }
            };
            baked.push(BakedObject { name: name.clone(), mesh: mesh.clone(), bounds, occlusion });
        }
        Ok(baked)
    }

    fn occlusion<S, O>(
        &self,
        rays: MeshRays<'_>,
        bounds: Option<BoundingSphere>,
        field: &impl Fn(&MeshRays<'_>, BoundingSphere) -> Result<Field<S>, StrategyError>,
        own: &impl Fn(&MeshRays<'_>) -> Result<O, StrategyError>,
    ) -> Result<MeshOcclusion<S, O>, StrategyError> {
        let own = own(&rays)?;
        let (field, traced) = match (bounds, self.source) {
            (Some(bounds), Source::Fields) => (Some(field(&rays, bounds)?), None),
            (Some(bounds), Source::Traced | Source::Together) => (None, Some(TracedMesh { rays: rays.take(), bounds })),
            (None, _) => (None, None),
        };
        Ok(MeshOcclusion { field, traced, own })
    }
}

/// An object of the scene, with what is baked of its mesh: shells in S, own occlusion in O.
pub(crate) struct BakedObject<S, O> {
    pub(crate) name: String,
    pub(crate) mesh: Arc<Mesh>,
    pub(crate) bounds: BoundingSphere,
    /// Shared by all objects of one mesh.
    pub(crate) occlusion: Arc<MeshOcclusion<S, O>>,
}

/// Occlusion by one mesh.
pub(crate) struct MeshOcclusion<S, O> {
    pub(crate) field: Option<Field<S>>,
    /// In the place of a field.
    pub(crate) traced: Option<TracedMesh>,
    /// Own occlusion, by vertex.
    pub(crate) own: O,
}

/// A mesh and the hierarchy over it, which is built if anybody asks: cached data needs no rays.
pub(crate) struct MeshRays<'a> {
    pub(crate) mesh: &'a Mesh,
    rays: OnceLock<OwnRays>,
}

impl<'a> MeshRays<'a> {
    fn new(mesh: &'a Mesh) -> Self {
        Self { mesh, rays: OnceLock::new() }
    }

    pub(crate) fn get(&self) -> &OwnRays {
        self.rays.get_or_init(|| OwnRays::new(self.mesh))
    }

    fn take(self) -> OwnRays {
        self.rays.into_inner().unwrap_or_else(|| OwnRays::new(self.mesh))
    }
}
