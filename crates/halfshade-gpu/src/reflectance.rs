//! Models of reflectance as `common/reflectance.wgsl` knows them.

use crate::rows::{Row, bits};
use glam::Vec3;
use halfshade_scene::{Reflectance, Scene};

/// Rows of one term.
pub(crate) const TERM_ROWS: usize = 2;

/// The terms of a reflectance, none if it is diffuse.
pub(crate) fn terms(reflectance: &Reflectance) -> Vec<Row> {
    let term = |scale: Vec3, exponent: f32, axis: Vec3, model: u32| {
        let [x, y, z] = axis.to_array().map(f32::to_bits);
        [bits(scale, exponent), [x, y, z, model]]
    };
    match reflectance {
        Reflectance::Lambert => Vec::new(),
        Reflectance::Phong { specular, exponent } => term(*specular, *exponent, Vec3::ZERO, 0).to_vec(),
        Reflectance::ModifiedPhong { specular, exponent } => term(*specular, *exponent, Vec3::ZERO, 1).to_vec(),
        Reflectance::Lafortune { lobes } => {
            lobes.iter().flat_map(|lobe| term(lobe.scale, lobe.exponent, lobe.axis, 2)).collect()
        }
    }
}

/// Terms of the object of a scene that has the most; 0 where nothing is glossy.
pub(crate) fn most_terms(scene: &Scene) -> usize {
    let glossy = scene.objects.iter().map(|object| &object.material.reflectance).filter(|model| model.is_glossy());
    glossy.map(|model| terms(model).len() / TERM_ROWS).max().unwrap_or(0)
}
