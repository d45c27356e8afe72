//! Diffuse reflections from the same spheres that block [Guerrero2007, 4.3].
//!
//! Every sphere knows the colours and some points of the surface near it ([`surface`]). Each frame, the light at these
//! points becomes a radiance vector on the sphere, as seen from any direction ([`emitters`], the first pass). A receiver
//! sees of every sphere an average radiance and a visible part; the products add up ([`gather`], the second pass).
//!
//! The first pass may take in what the last one found: b bounces are b rounds of it, as chapter 7 proposes.

mod emitters;
mod gather;
mod geodesic;
mod surface;

use super::{
    levels::{Hierarchies, Level},
    settings::{GroundMode, Intersections, Order, Settings, Walk},
};
use emitters::{Emitters, Shape};
use glam::DQuat;
use halfshade_scene::{Frame, Object, RadianceBuffer, ReceiverBuffer, Scene, Sphere, light::is_grey};
use halfshade_sh::{blocker_table::BlockerTable, form_factor::FormFactorTable, kernel::BatchExponential, zonal};
use std::sync::Arc;
use surface::{Covered, SphereSurface};

pub(super) use gather::Gather;

/// Everything about reflections: what is baked, and what the spheres of this frame radiate.
#[derive(Debug)]
pub(super) struct Reflections {
    pub(super) bounces: usize,
    bands: usize,
    /// Coefficients of a radiance vector that are not 0.
    radiance_coefficients: usize,
    /// Of what surfaces reflect: 1 if no object that is seen has a colour, else 3.
    surface_channels: usize,
    /// Of what spheres radiate in this frame: 1 if the light has no colour either.
    channels: usize,
    exponential: BatchExponential,
    /// Log blockers.
    table: Arc<BlockerTable>,
    form: FormFactorTable,
    /// Clamped cosine over π by band, times the rotation's factor: ρ_n.
    cosine: Vec<f32>,
    walk: Walk,
    order: Order,
    intersections: Intersections,
    /// Per emitter: the spheres of all objects, level by level.
    surfaces: Vec<Arc<SphereSurface>>,
    /// The object of each emitter.
    owners: Vec<u32>,
    /// The spheres of the same object and level that each one intersects.
    neighbours: Vec<Vec<u32>>,
    pub(super) points: SamplePoints,
    emitters: Emitters,
}

/// Where light is gathered for the spheres.
#[derive(Debug, Clone, Default)]
pub(super) struct SamplePoints {
    /// White receivers in world space.
    pub(super) receivers: ReceiverBuffer,
    /// The emitter that each belongs to.
    pub(super) emitters: Vec<u32>,
}

impl Reflections {
    /// For `scene` with `bounces` bounces, at least 1.
    pub(super) fn new(
        scene: &Scene,
        settings: &Settings,
        bounces: usize,
        exponential: BatchExponential,
        table: Arc<BlockerTable>,
        levels: &mut Hierarchies,
    ) -> Self {
        let bands = exponential.bands();
        let covered = match settings.intersections {
            Intersections::Precomputed => Covered::Black,
            Intersections::Ordered => Covered::Kept,
        };
        // What has no spheres colours the light of those that have, if they see it.
        let ground_is_seen = settings.ground == GroundMode::Seen;
        let colourless = scene.objects.iter().all(|object| {
            let textured = object.material.texture.is_some() || !object.mesh.textures.is_empty();
            let grey_surface =
                is_grey(object.material.albedo) && object.mesh.colors.iter().all(|&color| is_grey(color));
            object.sphere_count == 0 && !ground_is_seen || grey_surface && !textured
        });
        let surface_channels = if colourless { 1 } else { 3 };
        let geodesic = geodesic::Geodesic::new(bands, settings.sample_divisions);
        let (mut surfaces, mut owners, mut neighbours) = (Vec::new(), Vec::new(), Vec::new());
        let mut known: Vec<(&Object, Vec<Arc<SphereSurface>>)> = Vec::new();
        for (number, object) in scene.objects.iter().enumerate() {
            let Some(levels) = levels.of(object) else { continue };
            for spheres in levels.iter().map(|level| &level.spheres) {
                let first = owners.len() as u32;
                owners.extend(spheres.iter().map(|_| number as u32));
                neighbours.extend((0..spheres.len()).map(|i| intersecting(spheres, i, first)));
            }
            if let Some((_, same)) = known.iter().find(|(other, _)| look_alike(other, object)) {
                surfaces.extend(same.iter().cloned());
                continue;
            }
            let choices = (settings.projection, covered);
            let of_level =
                |level: &Level| surface::surfaces(object, &level.spheres, bands, surface_channels, &geodesic, choices);
            let own: Vec<_> = levels.iter().flat_map(of_level).map(Arc::new).collect();
            surfaces.extend(own.iter().cloned());
            known.push((object, own));
        }
        let cosine = zonal::reflectance(bands).into_iter().map(|value| value as f32).collect();
        Self {
            bounces,
            bands,
            radiance_coefficients: match settings.radiance_bands {
                0 => bands * bands,
                radiance_bands => radiance_bands * radiance_bands,
            },
            surface_channels,
            channels: surface_channels,
            exponential,
            table,
            form: FormFactorTable::build(settings.form_factor.into()),
            cosine,
            walk: settings.walk,
            order: settings.order,
            intersections: settings.intersections,
            surfaces,
            owners,
            neighbours,
            points: SamplePoints::default(),
            emitters: Emitters::default(),
        }
    }

