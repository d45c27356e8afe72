//! Meshes where they stand, for rays.

use crate::{
    binary::around,
    mesh_rays::MeshRays,
    ray::Ray,
    space::Space,
    triangle::Crossing,
    wide_hierarchy::{BoxRay, WideHierarchy},
};
use glam::{DAffine3, DMat3, DVec3, Vec3};
use std::sync::Arc;

/// Rounding of a point on its way from a mesh to the world in single precision, and back, as a part of the coordinates on
/// the way.
const ROUNDING: f64 = 4.0 * f32::EPSILON as f64;

/// A mesh, and where it stands: turned, moved, and scaled by one number above 0.
#[derive(Debug, Clone)]
pub struct Instance {
    /// The mesh.
    pub mesh: Arc<MeshRays>,
    /// The way from its space to the world.
    pub world_from_mesh: DAffine3,
}

/// A hierarchy over meshes where they stand, whose own hierarchies are as they were.
///
/// A ray is met as by [`MeshRays`], but that it may lie beside a triangle by what a mesh's vertices were rounded by on their way
/// to the world.
#[derive(Debug, Clone)]
pub struct SceneRays {
    hierarchy: WideHierarchy,
    space: Space,
    /// By the codes of leaves.
    placed: Vec<Placed>,
}

#[derive(Debug, Clone)]
struct Placed {
    /// Place in the list of instances.
    number: u32,
    mesh: Arc<MeshRays>,
    mesh_from_world: DAffine3,
    /// Absolute values.
    magnitudes: DMat3,
    /// Lengths of the mesh in one of the world.
    scale: f64,
}

impl SceneRays {
    /// For meshes where they stand. One that stands nowhere, its place not being finite or its scale 0, is met by no ray.
    pub fn new(instances: &[Instance]) -> Self {
        let found: Vec<(Placed, [Vec3; 2])> =
            instances.iter().enumerate().filter_map(|(number, instance)| placed(number as u32, instance)).collect();
        let space = Space::around(around(found.iter().map(|(_, corners)| *corners)));
        let boxes: Vec<[Vec3; 2]> =
            (found.iter()).map(|(_, corners)| corners.map(|corner| space.place(corner.as_dvec3()).as_vec3())).collect();
        let mut placed = Vec::new();
        let hierarchy = WideHierarchy::new(&boxes, 1, |slots| {
            placed.extend(slots.iter().map(|&slot| found[slot as usize].0.clone()));
            (placed.len() - 1) as u32
        });
        Self { hierarchy, space, placed }
    }

    /// Half the largest extent of all, give or take a factor of two.
    pub fn half_extent(&self) -> f64 {
        self.space.length_outside(1.0)
    }

    /// Whether `counts` says so of any triangle that the ray crosses, of the instance with that number; they come in no particular
    /// order, and no more after the first that counts.
    #[inline]
    pub fn any(&self, ray: &Ray, mut counts: impl FnMut(u32, &Crossing) -> bool) -> bool {
        let Some((placed, _)) = self.space.place_ray(ray) else { return false };
        self.hierarchy.any(&BoxRay::new(&placed), |leaf| {
            let placed = &self.placed[leaf as usize];
            placed.mesh.any(&placed.ray(ray), |crossing| counts(placed.number, crossing))
        })
    }

    /// The first triangle along the ray that counts, and the number of its instance; distances being those of the world.
    #[inline]
    pub fn closest(&self, ray: &Ray, mut counts: impl FnMut(u32, &Crossing) -> bool) -> Option<(u32, Crossing)> {
        let (placed, skipped) = self.space.place_ray(ray)?;
        let (mut ray, mut boxes, mut closest) = (*ray, BoxRay::new(&placed), None);
        self.hierarchy.nearest(&mut boxes, |leaf, boxes| {
            let placed = &self.placed[leaf as usize];
            let found = placed.mesh.closest(&placed.ray(&ray), |crossing| counts(placed.number, crossing));
            if let Some(crossing) = found {
                let distance = crossing.distance / placed.scale;
                ray.limit = distance;
                boxes.shorten(self.space.length(distance) - skipped);
                closest = Some((placed.number, crossing.with_distance(distance)));
            }
        });
        closest
    }

    /// Memory that it takes beside its meshes.
    pub fn bytes(&self) -> usize {
        size_of_val(self.placed.as_slice()) + self.hierarchy.bytes()
    }
}

impl Placed {
    /// A ray in the space of the mesh. What the mesh's vertices may lie beside their places in the world, its surface may lie
    /// beside the origin.
    #[inline(always)]
    fn ray(&self, ray: &Ray) -> Ray {
        let rounded = ROUNDING * (self.magnitudes * ray.origin.abs() + self.mesh_from_world.translation.abs());
        let is_free = ray.slack == DVec3::ZERO;
        Ray {
            origin: self.mesh_from_world.transform_point3(ray.origin),
            direction: self.mesh_from_world.transform_vector3(ray.direction) / self.scale,
            limit: ray.limit * self.scale,
            slack: if is_free { DVec3::ZERO } else { self.magnitudes * ray.slack + rounded },
            reach: ray.reach * self.scale,
        }
    }
}

/// An instance, and the box around it in the world.
fn placed(number: u32, Instance { mesh, world_from_mesh }: &Instance) -> Option<(Placed, [Vec3; 2])> {
    let [low, high] = mesh.bounds()?.map(|corner| corner.as_dvec3());
    let magnitudes = |matrix: DMat3| DMat3::from_cols(matrix.x_axis.abs(), matrix.y_axis.abs(), matrix.z_axis.abs());
    let middle = world_from_mesh.transform_point3(0.5 * (low + high));
    // Vertices in the world are rounded to single precision by whoever shades them.
    let half = magnitudes(world_from_mesh.matrix3) * (0.5 * (high - low)) * (1.0 + ROUNDING) + ROUNDING * middle.abs();
    let corners = [middle - half, middle + half].map(DVec3::as_vec3);
    let mesh_from_world = world_from_mesh.inverse();
    let scale = mesh_from_world.matrix3.determinant().abs().cbrt();
    let is_somewhere =
        corners.iter().all(|corner| corner.is_finite()) && mesh_from_world.is_finite() && scale.is_normal();
    let magnitudes = magnitudes(mesh_from_world.matrix3);
    is_somewhere.then(|| (Placed { number, mesh: mesh.clone(), mesh_from_world, magnitudes, scale }, corners))
}
