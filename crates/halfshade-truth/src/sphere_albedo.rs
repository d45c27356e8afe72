//! Albedo and gloss on the spheres that stand for a mesh: those of the mesh's nearest vertex.

use crate::tracer::Tracer;
use glam::Vec3;
use halfshade_scene::Gloss;
use rayon::prelude::*;
use std::f32::consts::{PI, TAU};

/// Cells of a table along the polar angle; twice as many around.
const ROWS: usize = 16;

/// A table over directions from each sphere's centre, in world axes.
#[derive(Debug)]
pub(crate) struct SphereAlbedo(Vec<Vec<(Vec3, Gloss)>>);

impl SphereAlbedo {
    /// For all spheres of `tracer`, in its order.
    pub(crate) fn new(tracer: &Tracer) -> Self {
        let table = |&(number, sphere): &(usize, usize)| -> Vec<(Vec3, Gloss)> {
            let (object, pose) = &tracer.objects[number];
            let uniform = object.mesh.colors.is_empty() && object.mesh.textures.is_empty();
            let even = object.material.texture.is_none() && object.material.gloss_variation.is_none();
            if uniform && even || object.mesh.positions.is_empty() {
                return vec![(object.material.albedo, Gloss::NEUTRAL)];
            }
            let sphere = object.spheres.as_ref().map(|set| set.spheres[sphere]);
            (0..2 * ROWS * ROWS)
                .map(|cell| {
                    let polar = PI * ((cell / (2 * ROWS)) as f32 + 0.5) / ROWS as f32;
                    let azimuth = TAU * ((cell % (2 * ROWS)) as f32 + 0.5) / (2 * ROWS) as f32 - PI;
                    let (sine, cosine) = polar.sin_cos();
                    let in_world = Vec3::new(sine * azimuth.cos(), sine * azimuth.sin(), cosine);
                    let direction = pose.rotation.conjugate() * in_world;
                    let point = sphere.map_or(direction, |sphere| sphere.center + sphere.radius * direction);
                    let distance = |&vertex: &usize| object.mesh.positions[vertex].distance_squared(point);
                    let nearest = (0..object.mesh.positions.len()).min_by(|a, b| distance(a).total_cmp(&distance(b)));
                    nearest.map_or((object.material.albedo, Gloss::NEUTRAL), |vertex| {
                        (object.albedo_at_vertex(vertex), object.gloss_at_vertex(vertex))
                    })
                })
                .collect()
        };
        Self(tracer.sphere_owners.par_iter().map(table).collect())
    }

    /// Albedo and gloss of a sphere where its surface has this unit normal.
    pub(crate) fn at(&self, sphere: usize, normal: Vec3) -> (Vec3, Gloss) {
        let table = &self.0[sphere];
        if table.len() == 1 {
            return table[0];
        }
        let row = (normal.z.clamp(-1.0, 1.0).acos() / PI * ROWS as f32) as usize;
        let column = ((normal.y.atan2(normal.x) + PI) / TAU * (2 * ROWS) as f32) as usize;
        table[row.min(ROWS - 1) * 2 * ROWS + column.min(2 * ROWS - 1)]
    }
}
