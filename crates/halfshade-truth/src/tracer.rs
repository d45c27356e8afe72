//! Rays against one frame of a scene: closest hits, occlusion, the first hits of a picture.

use crate::{
    inward::Inward,
    lights::Lights,
    receiver::Receiver,
    space::TracingSpace,
    translucent::{Translucent, Triangle},
};
use glam::{DVec3, Vec3};
use halfshade_rays::{Crossing, MeshRays, Ray};
use halfshade_scene::{Camera, EyeLobes, Frame, Object, Pose, ReceiverBuffer, ReceiverPoint, SurfacePoint};
use rayon::prelude::*;

/// First hit of a ray.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Hit {
    /// The object's place in `scene.objects`.
    pub object: u32,
    /// The triangle's place in that object's `mesh.triangles`.
    pub triangle: u32,
    /// Weights of the triangle's three vertices, of sum 1.
    pub barycentrics: DVec3,
    /// Distance from the ray's origin, in lengths of its direction.
    pub distance: f64,
}

/// One frame of a scene, ready for rays: the triangles of all objects in one hierarchy, the spheres, and the light.
///
/// Every mesh blocks, that of objects that only receive too; both faces of a triangle do, but for the holes that alpha
/// masks cut. Vertices stand where [`ReceiverBuffer::vertices`] puts them, so that receivers lie on the triangles to
/// the last bit.
#[derive(Debug)]
pub struct Tracer {
    pub(crate) space: TracingSpace,
    /// All triangles, in tracing space.
    rays: MeshRays,
    /// Object and triangle number of each.
    owners: Vec<[u32; 2]>,
    /// Centre in world space and radius of every sphere of every object that has a sphere set.
    pub(crate) spheres: Vec<(DVec3, f64)>,
    /// Object and place in its set of each sphere.
    pub(crate) sphere_owners: Vec<(usize, usize)>,
    /// Every object as it is at this frame, and where it stands.
    pub(crate) objects: Vec<(Object, Pose)>,
    /// By object; nothing for those that light doesn't enter.
    translucent: Vec<Option<Translucent>>,
    pub(crate) lights: Lights,
    /// Reflection of receivers towards the eye, if anything is glossy.
    pub(crate) eye_lobes: Option<EyeLobes>,
    inward: Inward,
    /// Whether any mesh has triangles with holes.
    has_holes: bool,
}

impl Tracer {
    /// Builds the hierarchy for one frame. Triangles with a vertex that is not finite, or with two equal vertices, block
    /// nothing and are left out.
    pub fn new(frame: &Frame<'_>) -> Self {
        let (mut corners, mut owners) = (Vec::new(), Vec::new());
        let (mut spheres, mut sphere_owners) = (Vec::new(), Vec::new());
        let (vertices, mut first_vertex, mut inward) = (ReceiverBuffer::vertices(frame), 0, Inward::default());
        let mut translucent = Vec::new();
        let objects: Vec<(Object, Pose)> =
            (frame.world_from_object.iter().enumerate()).map(|(number, pose)| (frame.object(number), *pose)).collect();
        for (number, (object, pose)) in objects.iter().enumerate() {
            let count = object.mesh.positions.len();
            let part = vertices.view().slice(first_vertex..first_vertex + count);
            let positions: Vec<Vec3> = (0..count).map(|vertex| part.position_at(vertex)).collect();
            inward.add(&object.mesh.triangles, &part);
            translucent.push(object.material.subsurface.map(|medium| {
                let corner = |of: &dyn Fn(usize) -> Vec3, vertex: u32| {
                    if (vertex as usize) < count { of(vertex as usize) } else { Vec3::NAN }.as_dvec3()
                };
                let triangles = object.mesh.triangles.iter().map(|triangle| Triangle {
                    corners: triangle.map(|vertex| corner(&|vertex| part.position_at(vertex), vertex)),
                    normals: triangle.map(|vertex| corner(&|vertex| part.normal_at(vertex), vertex)),
                });
                Translucent::new(&medium, triangles)
            }));
            first_vertex += count;
            for (triangle, corner) in object.mesh.triangles.iter().enumerate() {
                let [a, b, c] = corner.map(|v| positions.get(v as usize).copied().unwrap_or(Vec3::NAN));
                if a.is_finite() && b.is_finite() && c.is_finite() && a != b && b != c && c != a {
                    corners.push([a, b, c]);
                    owners.push([number as u32, triangle as u32]);
                }
            }
            let set = object.spheres.iter().flat_map(|set| &set.spheres);
            sphere_owners.extend(set.clone().enumerate().map(|(place, _)| (number, place)));
            spheres.extend(set.map(|sphere| {
                (pose.transform_point(sphere.center).as_dvec3(), f64::from(pose.scale) * f64::from(sphere.radius))
            }));
        }

        let (mut min, mut max) = (DVec3::INFINITY, DVec3::NEG_INFINITY);
        for corner in corners.iter().flatten() {
            min = min.min(corner.as_dvec3());
            max = max.max(corner.as_dvec3());
        }
        let space = TracingSpace::around(min, max);
        let placed: Vec<Vec3> =
            corners.iter().flatten().map(|point| space.exact_point(point.as_dvec3()).as_vec3()).collect();
        let triangles: Vec<[u32; 3]> = (0..corners.len() as u32).map(|i| [3 * i, 3 * i + 1, 3 * i + 2]).collect();
        let rays = MeshRays::new(&placed, &triangles);
        let has_holes = objects.iter().any(|(object, _)| object.mesh.has_cutouts());
        Self {
            space,
            rays,
            owners,
            spheres,
            sphere_owners,
            objects,
            translucent,
            lights: Lights::new(frame),
            eye_lobes: EyeLobes::new(frame),
            inward,
            has_holes,
        }
    }

