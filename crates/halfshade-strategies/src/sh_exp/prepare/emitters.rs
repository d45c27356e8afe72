//! First pass: light at the sample points becomes a radiance vector on every sphere [Guerrero2007, 4.3.2].
//!
//! Sample points and the matrices W_j are kept in the object's space, so that an object may turn, move and change its size.
//! In an object that deforms the points move with their triangles, and W_j turns with the sphere: colours keep their places
//! on it as far as its part of the surface moves as one. The thesis turns the form factor into that space at every receiver (figure 4.17), because rotating an SH
//! vector was expensive; here the few radiance vectors are turned into the space of the light instead, once per frame,
//! which is the same sum and leaves receivers with one set of basis values per sphere.

use crate::sh_exp::{bake::reflections::ReflectionTables, kernel::gather::RadianceVectors};
use glam::{DMat3, DQuat, Vec3};
use halfshade_scene::{Frame, Gloss, RadianceBuffer, ReceiverBuffer, ReceiverPoint, SurfacePoint};
use halfshade_sh::rotation::ShRotation;
use rayon::prelude::*;

/// Where light is gathered for the spheres.
#[derive(Debug, Clone, Default)]
pub(crate) struct SamplePoints {
    /// White receivers in world space.
    pub(crate) receivers: ReceiverBuffer,
    /// The emitter that each belongs to.
    pub(crate) emitters: Vec<u32>,
}

/// `r = Σ_j M_j W_j` of every sphere in `channels` channels, turned into light space. `light` is the radiance of white
/// receivers at the sample points of all spheres, in the order of [`place`]; `turns` is how each sphere has turned within its
/// object.
pub(crate) fn radiate(
    tables: &ReflectionTables,
    frame: &Frame<'_>,
    channels: usize,
    light: &RadianceBuffer,
    turns: &[DQuat],
    into: &mut RadianceVectors,
) {
    let ReflectionTables { bands, surface_channels, radiance_coefficients: used, surfaces, owners, .. } = tables;
    let (bands, surface_channels, used) = (*bands, *surface_channels, *used);
    let count = bands * bands;
    into.stride = channels * count;
    let into_light = IntoLight::new(bands, frame);
    let of_objects = into_light.of_objects();
    let mut first = 0;
    let starts: Vec<usize> = surfaces
        .iter()
        .map(|surface| {
            first += surface.samples.len();
            first - surface.samples.len()
        })
        .collect();
    into.vectors.resize(surfaces.len() * into.stride, 0.0);
    into.shines.resize(surfaces.len(), false);
    let spheres = into.vectors.par_chunks_mut(into.stride).zip(&mut into.shines).enumerate();
    spheres.for_each(|(number, (vectors, shines))| {
        let mut sums = vec![0.0; channels * count];
        for (sample, weights) in surfaces[number].weights.chunks_exact(surface_channels * count).enumerate() {
            let radiance = light.at(starts[number] + sample).to_array();
            let of_channels = weights.chunks_exact(count).cycle();
            for (channel, (sum, weights)) in sums.chunks_exact_mut(count).zip(of_channels).enumerate() {
                let radiance = f64::from(radiance[channel]);
                sum.iter_mut().zip(weights).for_each(|(sum, &w)| *sum += radiance * f64::from(w));
            }
        }
        *shines = sums.iter().any(|&value| value != 0.0);
        let (object, turn) = (owners[number] as usize, turns[number]);
        let own = (turn != DQuat::IDENTITY).then(|| into_light.rotation(object, turn));
        let rotation = own.as_ref().unwrap_or(&of_objects[object]);
        for (vector, sum) in vectors.chunks_exact_mut(count).zip(sums.chunks_exact(count)) {
            vector.iter_mut().zip(rotation.apply(sum)).take(used).for_each(|(value, turned)| *value = turned as f32);
        }
    });
}

/// Rotations of SH vectors from objects into light space.
pub(crate) struct IntoLight<'a> {
    bands: usize,
    frame: &'a Frame<'a>,
    light_from_world: DQuat,
}

impl<'a> IntoLight<'a> {
    pub(crate) fn new(bands: usize, frame: &'a Frame<'a>) -> Self {
        Self { bands, frame, light_from_world: frame.world_from_environment.as_dquat().normalize().conjugate() }
    }

    /// For what has turned by `turn` within its object.
    pub(crate) fn rotation(&self, object: usize, turn: DQuat) -> ShRotation {
        let world_from_object = self.frame.world_from_object[object].rotation.as_dquat().normalize();
        let rows = DMat3::from_quat(self.light_from_world * world_from_object * turn).transpose();
        ShRotation::new(self.bands, &rows.to_cols_array_2d())
    }

    /// For what stays as it is within its object, object by object.
    pub(crate) fn of_objects(&self) -> Vec<ShRotation> {
        (0..self.frame.world_from_object.len()).map(|object| self.rotation(object, DQuat::IDENTITY)).collect()
    }
}

/// The sample points of all spheres in world space, as white receivers, and the sphere of each.
pub(crate) fn place(tables: &ReflectionTables, frame: &Frame<'_>, points: &mut SamplePoints) {
    let SamplePoints { receivers: points, emitters: emitter_of_point } = points;
    points.clear();
    emitter_of_point.clear();
    for (emitter, (surface, &object)) in tables.surfaces.iter().zip(&tables.owners).enumerate() {
        let owner = object as usize;
        let (pose, mesh) = (&frame.world_from_object[owner], &frame.scene.objects[owner].mesh);
        let (positions, normals) = (frame.positions(owner), frame.normals(owner));
        emitter_of_point.extend(surface.samples.iter().map(|_| emitter as u32));
        for &(number, weights) in &surface.samples {
            let triangle = number as usize;
            let blend = |list: &[Vec3]| mesh.interpolated(list, triangle, weights.as_dvec3()).as_vec3();
            let normal = blend(normals).normalize_or(normals[mesh.triangles[triangle][0] as usize]);
            points.add(&ReceiverPoint {
                position: pose.transform_point(blend(positions)),
                normal: pose.transform_direction(normal),
                albedo: Vec3::ONE,
                gloss: Gloss::NEUTRAL,
                object,
                surface: SurfacePoint::Triangle {
                    triangle: number,
                    barycentric: weights.to_array(),
                    from_behind: false,
                },
            });
        }
    }
}
