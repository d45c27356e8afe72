//! Rows that are finished are cached in chunks: who is interrupted goes on from there.

use halfshade_scene::{
    Cache, Frame, Material, Mesh, Progress, SceneError,
    cache::{CacheKey, CacheSource},
    mesh::AlphaMask,
};
use halfshade_strategy::StrategyError;
use rayon::prelude::*;
use serde::{Serialize, de::DeserializeOwned};

/// Version of cached data: raised whenever it would come out differently.
const VERSION: u32 = 1;

/// Rows of a chunk: a second or two of rays.
pub(crate) const ROWS: usize = 4096;

/// Baking in chunks.
pub(crate) struct Chunks<'a> {
    cache: &'a Cache,
    progress: &'a dyn Progress,
}

impl<'a> Chunks<'a> {
    pub(crate) fn new(cache: &'a Cache, progress: &'a dyn Progress) -> Self {
        Self { cache, progress }
    }

    /// Results of `row` for so many rows, from the cache if each `fits`, else on all threads.
    pub(crate) fn of<T: Serialize + DeserializeOwned + Send>(
        &self,
        key: &CacheKey,
        rows: usize,
        fits: impl Fn(&T) -> bool,
        row: impl Fn(usize) -> T + Sync,
    ) -> Result<Vec<T>, StrategyError> {
        let mut all = Vec::with_capacity(rows);
        for first in (0..rows).step_by(ROWS) {
            let range = first..(first + ROWS).min(rows);
            let is_whole = |found: &Vec<T>| found.len() == range.len() && found.iter().all(&fits);
            let compute = || {
                Ok(range
                    .clone()
                    .into_par_iter()
                    .map(|number| {
                        let found = row(number);
                        self.progress.advance(1);
                        found
                    })
                    .collect())
            };
            let found = self.cache.get_or_compute(&key.clone().value(&(first as u64)), is_whole, compute);
            let (chunk, outcome) = found.map_err(told)?;
            if outcome.source == CacheSource::Read {
                self.progress.advance(range.len() as u64);
            }
            outcome.notes.iter().for_each(|note| self.progress.note(note));
            all.extend(chunk);
        }
        Ok(all)
    }
}

/// An error of the cache, as one of the strategy.
pub(crate) fn told(error: SceneError) -> StrategyError {
    StrategyError::Failed(error.to_string())
}

/// The key of what so many directions meet where surfaces are.
pub(crate) fn shape_key(frame: &Frame<'_>, directions: usize) -> CacheKey {
    let mut key = CacheKey::new("transfer", VERSION).value(&(directions as u64));
    for (number, object) in frame.scene.objects.iter().enumerate() {
        // Without `..`: what a mesh gains must be thought of here. Colours hide nothing, but for holes.
        let Mesh { positions: _, normals: _, triangles, colors: _, texture_coordinates, textures: _, masks, coverage } =
            &*object.mesh;
        key = key.value(&(frame.positions(number), triangles, frame.normals(number), frame.world_from_object[number]));
        let holes = object.mesh.has_cutouts().then_some((coverage, texture_coordinates));
        key = key.value(&holes);
        for AlphaMask { texture, cutoff } in masks {
            key = key.value(&(texture.as_deref(), cutoff));
        }
    }
    key
}

/// The key of what they reflect, in so many bands.
pub(crate) fn colour_key(shape: &CacheKey, frame: &Frame<'_>, bands: usize) -> CacheKey {
    let mut key = shape.clone().bytes(b"reflected").value(&(bands as u64));
    for object in &frame.scene.objects {
        let Mesh { colors, texture_coordinates, textures, .. } = &*object.mesh;
        let Material { albedo, texture, subsurface, .. } = &object.material;
        key = key.value(&(albedo, texture.as_deref(), colors));
        if let Some(medium) = subsurface {
            key = key.value(medium);
        }
        let has_pictures = texture.is_some() || !textures.is_empty();
        key = key.value(&has_pictures.then_some(texture_coordinates));
        for texture in textures {
            key = key.value(&**texture);
        }
    }
    key
}
