//! Sphere sets of all objects of a scene.

use super::{BuildOptions, SphereSet};
use crate::{Cache, Object, Progress, Scene, SceneError};
use std::sync::Arc;

impl Scene {
    /// Builds the sphere set of every object that blocks, or reads it from the cache; objects with the same mesh,
    /// count and fit share one. Returns what the user should know: notes on caching and on meshes.
    ///
    /// # Errors
    /// Those of [`SphereSet::build`], naming the object.
    pub fn build_spheres(&mut self, cache: &Cache, progress: &dyn Progress) -> Result<Vec<String>, SceneError> {
        let mut notes = Vec::new();
        for k in 0..self.objects.len() {
            let (done, rest) = self.objects.split_at_mut(k);
            let object = &mut rest[0];
            if object.sphere_count == 0 {
                object.spheres = None;
                continue;
            }
            let same = |other: &&Object| {
                (other.sphere_count, other.fit) == (object.sphere_count, object.fit)
                    && (Arc::ptr_eq(&other.mesh, &object.mesh)
                        || (other.mesh.positions == object.mesh.positions
                            && other.mesh.triangles == object.mesh.triangles))
            };
            if let Some(other) = done.iter().find(same) {
                object.spheres.clone_from(&other.spheres);
                continue;
            }
            let options = BuildOptions { fit: object.fit, ..BuildOptions::default() };
            let (set, outcome) =
                SphereSet::build_cached(&object.mesh, object.sphere_count, &options, cache, progress).map_err(
                    |error| SceneError { problem: format!("object {}: {}", object.name, error.problem), ..error },
                )?;
            notes.extend(outcome.notes.iter().chain(&set.notes).map(|note| format!("object {}: {note}", object.name)));
            object.spheres = Some(Arc::new(set));
        }
        Ok(notes)
    }
}
