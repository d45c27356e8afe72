//! Where everything is in a frame: objects and lights in the space of the distant light, and who is near to whom.

use super::{
    PART,
    basis::Ball,
    vertices::{Between, Vertices},
};
use glam::{DMat3, DQuat, DVec3, Mat3, Vec3};
use halfshade_scene::{EyeLobes, Frame, Mesh, Receivers, Scene, SphereLight};
use halfshade_strategy::StrategyError;
use std::{f32::consts::FRAC_1_PI, ops::Range, sync::Arc};
use wide::f32x8;

/// How far, in radii of its object, a receiver may be from the vertex that its number says it is.
const SAME_PLACE: f32 = 1e-4;

/// What is multiplied or added up [Tamura2006, figure 3].
#[derive(Debug, Clone, Copy)]
pub(super) enum Entity {
    Object(usize),
    Light(usize),
}

/// An object of the scene, as it stays.
struct Body {
    vertices: Arc<Vertices>,
    ball: Ball,
    /// Number of its first vertex among all.
    first_vertex: u32,
    name: String,
}

/// Where an object is in this frame.
#[derive(Debug, Clone)]
pub(super) struct Place {
    /// In light space, about the frame's centre.
    field_center: [f32; 3],
    /// Object space from light space, row by row, without the scale.
    object_from_light: [[f32; 3]; 3],
    inverse_scale: f32,
    /// Over the radius of the object's ball in the world.
    inverse_radius: f32,
}

/// A local light in light space.
#[derive(Debug, Clone, Copy)]
pub(super) struct LocalLight {
    pub(super) center: [f32; 3],
    pub(super) radius: f32,
    pub(super) radiance: [f32; 3],
}

/// The scene in a frame.
#[derive(Default)]
pub(super) struct Arrangement {
    bodies: Vec<Body>,
    pub(super) places: Vec<Place>,
    pub(super) lights: Vec<LocalLight>,
    /// Per object and part of it the others, from near to far.
    orders: Vec<Vec<Vec<Entity>>>,
    /// What receivers reflect towards the eye, if anything is glossy.
    pub(super) eye_lobes: Option<EyeLobes>,
    light_from_world: DQuat,
    center: DVec3,
}

impl Arrangement {
    /// Of the objects' vertices and balls.
    pub(super) fn new(objects: impl Iterator<Item = (Arc<Vertices>, Ball)>, scene: &Scene) -> Self {
        let mut first_vertex = 0;
        let bodies = (objects.zip(&scene.objects))
            .map(|((vertices, ball), object)| {
                let name = object.name.clone();
                let body = Body { vertices, ball, first_vertex, name };
                first_vertex += object.mesh.positions.len() as u32;
                body
            })
            .collect();
        Self { bodies, ..Self::default() }
    }

    pub(super) fn prepare(&mut self, frame: &Frame<'_>) -> Result<(), StrategyError> {
        if frame.scene.objects.len() != self.bodies.len() {
            return Err(StrategyError::Failed("the frame is of another scene than fields were baked for".into()));
        }
        self.eye_lobes = EyeLobes::new(frame);
        self.light_from_world = frame.world_from_environment.as_dquat().normalize().conjugate();
        let middles: Vec<DVec3> = (frame.world_from_object.iter().zip(&self.bodies))
            .map(|(pose, body)| {
                pose.rotation.as_dquat().normalize() * (f64::from(pose.scale) * body.ball.center.as_dvec3())
                    + pose.translation.as_dvec3()
            })
            .collect();
        self.center = middles.iter().sum::<DVec3>() / middles.len().max(1) as f64;
        self.places = (frame.world_from_object.iter().zip(&middles).zip(&self.bodies))
            .map(|((pose, &middle), body)| {
                let light_from_object = self.light_from_world * pose.rotation.as_dquat().normalize();
                let columns = DMat3::from_quat(light_from_object).to_cols_array_2d();
                let world_radius = body.ball.radius * pose.scale;
                Place {
                    field_center: self.point(middle),
                    // The columns of a rotation are the rows of its inverse.
                    object_from_light: columns.map(|column| column.map(|value| value as f32)),
                    inverse_scale: pose.scale.recip(),
                    inverse_radius: world_radius.max(f32::MIN_POSITIVE).recip(),
                }
            })
            .collect();
        self.lights = (frame.lights.iter())
            .map(|light: &SphereLight| LocalLight {
                center: self.point(light.center.as_dvec3()),
                radius: light.radius,
                radiance: light.radiance.to_array(),
            })
            .collect();
        self.orders = (0..self.bodies.len()).map(|object| self.order_for(frame, object)).collect();
        Ok(())
    }

    /// For each part of an object all others, by their distance from the part's middle.
    fn order_for(&self, frame: &Frame<'_>, object: usize) -> Vec<Vec<Entity>> {
        use Entity::{Light, Object};
        let others = (0..self.places.len()).filter(|&other| other != object).map(Object);
        let others: Vec<_> = others.chain((0..self.lights.len()).map(Light)).collect();
        let for_part = |center: &Vec3| {
            let middle = Vec3::from(self.point(frame.world_from_object[object].transform_point(*center).as_dvec3()));
            let distance = |entity: &Entity| match *entity {
                Object(other) => middle.distance_squared(self.places[other].field_center.into()),
                Light(number) => middle.distance_squared(self.lights[number].center.into()),
            };
            let mut order = others.clone();
            order.sort_by(|a, b| distance(a).total_cmp(&distance(b)));
            order
        };
        self.bodies[object].vertices.part_centers.iter().map(for_part).collect()
    }