    /// Puts the sample points where they are in `frame`; nothing shines yet.
    pub(super) fn begin(&mut self, frame: &Frame<'_>, light_is_grey: bool) {
        self.channels = if light_is_grey { self.surface_channels } else { 3 };
        let SamplePoints { receivers, emitters } = &mut self.points;
        emitters::place(&self.surfaces, &self.owners, frame, receivers, emitters);
        self.emitters = Emitters::default();
    }

    /// Lets the spheres, turned by `turns` within their objects, shine by the `light` at their sample points.
    pub(super) fn shine(&mut self, frame: &Frame<'_>, light: &RadianceBuffer, turns: &[DQuat]) {
        let shape = Shape {
            bands: self.bands,
            channels: self.channels,
            surface_channels: self.surface_channels,
            used: self.radiance_coefficients,
        };
        self.emitters.set(&self.surfaces, &self.owners, frame, &shape, light, turns);
    }

    /// Whether any sphere shines.
    pub(super) fn is_dark(&self) -> bool {
        self.emitters.is_dark()
    }

    /// How many spheres there are in all levels.
    pub(super) fn emitter_count(&self) -> usize {
        self.surfaces.len()
    }

    /// Whether `frame` is of the scene that this was made for, as far as its objects' spheres tell.
    pub(super) fn fits(&self, frame: &Frame<'_>, levels: &mut Hierarchies) -> bool {
        let mut owners = Vec::with_capacity(self.owners.len());
        for (number, object) in frame.scene.objects.iter().enumerate() {
            let levels = levels.of(object);
            owners.extend(levels.iter().flat_map(|levels| &**levels).flat_map(|l| &l.spheres).map(|_| number as u32));
        }
        owners == self.owners
    }

    pub(super) fn bytes(&self) -> usize {
        let surface = |s: &Arc<SphereSurface>| size_of_val(s.samples.as_slice()) + size_of_val(s.weights.as_slice());
        self.surfaces.iter().map(surface).sum::<usize>() + self.emitters.bytes() + self.form.bytes()
    }

    /// The spheres that don't cover `sphere`, though they may be nearer.
    fn skipped(&self, sphere: u32) -> &[u32] {
        match self.intersections {
            Intersections::Precomputed => &self.neighbours[sphere as usize],
            Intersections::Ordered => &[],
        }
    }
}

/// Whether two objects share surface and spheres, as copies do.
fn look_alike(a: &Object, b: &Object) -> bool {
    let same_spheres = a.spheres.as_ref().zip(b.spheres.as_ref()).is_some_and(|(a, b)| Arc::ptr_eq(a, b));
    Arc::ptr_eq(&a.mesh, &b.mesh) && same_spheres && a.material == b.material
}

/// The spheres that intersect sphere `i`, counted from `first`.
fn intersecting(spheres: &[Sphere], i: usize, first: u32) -> Vec<u32> {
    let touches = |&j: &usize| {
        let reach = spheres[i].radius + spheres[j].radius;
        j != i && spheres[i].center.distance_squared(spheres[j].center) < reach * reach
    };
    (0..spheres.len()).filter(touches).map(|j| first + j as u32).collect()
}