    /// The surface of an object that light enters, seen from its front: `None` for any other object.
    pub(crate) fn translucent(&self, object: u32) -> Option<&Translucent> {
        self.translucent.get(object as usize)?.as_ref()
    }

    /// Whether light enters any object.
    pub(crate) fn is_translucent(&self) -> bool {
        self.translucent.iter().any(Option::is_some)
    }

    /// A receiver, its rays' origin lifted off the surface and, at the rim of a smooth patch, drawn onto the patch.
    pub(crate) fn receiver(&self, position: Vec3, normal: Vec3) -> Receiver {
        let unit = normal.as_dvec3().normalize_or(DVec3::Y);
        let inward = self.inward.at(position, normal).as_dvec3();
        // Twice as far as the receiver may lie off the surface, as measured along each direction.
        let rounding = self.space.rounding(position);
        let lift = [unit, inward].map(|direction| 2.0 * direction.abs().dot(rounding) * direction);
        let origin = self.space.exact_point(position.as_dvec3()) + lift[0] + lift[1];
        Receiver { slack: rounding, ..Receiver::new(origin, position.as_dvec3(), unit) }
    }

    /// Number of triangles that block.
    pub fn triangle_count(&self) -> usize {
        self.owners.len()
    }

    /// Number of spheres that block in the sphere reference.
    pub fn sphere_count(&self) -> usize {
        self.spheres.len()
    }

    /// The first triangle along a ray in world space, or `None`; also `None` if the ray is not finite or has no
    /// direction. The origin may lie anywhere.
    pub fn closest_hit(&self, origin: Vec3, direction: Vec3) -> Option<Hit> {
        let hit = self.nearest(&self.free_ray(origin, direction)?)?;
        Some(Hit { distance: hit.distance / f64::from(direction.length()), ..hit })
    }

    /// The first triangle along a ray that leaves a surface.
    pub(crate) fn first_hit(&self, from: &Receiver, direction: Vec3) -> Option<Hit> {
        self.nearest(&from.ray(direction, f32::INFINITY))
    }

    /// The object that a ray of a given length, in tracing space, meets first when it leaves a surface.
    pub(crate) fn first_object(&self, from: &Receiver, direction: Vec3, distance: f32) -> Option<u32> {
        Some(self.nearest(&from.ray(direction, distance))?.object)
    }

    /// Whether anything lies along a ray in world space, however far.
    pub fn occluded(&self, origin: Vec3, direction: Vec3) -> bool {
        self.free_ray(origin, direction).is_some_and(|ray| self.is_blocked(&ray))
    }