    /// Name and mesh of an object.
    pub(super) fn object(&self, number: usize) -> (&str, &Mesh) {
        let body = &self.bodies[number];
        (&body.name, body.vertices.mesh())
    }

    /// A point of the world in light space.
    pub(super) fn point(&self, point: DVec3) -> [f32; 3] {
        (self.light_from_world * (point - self.center)).as_vec3().to_array()
    }

    /// A direction of the world in light space.
    pub(super) fn direction(&self, direction: Vec3) -> Vec3 {
        (self.light_from_world * direction.as_dvec3()).as_vec3()
    }

    /// Hands out runs of receivers of one object and one part of it; `None` where there is no such object.
    pub(super) fn each_part(
        &self,
        receivers: Receivers<'_>,
        mut work: impl FnMut(Range<usize>, Option<(usize, usize)>),
    ) {
        let whose = |i: usize| {
            let object = receivers.object[i] as usize;
            self.part_of(object, receivers.index[i]).map(|part| (object, part))
        };
        let mut first = 0;
        while first < receivers.len() {
            let part = whose(first);
            let end = (first + 1..receivers.len()).find(|&i| whose(i) != part).unwrap_or(receivers.len());
            work(first..end, part);
            first = end;
        }
    }

    /// The part of its object that receiver `index` of `object` belongs to; `None` if there is no such object.
    fn part_of(&self, object: usize, index: u32) -> Option<usize> {
        let body = self.bodies.get(object)?;
        let vertex = index.checked_sub(body.first_vertex).map_or(0, |vertex| vertex as usize);
        Some((vertex / PART).min(body.vertices.part_centers.len() - 1))
    }

    /// All entities but the part's own object, from near to far.
    pub(super) fn order(&self, object: usize, part: usize) -> &[Entity] {
        &self.orders[object][part]
    }

    /// The vertex of `object` at a receiver of number `index`, `local` from the middle of its ball in object space; if it
    /// isn't there, the nearest place of the object's surface.
    pub(super) fn vertex(&self, object: usize, index: u32, local: Vec3) -> Option<Between> {
        let body = &self.bodies[object];
        let guess = index.checked_sub(body.first_vertex).map(|vertex| vertex as usize);
        body.vertices.find(guess, local + body.ball.center, SAME_PLACE * body.ball.radius)
    }
}

impl Place {
    /// The rotation from light space to object space, row by row.
    pub(super) fn rotation(&self) -> [[f32; 3]; 3] {
        self.object_from_light
    }

    /// The same as a matrix.
    pub(super) fn turn(&self) -> Mat3 {
        Mat3::from_cols_array_2d(&self.object_from_light).transpose()
    }

    /// Eight points of light space relative to the middle of the object's ball, in the object's space.
    #[inline(always)]
    pub(super) fn in_object(&self, position: &[f32x8; 3]) -> [f32x8; 3] {
        self.turned(position).map(|axis| axis * f32x8::splat(self.inverse_scale))
    }

    /// The same of one point.
    pub(super) fn point_in_object(&self, position: [f32; 3]) -> Vec3 {
        self.in_object(&position.map(f32x8::splat)).map(|axis| axis.as_array()[0]).into()
    }

    /// The largest of the numbers that [`Self::point_in_object`] subtracts, in the object's space: of that its result is rounded.
    pub(super) fn largest_term(&self, position: [f32; 3]) -> f32 {
        position.iter().chain(&self.field_center).fold(0.0, |largest: f32, x| largest.max(x.abs())) * self.inverse_scale
    }

    #[inline(always)]
    fn turned(&self, position: &[f32x8; 3]) -> [f32x8; 3] {
        let offset: [f32x8; 3] = std::array::from_fn(|axis| position[axis] - f32x8::splat(self.field_center[axis]));
        self.object_from_light.map(|row| {
            let [a, b, c] = row.map(f32x8::splat);
            a.mul_add(offset[0], b.mul_add(offset[1], c * offset[2]))
        })
    }

    /// Eight points of light space in the coordinates of shells: distance from the centre in radii of the object,
    /// longitude and latitude as shares of the whole.
    #[inline(always)]
    pub(super) fn on_shells(&self, position: &[f32x8; 3]) -> [f32x8; 3] {
        let [x, y, z] = self.turned(position);
        let distance = (x * x + y * y + z * z).sqrt();
        let cosine = y / distance.fast_max(f32x8::splat(f32::MIN_POSITIVE));
        let polar = cosine.fast_max(-f32x8::ONE).fast_min(f32x8::ONE).acos();
        let v = polar * f32x8::splat(FRAC_1_PI);
        let u = z.atan2(x) * f32x8::splat(0.5 * FRAC_1_PI);
        [distance * f32x8::splat(self.inverse_radius), u, v]
    }
}
