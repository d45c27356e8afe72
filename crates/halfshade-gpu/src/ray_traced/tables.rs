//! Rows that stay on the device from frame to frame: reflectances of objects, and holes in their meshes.

use super::cutouts::{Holes, add_holes};
use crate::{
    reflectance::{TERM_ROWS, terms},
    rows::Row,
};
use halfshade_scene::Scene;

/// Rows that stay; whoever names one of them counts from the first.
#[derive(Debug)]
pub(super) struct Tables {
    pub(super) rows: Vec<Row>,
    /// By object.
    pub(super) holes: Vec<Holes>,
}

impl Tables {
    pub(super) fn new(scene: &Scene) -> Self {
        // One for what lies on no object, which is diffuse.
        let mut rows: Vec<Row> = vec![[0; 4]; scene.objects.len() + 1];
        for (number, object) in scene.objects.iter().enumerate() {
            let terms = terms(&object.material.reflectance);
            rows[number] = [rows.len() as u32, (terms.len() / TERM_ROWS) as u32, 0, 0];
            rows.extend(terms);
        }
        let holes = add_holes(&mut rows, scene);
        Self { rows, holes }
    }
}
