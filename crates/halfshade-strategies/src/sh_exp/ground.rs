//! `ground=seen`: objects without spheres, as the others see them.
//!
//! The ground of a scene has no spheres; as published it neither blocks nor reflects, though it fills half of what an
//! object standing on it sees. Here every object with spheres looks around itself once per frame: rays that meet an object
//! without spheres find, instead of the environment, a point that radiates. Blockers of a receiver lie before that point as
//! they lie before the environment, so that both are multiplied with the same visibility V:
//!
//! ```text
//! L += albedo Σ_i (ρ_n * V)_i G_i        G(ω) = L_ground(ω) - L_env(ω) where a ray along ω meets such an object, else 0
//! ```
//!
//! with ρ_n the clamped cosine over π. L_ground starts at 0, what the ground takes away; with every bounce of light that a
//! scene asks for it becomes what the shadowed points radiate that the rays have met. G is an affine function of the
//! receiver's place, fitted to what is seen from the middle of the object and from six places around it: there are no
//! borders, and its lower parts see more of the ground and of the object's own shadow.
//!
//! Limits: G has the bands of visibility, so that a contact shadow is as soft as the last band. An object without spheres
//! doesn't see itself or its like, which is right for a plane; of such an object that deforms the mesh at rest is seen. A
//! sun below the ground still shines on objects.

use super::{
    crossings::{Crossing, Crossings},
    directions::{even_directions, weighted},
};
use glam::{DQuat, DVec3, Vec3};
use halfshade_scene::{Frame, RadianceBuffer, ReceiverBuffer, Scene, light::DistantLight, mesh};
use halfshade_sh::{
    basis,
    kernel::{self, ShBatch},
    lat_long, zonal,
};
use rayon::prelude::*;
use wide::f32x8;

/// How far from the middle of an object's box the places around it are, in half extents.
const AROUND: f64 = 0.6;

/// The middle and a place at either end of each axis.
const PLACES: usize = 7;

/// Bands in which the light that the ground takes away is known.
const ENVIRONMENT_BANDS: usize = 6;

/// What objects with spheres see of the others.
#[derive(Debug)]
pub(super) struct Ground {
    bands: usize,
    /// Unit directions in the space of the first object without spheres: they turn with the scene.
    even: Vec<DVec3>,
    directions: Directions,
    /// What light of the environment, without its sun, along the directions was found from.
    environment: Option<DistantLight>,
    /// Objects without spheres, and their surfaces.
    others: Vec<(usize, Crossings)>,
    /// Clamped cosine over π by band, times the rotation's factor: ρ_n.
    cosine: Vec<f32>,
    /// Per object; none where it has no spheres, or sees nothing.
    fields: Vec<Option<Field>>,
    /// The same of a black ground: what it takes away.
    taken: Vec<Option<Field>>,
    /// Points that were met.
    pub(super) points: ReceiverBuffer,
    /// Of each point: object, place and direction.
    met: Vec<[u32; 3]>,
}

/// Directions in light space.
#[derive(Debug, Default)]
struct Directions {
    /// The turn that led there.
    turn: Option<DQuat>,
    /// Unit, with the basis there times the solid angle of each.
    weighted: Vec<(DVec3, Vec<f32>)>,
    /// Light of the environment along each.
    light: Vec<Vec3>,
}

/// What is seen around an object, as an affine function of the place.
#[derive(Debug, Clone)]
struct Field {
    /// In light space, as the blockers are.
    center: [f32; 3],
    /// Gradients of the places' three coordinates, which are ±1 at the places around the middle.
    axes: [[f32; 3]; 3],
    /// G at the middle and its change along each axis, per channel.
    coefficients: [[Vec<f32>; 3]; 4],
}

impl Ground {
    /// For the objects of `scene` without spheres, looking into so many `directions`; `None` if there are none.
    ///
    /// Half of a sphere in 128 directions is known to 0.025 of a constant sky's light on any receiver, in 1024 to 0.006.
    pub(super) fn new(scene: &Scene, bands: usize, directions: usize) -> Option<Self> {
        let without = |(_, object): &(usize, &halfshade_scene::Object)| {
            object.sphere_count == 0 && !object.mesh.triangles.is_empty()
        };
        let others: Vec<_> = (scene.objects.iter().enumerate().filter(without))
            .map(|(number, object)| (number, Crossings::new(&object.mesh)))
            .collect();
        if others.is_empty() {
            return None;
        }
        let cosine = zonal::reflectance(bands).into_iter().map(|value| value as f32).collect();
        Some(Self {
            bands,
            even: even_directions(directions).collect(),
            directions: Directions::default(),
            environment: None,
            others,
            cosine,
            fields: Vec::new(),
            taken: Vec::new(),
            points: ReceiverBuffer::default(),
            met: Vec::new(),
        })
    }

