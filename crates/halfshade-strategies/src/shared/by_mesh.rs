//! Data that is made of meshes, once for all objects of one mesh.

use halfshade_scene::{Mesh, Object};
use std::sync::Arc;

/// Data of the meshes so far.
pub(crate) struct ByMesh<T>(Vec<(Arc<Mesh>, Arc<T>)>);

impl<T> ByMesh<T> {
    pub(crate) fn new() -> Self {
        Self(Vec::new())
    }

    /// The data of an object's mesh, made if it isn't known; `None` of what deforms, since nothing that was made at rest holds there,
    /// and of a mesh without a normal at each vertex.
    pub(crate) fn of_rigid(&mut self, object: &Object, make: impl FnOnce(&Arc<Mesh>) -> T) -> Option<Arc<T>> {
        let mesh = &object.mesh;
        if object.skin.is_some() || mesh.normals.len() != mesh.positions.len() {
            return None;
        }
        let known = self.0.iter().find(|(known, _)| Arc::ptr_eq(known, mesh)).map(|(_, data)| data.clone());
        Some(known.unwrap_or_else(|| {
            let data = Arc::new(make(mesh));
            self.0.push((mesh.clone(), data.clone()));
            data
        }))
    }
}

/// Each of the data once.
pub(crate) fn distinct<'a, T: 'a>(all: impl Iterator<Item = &'a Arc<T>>) -> impl Iterator<Item = &'a Arc<T>> {
    let mut seen: Vec<&Arc<T>> = Vec::new();
    for data in all {
        if !seen.iter().any(|other| Arc::ptr_eq(other, data)) {
            seen.push(data);
        }
    }
    seen.into_iter()
}
