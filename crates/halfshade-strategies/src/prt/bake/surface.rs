//! All surfaces of a scene at rest: what rays meet, where in the table of rows, and how much it reflects.

use super::rows::{Back, ObjectRows, Rows};
use crate::shared::scene_occlusion::{Meshes, Occlusion};
use glam::{DVec3, Vec3};
use halfshade_rays::{Crossing, SceneRays};
use halfshade_scene::{Frame, Object, Pose};

/// Surfaces of one frame.
pub(crate) struct Surfaces {
    meshes: Meshes,
    rays: SceneRays,
    objects: Vec<PlacedObject>,
}

struct PlacedObject {
    object: Object,
    pose: Pose,
    rows: ObjectRows,
}

/// A surface that a ray meets.
pub(crate) enum Met {
    Reflector(Reflector),
    /// It reflects nothing.
    Dark,
    /// A solid, from within.
    Inside,
}

/// A point that a ray meets and that reflects.
pub(crate) struct Reflector {
    pub(crate) albedo: Vec3,
    /// Rows of the three vertices around it, and their weights.
    pub(crate) rows: [(usize, f64); 3],
}

impl Surfaces {
    pub(crate) fn new(frame: &Frame<'_>, rows: &Rows) -> Self {
        let mut meshes = Meshes::new(frame.scene);
        let rays = meshes.placed(frame);
        let objects = (rows.objects.iter().zip(&frame.world_from_object).enumerate())
            .map(|(number, (&rows, &pose))| PlacedObject { object: frame.object(number), pose, rows });
        Self { meshes, rays, objects: objects.collect() }
    }

    /// Whether anything is in the way of a ray from a surface.
    pub(crate) fn is_blocked(&self, (position, normal): (Vec3, Vec3), direction: Vec3) -> bool {
        Occlusion::new(&self.meshes, &self.rays).blocked(position, normal, direction, f32::INFINITY)
    }

    /// The first surface on the way of such a ray, if it reflects any light.
    pub(crate) fn reflector(&self, start: (Vec3, Vec3), direction: Vec3) -> Option<Reflector> {
        match self.met(start, direction) {
            Some(Met::Reflector(reflector)) => Some(reflector),
            _ => None,
        }
    }

    /// The first surface on the way of such a ray.
    pub(crate) fn met(&self, (position, normal): (Vec3, Vec3), direction: Vec3) -> Option<Met> {
        let (number, crossing) = Occlusion::new(&self.meshes, &self.rays).first_hit(position, normal, direction)?;
        let PlacedObject { object, rows, .. } = &self.objects[number as usize];
        let (triangle, weights) = (crossing.triangle as usize, crossing.weights());
        let first = match (self.is_from_behind(number as usize, &crossing, direction), rows.back) {
            (false, _) => rows.first,
            (true, Back::Rows(back)) => back,
            (true, Back::Dark | Back::Open) => return Some(Met::Inside),
        };
        let albedo = object.albedo_at(triangle, weights);
        let vertices = object.mesh.triangles[triangle].map(|vertex| first + vertex as usize);
        let rows = std::array::from_fn(|k| (vertices[k], weights[k]));
        Some(if albedo == Vec3::ZERO { Met::Dark } else { Met::Reflector(Reflector { albedo, rows }) })
    }

    /// Whether a ray along `direction` meets the side of a triangle that its vertices' normals point away from, whichever way
    /// it is wound.
    fn is_from_behind(&self, number: usize, crossing: &Crossing, direction: Vec3) -> bool {
        let PlacedObject { object, pose, .. } = &self.objects[number];
        let (mesh, triangle) = (&object.mesh, crossing.triangle as usize);
        let [a, b, c] = mesh.triangles[triangle].map(|vertex| mesh.positions[vertex as usize].as_dvec3());
        let face: DVec3 = (b - a).cross(c - a);
        let leaves = face.dot((pose.rotation.conjugate() * direction).as_dvec3()) > 0.0;
        let normal = |vertex: u32| mesh.normals.get(vertex as usize).map_or(DVec3::Y, |normal| normal.as_dvec3());
        let weighted = mesh.triangles[triangle].into_iter().zip(crossing.weights().to_array());
        let outward = face.dot(weighted.map(|(vertex, weight)| weight * normal(vertex)).sum());
        if leaves { outward > 0.0 } else { outward < 0.0 }
    }
}