    /// Looks around all objects with spheres; what is met is black. `rotation` and `center` lead into light space.
    pub(super) fn look(&mut self, frame: &Frame<'_>, rotation: DQuat, center: DVec3) {
        let space = self
            .others
            .first()
            .map_or(DQuat::IDENTITY, |(object, _)| frame.world_from_object[*object].rotation.as_dquat().normalize());
        self.turn(rotation * space);
        self.know(&frame.scene.environment.base);
        let scene = frame.scene;
        self.fields = vec![None; scene.objects.len()];
        let seen: Vec<_> = (0..scene.objects.len())
            .into_par_iter()
            .filter(|&object| scene.objects[object].sphere_count > 0)
            .filter_map(|object| {
                let (middle, axes) = box_of(frame, object)?;
                let places = (0..PLACES).into_par_iter().map(|place| {
                    let offset = match place.checked_sub(1) {
                        None => DVec3::ZERO,
                        Some(k) => axes[k / 2] * if k % 2 == 0 { 1.0 } else { -1.0 },
                    };
                    self.met_from(frame, middle + offset, rotation)
                });
                Some((object, middle, axes, places.collect::<Vec<_>>()))
            })
            .collect();
        self.points.clear();
        self.met.clear();
        for (object, middle, axes, places) in seen {
            for (place, met) in places.into_iter().enumerate() {
                for (direction, other, crossing) in met {
                    let (position, normal) = surface_point(frame, other, &crossing);
                    let albedo = scene.objects[other].albedo_at(crossing.triangle, crossing.weights);
                    self.points.push(position, normal, albedo, other as u32);
                    self.met.push([object as u32, place as u32, direction]);
                }
            }
            let light_from_world = |v: DVec3| (rotation * v).as_vec3().to_array();
            self.fields[object] = Some(Field {
                center: light_from_world(middle - center),
                axes: axes.map(|axis| light_from_world(axis / axis.length_squared())),
                coefficients: std::array::from_fn(|_| std::array::from_fn(|_| vec![0.0; self.bands * self.bands])),
            });
        }
        let black = RadianceBuffer::zeros(self.points.len());
        self.shine(&black);
        self.taken.clone_from(&self.fields);
    }

    /// Lets the points that were met radiate.
    pub(super) fn shine(&mut self, radiance: &RadianceBuffer) {
        let count = self.bands * self.bands;
        let mut of_places = vec![[0.0_f32; 3]; self.fields.len() * PLACES * count];
        for (point, &[object, place, direction]) in self.met.iter().enumerate() {
            let instead = radiance.at(point) - self.directions.light[direction as usize];
            let first = (object as usize * PLACES + place as usize) * count;
            for (sum, value) in
                of_places[first..][..count].iter_mut().zip(&self.directions.weighted[direction as usize].1)
            {
                (0..3).for_each(|channel| sum[channel] += instead[channel] * value);
            }
        }
        for (object, field) in self.fields.iter_mut().enumerate() {
            let Some(field) = field else { continue };
            let at = |place: usize, i: usize, channel: usize| of_places[(object * PLACES + place) * count + i][channel];
            for channel in 0..3 {
                for i in 0..count {
                    // Least squares: the mean, and half the difference of the two ends of an axis.
                    field.coefficients[0][channel][i] =
                        (0..PLACES).map(|place| at(place, i, channel)).sum::<f32>() / PLACES as f32;
                    for axis in 0..3 {
                        let difference = at(2 * axis + 1, i, channel) - at(2 * axis + 2, i, channel);
                        field.coefficients[axis + 1][channel][i] = 0.5 * difference;
                    }
                }
            }
        }
    }

    /// What eight white receivers on `object` get of it, at `position` in light space with unit `normal`.
    #[inline(always)]
    pub(super) fn radiance<const N: usize>(
        &self,
        object: u32,
        position: &[f32x8; 3],
        normal: &[f32x8; 3],
        visibility: &ShBatch<N>,
    ) -> [f32x8; 3] {
        self.of_fields(&self.fields, object, position, normal, visibility)
    }

    /// The part of [`Self::radiance`] that the ground takes away of the environment's light, below 0 but for ringing.
    #[inline(always)]
    pub(super) fn taken<const N: usize>(
        &self,
        object: u32,
        position: &[f32x8; 3],
        normal: &[f32x8; 3],
        visibility: &ShBatch<N>,
    ) -> [f32x8; 3] {
        self.of_fields(&self.taken, object, position, normal, visibility)
    }

    #[inline(always)]
    fn of_fields<const N: usize>(
        &self,
        fields: &[Option<Field>],
        object: u32,
        position: &[f32x8; 3],
        normal: &[f32x8; 3],
        visibility: &ShBatch<N>,
    ) -> [f32x8; 3] {
        let Some(field) = fields.get(object as usize).and_then(Option::as_ref) else { return [f32x8::ZERO; 3] };
        let cosine = kernel::times_bands(&kernel::basis::<f32x8, N>(*normal), &self.cosine);
        let weights = kernel::product(&cosine, visibility);
        let offset: [f32x8; 3] = std::array::from_fn(|k| position[k] - f32x8::splat(field.center[k]));
        let along = field.axes.map(|axis| {
            let [x, y, z] = axis.map(f32x8::splat);
            x.mul_add(offset[0], y.mul_add(offset[1], z * offset[2]))
        });
        std::array::from_fn(|channel| {
            let part = |k: usize| {
                let coefficients = &field.coefficients[k][channel];
                let pairs = weights.iter().zip(coefficients);
                pairs.fold(f32x8::ZERO, |sum, (weight, &value)| weight.mul_add(f32x8::splat(value), sum))
            };
            let changes = along[0].mul_add(part(1), along[1].mul_add(part(2), along[2] * part(3)));
            part(0) + changes
        })
    }

