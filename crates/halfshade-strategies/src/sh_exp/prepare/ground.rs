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
//! sun below the ground still shines on objects. A plane that cuts through an object lies above some of the places and below others:
//! beyond them the affine function changes its sign, and what should take light away adds some (`extreme-enclosing`).

use crate::{
    sh_exp::{
        bake::{crossings::Crossing, directions::weighted, ground::GroundTables},
        kernel::ground::GroundField,
    },
    shared::projected_light::project_base,
};
use glam::{DQuat, DVec3, Vec3};
use halfshade_scene::{
    Frame, Gloss, RadianceBuffer, ReceiverBuffer, ReceiverPoint, SurfacePoint, light::DistantLight, mesh,
};
use halfshade_sh::basis;
use rayon::prelude::*;

/// How far from the middle of an object's box the places around it are, in half extents.
const AROUND: f64 = 0.6;

/// The middle and a place at either end of each axis.
const PLACES: usize = 7;

/// Bands in which the light that the ground takes away is known.
const ENVIRONMENT_BANDS: usize = 6;

/// The view of objects with spheres on the others in the last frame.
#[derive(Debug, Default)]
pub(crate) struct GroundView {
    directions: Directions,
    /// The environment whose light along the directions is known, without its sun.
    environment: Option<DistantLight>,
    /// Points that were met.
    pub(crate) points: ReceiverBuffer,
    /// Object, place and direction from which each point was met.
    met: Vec<[u32; 3]>,
    pub(crate) fields: GroundFields,
}

/// The fields that shading reads, per object; none where it has no spheres, or sees nothing.
#[derive(Debug, Clone, Default)]
pub(crate) struct GroundFields {
    pub(crate) seen: Vec<Option<GroundField>>,
    /// The same of a black ground: the light that it takes away.
    pub(crate) taken: Vec<Option<GroundField>>,
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

impl GroundView {
    /// Looks around all objects with spheres; what is met is black. `center` is the origin of light space.
    pub(crate) fn look(&mut self, tables: &GroundTables, frame: &Frame<'_>, center: DVec3) {
        let rotation = frame.world_from_environment.as_dquat().normalize().conjugate();
        let space = (tables.objects.first())
            .map_or(DQuat::IDENTITY, |(object, _)| frame.world_from_object[*object].rotation.as_dquat().normalize());
        self.turn(tables, rotation * space);
        self.know(&frame.scene.environment.base);
        let scene = frame.scene;
        self.fields.seen = vec![None; scene.objects.len()];
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
                    self.met_from(tables, frame, middle + offset, rotation)
                });
                Some((object, middle, axes, places.collect::<Vec<_>>()))
            })
            .collect();
        self.points.clear();
        self.met.clear();
        for (object, middle, axes, places) in seen {
            for (place, met) in places.into_iter().enumerate() {
                for (direction, other, crossing) in met {
                    self.points.add(&receiver_at(frame, other, &crossing));
                    self.met.push([object as u32, place as u32, direction]);
                }
            }
            let light_from_world = |v: DVec3| (rotation * v).as_vec3().to_array();
            self.fields.seen[object] = Some(GroundField {
                center: light_from_world(middle - center),
                axes: axes.map(|axis| light_from_world(axis / axis.length_squared())),
                coefficients: std::array::from_fn(|_| std::array::from_fn(|_| vec![0.0; tables.bands * tables.bands])),
            });
        }
        let black = RadianceBuffer::zeros(self.points.len());
        self.shine(tables, &black);
        self.fields.taken.clone_from(&self.fields.seen);
    }

    /// Lets the points that were met radiate.
    pub(crate) fn shine(&mut self, tables: &GroundTables, radiance: &RadianceBuffer) {
        let count = tables.bands * tables.bands;
        let mut of_places = vec![[0.0_f32; 3]; self.fields.seen.len() * PLACES * count];
        for (point, &[object, place, direction]) in self.met.iter().enumerate() {
            let instead = radiance.at(point) - self.directions.light[direction as usize];
            let first = (object as usize * PLACES + place as usize) * count;
            for (sum, value) in
                of_places[first..][..count].iter_mut().zip(&self.directions.weighted[direction as usize].1)
            {
                (0..3).for_each(|channel| sum[channel] += instead[channel] * value);
            }
        }
        for (object, field) in self.fields.seen.iter_mut().enumerate() {
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

    pub(crate) fn bytes(&self) -> usize {
        let coefficients = |field: &GroundField| field.coefficients.iter().flatten().map(Vec::len).sum::<usize>();
        let fields = self.fields.seen.iter().chain(&self.fields.taken).flatten();
        fields.map(coefficients).sum::<usize>() * size_of::<f32>() + size_of_val(self.met.as_slice())
    }

    /// Turns the directions into light space.
    fn turn(&mut self, tables: &GroundTables, turn: DQuat) {
        if self.directions.turn != Some(turn) {
            let weighted =
                weighted(tables.bands, tables.directions.iter().map(|&direction| turn * direction)).collect();
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
            DistantLight::Map(_) => {
                let vectors = project_base(ENVIRONMENT_BANDS, base);
                let along = |(direction, _): &(DVec3, Vec<f32>)| {
                    let at = |vector: &Vec<f64>| basis::reconstruct(vector, direction.to_array()) as f32;
                    Vec3::from(vectors.each_ref().map(at))
                };
                weighted.iter().map(along).collect()
            }
        };
        self.environment = Some(base.clone());
    }

    /// Surfaces met from a place in world space: direction, object, and where on it.
    fn met_from(
        &self,
        tables: &GroundTables,
        frame: &Frame<'_>,
        place: DVec3,
        rotation: DQuat,
    ) -> Vec<(u32, usize, Crossing)> {
        let world_from_light = rotation.conjugate();
        (self.directions.weighted.iter().enumerate())
            .filter_map(|(number, (direction, _))| {
                let direction = world_from_light * *direction;
                let mut first: Option<(f64, usize, Crossing)> = None;
                for (object, crossings) in &tables.objects {
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

/// A point of an object at rest, as a receiver in world space.
fn receiver_at(frame: &Frame<'_>, number: usize, crossing: &Crossing) -> ReceiverPoint {
    let (object, pose) = (&frame.scene.objects[number], &frame.world_from_object[number]);
    let &Crossing { triangle, weights, .. } = crossing;
    let blend = |list: &[Vec3]| object.mesh.interpolated(list, triangle, weights);
    let normal = blend(&object.mesh.normals).normalize_or(DVec3::Y).as_vec3();
    let barycentric = weights.as_vec3().to_array();
    ReceiverPoint {
        position: pose.transform_point(blend(&object.mesh.positions).as_vec3()),
        normal: pose.transform_direction(normal),
        albedo: object.albedo_at(triangle, weights),
        gloss: Gloss::NEUTRAL,
        object: number as u32,
        // From behind nothing is met.
        surface: SurfacePoint::Triangle { triangle: triangle as u32, barycentric, from_behind: false },
    }
}
