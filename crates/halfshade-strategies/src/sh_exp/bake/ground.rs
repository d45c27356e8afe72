//! `ground=seen`: the surfaces of objects without spheres, once per scene.

use super::{crossings::Crossings, directions::even_directions};
use glam::DVec3;
use halfshade_scene::{Object, Scene};
use halfshade_sh::zonal;

/// Objects without spheres, and the directions in which the others look at them.
#[derive(Debug)]
pub(crate) struct GroundTables {
    pub(crate) bands: usize,
    /// Unit directions in the space of the first object without spheres: they turn with the scene.
    pub(crate) directions: Vec<DVec3>,
    /// Objects without spheres, and their surfaces.
    pub(crate) objects: Vec<(usize, Crossings)>,
    /// Clamped cosine over π by band, times the rotation's factor: ρ_n.
    pub(crate) cosine: Vec<f32>,
}

impl GroundTables {
    /// For the objects of `scene` without spheres, looking into so many `directions`; `None` if there are none.
    ///
    /// Half of a sphere in 128 directions is known to 0.025 of a constant sky's light on any receiver, in 1024 to 0.006.
    pub(crate) fn new(scene: &Scene, bands: usize, directions: usize) -> Option<Self> {
        let without = |(_, object): &(usize, &Object)| object.sphere_count == 0 && !object.mesh.triangles.is_empty();
        let objects: Vec<_> = (scene.objects.iter().enumerate().filter(without))
            .map(|(number, object)| (number, Crossings::new(&object.mesh)))
            .collect();
        if objects.is_empty() {
            return None;
        }
        let cosine = zonal::reflectance(bands).into_iter().map(|value| value as f32).collect();
        Some(Self { bands, directions: even_directions(directions).collect(), objects, cosine })
    }
}
