//! Where everything is in a frame: objects and lights in the space of the distant light, and who is near to whom.

use super::basis::Ball;
use crate::shared::{origin::origin_of, vector::dot};
use glam::{DMat3, DQuat, DVec3, Mat3, Vec3};
use halfshade_scene::{EyeLobes, Frame, Mesh, Receivers, Scene, SphereLight};
use halfshade_strategy::StrategyError;
use std::{f32::consts::FRAC_1_PI, ops::Range, sync::Arc};
use wide::f32x8;

/// An object of the scene, as it stays.
struct Body {
    mesh: Arc<Mesh>,
    ball: Ball,
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
    /// Of the object's ball in the world, and 1 over it.
    radius: f32,
    inverse_radius: f32,
}

/// A local light in light space.
#[derive(Debug, Clone)]
pub(super) struct LocalLight {
    pub(super) center: [f32; 3],
    pub(super) radius: f32,
    pub(super) radiance: [f32; 3],
    /// Per object how much of it the light holds.
    holds: Vec<Held>,
}

/// How much of an object lies within a light.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
enum Held {
    /// Not even its middle.
    Nothing,
    Middle,
    All,
}

/// Where eight receivers see a local light.
pub(super) struct LightSeen {
    pub(super) offset: [f32x8; 3],
    pub(super) distance_squared: f32x8,
    /// Where it is all around, on its surface too: a mask.
    pub(super) is_around: f32x8,
}

/// The scene in a frame.
#[derive(Default)]
pub(super) struct Arrangement {
    bodies: Vec<Body>,
    pub(super) places: Vec<Place>,
    pub(super) lights: Vec<LocalLight>,
    /// Per object the others, from near to far.
    orders: Vec<Vec<usize>>,
    /// What receivers reflect towards the eye, if anything is glossy.
    pub(super) eye_lobes: Option<EyeLobes>,
    light_from_world: DQuat,
    center: DVec3,
}

impl Arrangement {
    /// An arrangement of the scene's objects, with their balls.
    pub(super) fn new(scene: &Scene, balls: impl IntoIterator<Item = Ball>) -> Self {
        let bodies = (scene.objects.iter().zip(balls))
            .map(|(object, ball)| Body { mesh: object.mesh.clone(), ball, name: object.name.clone() })
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
        self.center = origin_of(middles.iter().copied());
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
                    radius: world_radius,
                    inverse_radius: world_radius.max(f32::MIN_POSITIVE).recip(),
                }
            })
            .collect();
        self.lights = frame.lights.iter().map(|light| self.local_light(light)).collect();
        self.orders = (0..self.bodies.len()).map(|object| self.order_for(object)).collect();
        Ok(())
    }

    fn local_light(&self, light: &SphereLight) -> LocalLight {
        let center = self.point(light.center.as_dvec3());
        let held = |place: &Place| {
            let distance = Vec3::from(place.field_center).distance(center.into());
            match place.radius {
                radius if distance + radius <= light.radius => Held::All,
                _ if distance <= light.radius => Held::Middle,
                _ => Held::Nothing,
            }
        };
        let holds = self.places.iter().map(held).collect();
        LocalLight { center, radius: light.radius, radiance: light.radiance.to_array(), holds }
    }

    /// All others, by the distance of their middles: the same for all of an object, so that shading has no steps on it.
    fn order_for(&self, object: usize) -> Vec<usize> {
        let middle = Vec3::from(self.places[object].field_center);
        let distance = |other: usize| middle.distance_squared(self.places[other].field_center.into());
        let mut order: Vec<usize> = (0..self.places.len()).filter(|&other| other != object).collect();
        order.sort_by(|&a, &b| distance(a).total_cmp(&distance(b)));
        order
    }

    /// Name and mesh of an object.
    pub(super) fn object(&self, number: usize) -> (&str, &Mesh) {
        let body = &self.bodies[number];
        (&body.name, &body.mesh)
    }

    /// A point of the world in light space.
    pub(super) fn point(&self, point: DVec3) -> [f32; 3] {
        (self.light_from_world * (point - self.center)).as_vec3().to_array()
    }

    /// A direction of the world in light space.
    pub(super) fn direction(&self, direction: Vec3) -> Vec3 {
        (self.light_from_world * direction.as_dvec3()).as_vec3()
    }

    /// Hands out runs of receivers of one object; `None` where there is no such object.
    pub(super) fn each_object(&self, receivers: Receivers<'_>, mut work: impl FnMut(Range<usize>, Option<usize>)) {
        let mut first = 0;
        for run in receivers.object.chunk_by(|a, b| a == b) {
            let object = run[0] as usize;
            work(first..first + run.len(), (object < self.bodies.len()).then_some(object));
            first += run.len();
        }
    }

    /// All objects but this one, from near to far.
    pub(super) fn order(&self, object: usize) -> &[usize] {
        &self.orders[object]
    }

    /// Squared distance of an object's middle from eight places.
    #[inline(always)]
    pub(super) fn distance_squared(&self, object: usize, position: &[f32x8; 3]) -> f32x8 {
        let offset = offset(&self.places[object].field_center, position);
        dot(&offset, &offset)
    }

    /// Where eight receivers see a light.
    #[inline(always)]
    pub(super) fn see(&self, light: usize, position: &[f32x8; 3]) -> LightSeen {
        let light = &self.lights[light];
        let offset = offset(&light.center, position);
        let distance_squared = dot(&offset, &offset);
        let is_around = distance_squared.simd_le(f32x8::splat(light.radius * light.radius));
        LightSeen { offset, distance_squared, is_around }
    }

    /// Whether an object is nearer to each of eight receivers than a light, as a mask: by the middles of both
    /// [Tamura2006, figure 3], which say nothing where one is within the other. Of a light that is all around, what has its
    /// middle in it is nearer; from outside, what is all in it isn't.
    #[inline(always)]
    pub(super) fn is_before(&self, object: usize, light: usize, seen: &LightSeen, position: &[f32x8; 3]) -> f32x8 {
        let held = self.lights[light].holds[object];
        let from_outside = match held {
            Held::All => f32x8::ZERO,
            _ => self.distance_squared(object, position).simd_lt(seen.distance_squared),
        };
        match held {
            Held::Nothing => seen.is_around.select(f32x8::ZERO, from_outside),
            _ => seen.is_around | from_outside,
        }
    }
}

#[inline(always)]
fn offset(to: &[f32; 3], position: &[f32x8; 3]) -> [f32x8; 3] {
    std::array::from_fn(|axis| f32x8::splat(to[axis]) - position[axis])
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