    /// Whether anything lies along a ray of a given length, in tracing space, that leaves a surface.
    pub(crate) fn is_blocked_from(&self, from: &Receiver, direction: Vec3, distance: f32) -> bool {
        self.is_blocked(&from.ray(direction, distance))
    }

    /// A ray in tracing space from a point of the world.
    fn free_ray(&self, origin: Vec3, direction: Vec3) -> Option<Ray> {
        let unit = direction.as_dvec3().try_normalize()?;
        Some(Ray::new(self.space.exact_point(origin.as_dvec3()), unit))
    }

    fn nearest(&self, ray: &Ray) -> Option<Hit> {
        let crossing = match self.has_holes {
            true => self.rays.closest(ray, |crossing| self.is_whole(crossing)),
            false => self.rays.closest(ray, |_| true),
        }?;
        let [object, triangle] = self.owners[crossing.triangle as usize];
        let distance = self.space.length_in_world(crossing.distance);
        Some(Hit { object, triangle, barycentrics: crossing.weights(), distance })
    }

    #[inline]
    fn is_blocked(&self, ray: &Ray) -> bool {
        match self.has_holes {
            true => self.rays.any(ray, |crossing| self.is_whole(crossing)),
            false => self.rays.any(ray, |_| true),
        }
    }

    /// Whether there is no hole where a ray crosses a triangle.
    fn is_whole(&self, crossing: &Crossing) -> bool {
        let [object, triangle] = self.owners[crossing.triangle as usize].map(|number| number as usize);
        let mesh = &self.objects[object].0.mesh;
        mesh.mask_of(triangle).is_none() || !mesh.is_cut_out(triangle, crossing.weights())
    }

    /// The first hit through the centre of every pixel, row by row from the top.
    pub fn primary_hits(&self, camera: &Camera) -> Vec<Option<Hit>> {
        let [width, height] = camera.resolution;
        (0..width as usize * height as usize)
            .into_par_iter()
            .map(|pixel| {
                let (column, row) = (pixel % width as usize, pixel / width as usize);
                self.closest_hit(camera.eye, camera.ray_direction(column as f32 + 0.5, row as f32 + 0.5))
            })
            .collect()
    }

    /// The receiver at a hit: position, normal and albedo interpolated over the triangle. `direction` is the ray's; the
    /// normal is on the side that it came from.
    pub fn receiver_at(&self, hit: &Hit, direction: Vec3) -> ReceiverPoint {
        let (object, pose) = &self.objects[hit.object as usize];
        let (mesh, weights) = (&object.mesh, hit.barycentrics.to_array());
        let vertices = mesh.triangles[hit.triangle as usize].map(|v| v as usize);
        let blend = |value: &dyn Fn(usize) -> Vec3| -> DVec3 {
            vertices.iter().zip(weights).map(|(&vertex, weight)| weight * value(vertex).as_dvec3()).sum()
        };
        let position = blend(&|v| pose.transform_point(mesh.positions[v])).as_vec3();
        let [a, b, c] = vertices.map(|v| pose.transform_point(mesh.positions[v]).as_dvec3());
        let face = (b - a).cross(c - a).normalize_or(DVec3::Y);
        let normal = blend(&|v| pose.transform_direction(mesh.normals[v])).normalize_or(face).as_vec3();
        // Towards where the ray came from, whichever way the mesh's normals and its winding say is outside.
        let toward = if face.dot(direction.as_dvec3()) > 0.0 { -face } else { face };
        let from_behind = normal.as_dvec3().dot(toward) < 0.0;
        ReceiverPoint {
            position,
            normal: if from_behind { -normal } else { normal },
            albedo: object.albedo_at(hit.triangle as usize, hit.barycentrics),
            gloss: object.gloss_at(hit.triangle as usize, hit.barycentrics),
            object: hit.object,
            surface: SurfacePoint::Triangle {
                triangle: hit.triangle,
                barycentric: hit.barycentrics.as_vec3().to_array(),
                from_behind,
            },
        }
    }
}
