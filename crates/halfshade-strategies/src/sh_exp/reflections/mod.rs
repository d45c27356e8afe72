//! Diffuse reflections from the same spheres that block [Guerrero2007, 4.3].
//!
//! Every sphere knows the colours and some points of the surface near it ([`surface`]). Each frame, the light at these
//! points becomes a radiance vector on the sphere, as seen from any direction ([`emitters`], the first pass). A receiver
//! sees of every sphere an average radiance and a visible part; the products add up ([`gather`], the second pass).
//!
//! The first pass may take in what the last one found: b bounces are b rounds of it, as chapter 7 proposes.

mod crossings;
mod emitters;
mod gather;
mod geodesic;
mod surface;

use emitters::Emitters;
use halfshade_scene::{Frame, RadianceBuffer, ReceiverBuffer, Scene, Sphere};
use halfshade_sh::{
    blocker_table::BlockerTable,
    form_factor::{FormFactorTable, Weighting},
    kernel::BatchExponential,
    zonal,
};
use halfshade_strategy::{Effect, Effects, Params};
use std::{f64::consts::PI, sync::Arc};
use surface::{Covered, Projection, SphereSurface};

pub(super) use gather::Gather;
use gather::{Intersections, Order, Walk};

/// Everything about reflections: what is baked, and what the spheres of this frame radiate.
#[derive(Debug)]
pub(super) struct Reflections {
    pub(super) bounces: usize,
    bands: usize,
    /// 1 if neither light nor surfaces have colours, else 3.
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
    /// Per sphere, in the order of the blockers.
    surfaces: Vec<SphereSurface>,
    /// The object of each sphere.
    owners: Vec<u32>,
    /// The spheres of the same object that each one intersects.
    neighbours: Vec<Vec<u32>>,
    pub(super) points: ReceiverBuffer,
    emitters: Emitters,
}

impl Reflections {
    /// For `scene` with `bounces` bounces, at least 1.
    pub(super) fn new(
        scene: &Scene,
        params: &Params,
        bounces: usize,
        exponential: BatchExponential,
        table: Arc<BlockerTable>,
    ) -> Self {
        let bands = exponential.bands();
        let intersections = match params.choice("intersections") {
            "ordered" => Intersections::Ordered,
            _ => Intersections::Precomputed,
        };
        let covered = match intersections {
            Intersections::Precomputed => Covered::Black,
            Intersections::Ordered => Covered::Kept,
        };
        let projection =
            if params.choice("projection") == "product" { Projection::Product } else { Projection::Direct };
        let grey = |c: glam::Vec3| c.x == c.y && c.y == c.z;
        let colourless = scene.objects.iter().all(|object| {
            object.sphere_count == 0
                || grey(object.material.albedo) && object.mesh.colors.iter().all(|&color| grey(color))
        });
        let coloured_light = Effects::required_by(scene).contains(Effect::ColouredLight);
        let channels = if colourless && !coloured_light { 1 } else { 3 };
        let geodesic = geodesic::Geodesic::new(bands, params.integer("sample-divisions") as usize);
        let (mut surfaces, mut owners, mut neighbours) = (Vec::new(), Vec::new(), Vec::new());
        for (number, object) in scene.objects.iter().enumerate() {
            let Some(set) = object.spheres.as_ref().filter(|_| object.sphere_count > 0) else { continue };
            let first = owners.len() as u32;
            owners.extend(set.spheres.iter().map(|_| number as u32));
            neighbours.extend((0..set.spheres.len()).map(|i| intersecting(&set.spheres, i, first)));
            surfaces.extend(surface::surfaces(object, &set.spheres, bands, channels, &geodesic, (projection, covered)));
        }
        let cosine = (zonal::clamped_cosine(bands).iter().enumerate())
            .map(|(l, a)| (a / PI * zonal::rotation_scale(l)) as f32)
            .collect();
        Self {
            bounces,
            bands,
            channels,
            exponential,
            table,
            form: FormFactorTable::build(match params.choice("form-factor") {
                "cosine" => Weighting::Cosine,
                _ => Weighting::SolidAngle,
            }),
            cosine,
            walk: if params.choice("walk") == "quadratic" { Walk::Quadratic } else { Walk::Linear },
            order: if params.choice("order") == "center" { Order::Center } else { Order::Power },
            intersections,
            surfaces,
            owners,
            neighbours,
            points: ReceiverBuffer::default(),
            emitters: Emitters::default(),
        }
    }

    /// Puts the sample points where they are in `frame`; nothing shines yet.
    pub(super) fn begin(&mut self, frame: &Frame<'_>) {
        emitters::place(&self.surfaces, &self.owners, frame, &mut self.points);
        self.emitters = Emitters::default();
    }

    /// Lets the spheres shine by the `light` at their sample points.
    pub(super) fn shine(&mut self, frame: &Frame<'_>, light: &RadianceBuffer) {
        self.emitters.set(&self.surfaces, &self.owners, frame, (self.bands, self.channels), light);
    }

    /// Whether any sphere shines.
    pub(super) fn is_dark(&self) -> bool {
        self.emitters.is_dark()
    }

    pub(super) fn bytes(&self) -> usize {
        let surface = |s: &SphereSurface| size_of_val(s.samples.as_slice()) + size_of_val(s.weights.as_slice());
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

/// The spheres that intersect sphere `i`, counted from `first`.
fn intersecting(spheres: &[Sphere], i: usize, first: u32) -> Vec<u32> {
    let touches = |&j: &usize| {
        let reach = spheres[i].radius + spheres[j].radius;
        j != i && spheres[i].center.distance_squared(spheres[j].center) < reach * reach
    };
    (0..spheres.len()).filter(touches).map(|j| first + j as u32).collect()
}