    pub(super) fn bytes(&self) -> usize {
        let field = 12 * self.bands * self.bands * size_of::<f32>();
        2 * self.fields.iter().flatten().count() * field + size_of_val(self.met.as_slice())
    }

    /// Turns the directions into light space.
    fn turn(&mut self, turn: DQuat) {
        if self.directions.turn != Some(turn) {
            let weighted = weighted(self.bands, self.even.iter().map(|&direction| turn * direction)).collect();
            self.directions = Directions { turn: Some(turn), weighted, light: Vec::new() };
            self.environment = None;
        }
    }

    /// Finds the environment's light along the directions.
    fn know(&mut self, base: &DistantLight) {
        if self.environment.as_ref().is_some_and(|known| known.is_same_as(base)) {
            return;
        }
        let weighted = &self.directions.weighted;
        self.directions.light = match base {
            DistantLight::Constant(radiance) => vec![*radiance; weighted.len()],
            DistantLight::Map(map) => {
                let texels: Vec<[f32; 3]> = map.texels().iter().map(|texel| texel.to_array()).collect();
                let vectors = lat_long::project(ENVIRONMENT_BANDS, map.width(), map.height(), &texels);
                let along = |(direction, _): &(DVec3, Vec<f32>)| {
                    vectors.as_ref().map_or(Vec3::ZERO, |vectors| {
                        let at = |vector: &Vec<f64>| basis::reconstruct(vector, direction.to_array()) as f32;
                        Vec3::from(vectors.each_ref().map(at))
                    })
                };
                weighted.iter().map(along).collect()
            }
        };
        self.environment = Some(base.clone());
    }

    /// What is met from a place in world space: direction, object, and where on it.
    fn met_from(&self, frame: &Frame<'_>, place: DVec3, rotation: DQuat) -> Vec<(u32, usize, Crossing)> {
        let world_from_light = rotation.conjugate();
        (self.directions.weighted.iter().enumerate())
            .filter_map(|(number, (direction, _))| {
                let direction = world_from_light * *direction;
                let mut first: Option<(f64, usize, Crossing)> = None;
                for (object, crossings) in &self.others {
                    let pose = &frame.world_from_object[*object];
                    let (turn, scale) = (pose.rotation.as_dquat().normalize().conjugate(), f64::from(pose.scale));
                    let origin = turn * (place - pose.translation.as_dvec3()) / scale;
                    let Some(crossing) = crossings.first(origin, turn * direction) else { continue };
                    let distance = scale * crossing.distance;
                    if first.as_ref().is_none_or(|(nearest, ..)| distance < *nearest) {
                        first = Some((distance, *object, crossing));
                    }
                }
                // A place below the ground sees it from behind: that is nothing to radiate.
                first
                    .filter(|(.., crossing)| !crossing.leaves)
                    .map(|(_, object, crossing)| (number as u32, object, crossing))
            })
            .collect()
    }
}

/// The middle of an object's box in world space, and [`AROUND`] times its half axes; none that is 0.
fn box_of(frame: &Frame<'_>, object: usize) -> Option<(DVec3, [DVec3; 3])> {
    let (low, high) = mesh::bounds(frame.positions(object))?;
    let (low, high) = (low.as_dvec3(), high.as_dvec3());
    let pose = &frame.world_from_object[object];
    let (turn, scale) = (pose.rotation.as_dquat().normalize(), f64::from(pose.scale));
    let half = (0.5 * (high - low)).max(DVec3::splat(1e-3 * (high - low).max_element()));
    let middle = pose.translation.as_dvec3() + turn * (scale * 0.5 * (low + high));
    let axes = [DVec3::X, DVec3::Y, DVec3::Z].map(|axis| turn * (axis * (AROUND * scale * half.dot(axis))));
    (half.min_element() > 0.0 && middle.is_finite()).then_some((middle, axes))
}

/// Position and normal, in world space, of a point of an object at rest.
fn surface_point(frame: &Frame<'_>, object: usize, crossing: &Crossing) -> (Vec3, Vec3) {
    let (mesh, pose) = (&frame.scene.objects[object].mesh, &frame.world_from_object[object]);
    let blend = |list: &[Vec3]| mesh.interpolated(list, crossing.triangle, crossing.weights);
    let normal = blend(&mesh.normals).normalize_or(DVec3::Y).as_vec3();
    (pose.transform_point(blend(&mesh.positions).as_vec3()), pose.transform_direction(normal))
}
