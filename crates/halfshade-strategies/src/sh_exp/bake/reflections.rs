//! Diffuse reflections from the same spheres that block [Guerrero2007, 4.3]: their colours and sample points, once per scene.

use super::{
    geodesic::Geodesic,
    hierarchy::{Hierarchies, Level},
    surface::{self, Covered, SphereSurface},
};
use crate::sh_exp::settings::{Average, GroundMode, Intersections, Order, Settings, Walk};
use halfshade_scene::{Frame, Object, Scene, Sphere};
use halfshade_sh::{
    blocker_table::BlockerTable, form_factor::FormFactorTable, kernel::BatchExponential, mean_normal::MeanNormalTable,
    zonal,
};
use std::sync::Arc;

/// Everything about reflections that holds for all frames.
#[derive(Debug)]
pub(crate) struct ReflectionTables {
    pub(crate) bounces: usize,
    pub(crate) bands: usize,
    /// Coefficients of a radiance vector that are not 0.
    pub(crate) radiance_coefficients: usize,
    /// Channels that surfaces reflect differently: 1 if no object that is seen has a colour, else 3.
    pub(crate) surface_channels: usize,
    pub(crate) exponential: BatchExponential,
    /// Log blockers.
    pub(crate) table: Arc<BlockerTable>,
    pub(crate) form: FormFactorTable,
    /// Where on a sphere its average is taken, if it knows the receiver.
    pub(crate) mean_normal: Option<MeanNormalTable>,
    /// Clamped cosine over π by band, times the rotation's factor: ρ_n.
    pub(crate) cosine: Vec<f32>,
    pub(crate) walk: Walk,
    pub(crate) order: Order,
    pub(crate) intersections: Intersections,
    /// Per emitter: the spheres of all objects, level by level.
    pub(crate) surfaces: Vec<Arc<SphereSurface>>,
    /// The object of each emitter.
    pub(crate) owners: Vec<u32>,
    /// The spheres of the same object and level that each one intersects.
    pub(crate) neighbours: Vec<Vec<u32>>,
}

impl ReflectionTables {
    /// For `scene` with `bounces` bounces, at least 1.
    pub(crate) fn new(
        scene: &Scene,
        settings: &Settings,
        bounces: usize,
        exponential: BatchExponential,
        table: Arc<BlockerTable>,
        hierarchies: &mut Hierarchies,
    ) -> Self {
        let bands = exponential.bands();
        let covered = match settings.intersections {
            Intersections::Precomputed => Covered::Black,
            Intersections::Ordered => Covered::Kept,
        };
        // Objects without spheres colour the light of those that have some, if they are seen.
        let ground_is_seen = settings.ground == GroundMode::Seen;
        let colourless =
            scene.objects.iter().all(|object| object.sphere_count == 0 && !ground_is_seen || object.is_grey());
        let surface_channels = if colourless { 1 } else { 3 };
        let geodesic = Geodesic::new(bands, settings.sample_divisions);
        let (mut surfaces, mut owners, mut neighbours) = (Vec::new(), Vec::new(), Vec::new());
        let mut known: Vec<(&Object, Vec<Arc<SphereSurface>>)> = Vec::new();
        for (number, object) in scene.objects.iter().enumerate() {
            let Some(levels) = hierarchies.of(object) else { continue };
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
        Self {
            bounces,
            bands,
            radiance_coefficients: match settings.radiance_bands {
                0 => bands * bands,
                radiance_bands => radiance_bands * radiance_bands,
            },
            surface_channels,
            exponential,
            table,
            form: FormFactorTable::build(settings.form_factor.into()),
            mean_normal: (settings.average == Average::Receiver).then(MeanNormalTable::build),
            cosine: zonal::reflectance(bands).into_iter().map(|value| value as f32).collect(),
            walk: settings.walk,
            order: settings.order,
            intersections: settings.intersections,
            surfaces,
            owners,
            neighbours,
        }
    }

    /// Channels of what spheres radiate under light that is grey or not.
    pub(crate) fn channels(&self, light_is_grey: bool) -> usize {
        if light_is_grey { self.surface_channels } else { 3 }
    }

    /// Whether `frame` is of the scene that this was made for, as far as its objects' spheres tell.
    pub(crate) fn fits(&self, frame: &Frame<'_>, hierarchies: &mut Hierarchies) -> bool {
        let mut owners = Vec::with_capacity(self.owners.len());
        for (number, object) in frame.scene.objects.iter().enumerate() {
            let levels = hierarchies.of(object);
            owners.extend(levels.iter().flat_map(|levels| &**levels).flat_map(|l| &l.spheres).map(|_| number as u32));
        }
        owners == self.owners
    }

    pub(crate) fn bytes(&self) -> usize {
        let surface = |s: &Arc<SphereSurface>| size_of_val(s.samples.as_slice()) + size_of_val(s.weights.as_slice());
        self.surfaces.iter().map(surface).sum::<usize>() + self.form.bytes()
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
