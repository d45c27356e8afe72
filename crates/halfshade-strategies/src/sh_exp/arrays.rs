//! A frame as plain arrays, for kernels that run elsewhere than on the processor.

pub use super::kernel::{
    blocker::{Blocker, OwnSpheres},
    lamps::POINTS as LAMP_POINTS,
    light::{BaseByNormal, DistantLightByNormal},
    sun::SunLight,
};
use super::{
    BakedScene,
    bake::{Visibility, own::OwnTables, reflections::ReflectionTables},
    prepare::{self, cuts::CutOf, emitters, frame::FrameData},
    settings::{Intersections, Order, Ratios, Walk},
};
pub use super::{kernel::ground::GroundField, prepare::FirstPass};
pub use crate::shared::placed_lamps::{Lamp, LampPlace};
use glam::{DMat3, DQuat, DVec3};
use halfshade_scene::{
    Frame, ReceiverBuffer, Receivers, SurfacePoint, VertexWeights, light::OctahedralGrid, spheres::AdjustRule,
};
use halfshade_sh::{
    blocker_table::BlockerTable, form_factor::FormFactorTable, kernel::BatchExponential, mean_normal::MeanNormalTable,
    rotation::ShRotation,
};
use halfshade_strategy::StrategyError;

/// Tables that hold for all frames of a scene.
#[derive(Debug, Clone, Copy)]
pub struct SceneArrays<'a> {
    /// Bands of visibility.
    pub bands: usize,
    /// Treatment of spheres that cut the tangent plane.
    pub rule: AdjustRule,
    /// Whether direct light is held between 0 and unshadowed.
    pub clamp: bool,
    /// Zonal vectors of blockers by angular radius: logarithms, or blockers less one.
    pub blockers: &'a BlockerTable,
    /// How blockers combine.
    pub combination: CombinationArrays<'a>,
    /// How spheres radiate, if they do.
    pub reflections: Option<ReflectionArrays<'a>>,
    /// Clamped cosine over π by band, times the rotation's factor, if objects without spheres are seen.
    pub ground_cosine: Option<&'a [f32]>,
    /// Own occlusion, if meshes tell.
    pub own: Option<OwnArrays<'a>>,
}

/// Own occlusion of all objects.
#[derive(Debug, Clone, Copy)]
pub struct OwnArrays<'a>(&'a OwnTables);

impl<'a> OwnArrays<'a> {
    /// Per vertex of an object the SH vector of what is blocked, in object space; empty if nothing is, `None` if its spheres
    /// stand for it. Objects of one mesh share their vectors.
    pub fn vectors(&self, object: usize) -> Option<&'a [f32]> {
        self.0.of(object).map(|own| own.values.as_slice())
    }

    /// Per vertex a bit per node of [`Self::grid`], 1 where the mesh hides a small light there; empty if it hides none. `None` as
    /// above.
    pub fn hidden(&self, object: usize) -> Option<&'a [u32]> {
        self.0.of(object).map(|own| own.hidden.as_slice())
    }

    /// Nodes of directions in object space.
    pub fn grid(&self) -> OctahedralGrid {
        self.0.grid
    }

    /// The vertices between which a receiver lies; `None` where it asks the spheres.
    pub fn vertices_around(&self, object: usize, point: SurfacePoint) -> Option<VertexWeights> {
        point.weights_in_front(&self.0.of(object)?.mesh)
    }
}

/// Tables of reflections that hold for all frames.
#[derive(Debug, Clone, Copy)]
pub struct ReflectionArrays<'a> {
    tables: &'a ReflectionTables,
    /// Bounces of light, at least 1.
    pub bounces: usize,
    /// Log blockers.
    pub logs: &'a BlockerTable,
    /// Their exponential.
    pub exponential: &'a BatchExponential,
    /// Averages over what is seen of a sphere.
    pub form: &'a FormFactorTable,
    /// Where they are taken, if they know the receiver.
    pub mean_normal: Option<&'a MeanNormalTable>,
    /// Clamped cosine over π by band, times the rotation's factor.
    pub cosine: &'a [f32],
    /// Whether spheres are ordered by power distance, not by that of their centres.
    pub by_power: bool,
    /// Whether intersecting spheres of an object don't cover each other.
    pub is_precomputed: bool,
    /// Whether sums over nearer spheres are found one by one.
    pub is_quadratic: bool,
    /// Channels of the weights of [`Self::surfaces`]: 1 or 3.
    pub surface_channels: usize,
    /// Coefficients of a radiance vector that are not 0.
    pub radiance_coefficients: usize,
    /// The object of each emitter.
    pub owners: &'a [u32],
    /// The emitters of the same object and level that each one intersects.
    pub neighbours: &'a [Vec<u32>],
}

impl<'a> ReflectionArrays<'a> {
    /// Per emitter its number of sample points, and W_j of each and channel.
    pub fn surfaces(&self) -> impl ExactSizeIterator<Item = (usize, &'a [f32])> {
        self.tables.surfaces.iter().map(|surface| (surface.samples.len(), surface.weights.as_slice()))
    }

    /// The sample points of all emitters as white receivers, and the emitter of each.
    pub fn sample_points(&self, frame: &Frame<'_>) -> (ReceiverBuffer, Vec<u32>) {
        let mut points = Default::default();
        emitters::place(self.tables, frame, &mut points);
        (points.receivers, points.emitters)
    }

    /// Rotations of radiance vectors into light space: each at least once, and the number of that of each emitter.
    pub fn rotations(&self, frame: &Frame<'_>, turns: &[DQuat]) -> (Vec<ShRotation>, Vec<u32>) {
        let into_light = emitters::IntoLight::new(self.tables.bands, frame);
        let mut rotations = into_light.of_objects();
        let mut number = |(&object, &turn): (&u32, &DQuat)| {
            if turn == DQuat::IDENTITY {
                return object;
            }
            rotations.push(into_light.rotation(object as usize, turn));
            rotations.len() as u32 - 1
        };
        let numbers = self.owners.iter().zip(turns).map(&mut number).collect();
        (rotations, numbers)
    }
}

/// How blockers become visibility.
#[derive(Debug, Clone, Copy)]
pub enum CombinationArrays<'a> {
    /// Logarithms are summed, and this is their exponential.
    Exponential(&'a BatchExponential),
    /// One product after another.
    Product,
    /// Each by the share of it that no other hides.
    Shares {
        /// Points per sphere that find it.
        points: usize,
    },
    /// Traced.
    Traced,
}

/// Data of the frame that was prepared last.
#[derive(Debug, Clone, Copy)]
pub struct FrameArrays<'a> {
    /// Light that is multiplied with visibility, in light space.
    pub light: &'a DistantLightByNormal,
    /// Lights that are handled apart, in light space.
    pub lamps: &'a [Lamp],
    /// How often the light has changed since the scene was baked.
    pub light_changes: u32,
    /// Rotation of light space: `rotation · (point - center)` of a point in world space.
    pub rotation: DMat3,
    /// Its origin.
    pub center: DVec3,
    /// A space that turns with the blockers, from light space.
    pub blockers_from_light: DMat3,
    /// How each emitter has turned within its object since rest.
    pub turns: &'a [DQuat],
    /// Channels of what spheres radiate: 1 or 3, or 0 if they don't.
    pub radiance_channels: usize,
    /// Per emitter and channel what it radiates, after a [`FirstPass::Here`]; channels follow each other.
    pub radiance: &'a [f32],
    /// Objects without spheres as each object sees them, and the same if they were black; empty if they aren't seen.
    pub ground: [&'a [Option<GroundField>]; 2],
    /// Per object the blocks of the SH rotation from its space into light space, band by band, row by row; empty if spheres
    /// hide objects from themselves.
    pub own_rotations: &'a [Vec<f32>],
    /// Per object its spheres; as above.
    pub own_spheres: &'a [OwnSpheres],
}

impl BakedScene {
    /// Makes `frame` the frame of [`Self::frame_arrays`]; a `first_pass` elsewhere leaves it without radiance.
    pub fn prepare_frame(&mut self, frame: &Frame<'_>, first_pass: FirstPass) -> Result<(), StrategyError> {
        prepare::prepare(&mut self.tables, &mut self.data, frame, first_pass)
    }

    /// Tables of the scene.
    pub fn scene_arrays(&self) -> SceneArrays<'_> {
        let tables = &self.tables;
        SceneArrays {
            bands: tables.bands,
            rule: tables.rule,
            clamp: tables.clamp,
            blockers: &tables.blockers,
            combination: match &tables.visibility {
                Visibility::Exponential(exponential) => CombinationArrays::Exponential(exponential),
                Visibility::Product => CombinationArrays::Product,
                &Visibility::Shares { points } => CombinationArrays::Shares { points },
                Visibility::Traced { .. } => CombinationArrays::Traced,
            },
            reflections: tables.reflections.as_ref().map(|tables| ReflectionArrays {
                tables,
                bounces: tables.bounces,
                logs: &tables.table,
                exponential: &tables.exponential,
                form: &tables.form,
                mean_normal: tables.mean_normal.as_ref(),
                cosine: &tables.cosine,
                by_power: tables.order == Order::Power,
                is_precomputed: tables.intersections == Intersections::Precomputed,
                is_quadratic: tables.walk == Walk::Quadratic,
                surface_channels: tables.surface_channels,
                radiance_coefficients: tables.radiance_coefficients,
                owners: &tables.owners,
                neighbours: &tables.neighbours,
            }),
            ground_cosine: tables.ground.as_ref().map(|ground| ground.cosine.as_slice()),
            own: tables.own.as_ref().map(OwnArrays),
        }
    }

    /// Where the first pass may run: scaled reflections and objects without spheres need its results on the processor.
    pub fn first_pass(&self) -> FirstPass {
        let is_needed_here = self.tables.cut.ratios == Ratios::On || self.tables.ground.is_some();
        if is_needed_here { FirstPass::Here } else { FirstPass::Elsewhere }
    }

    /// Light and space of the frame.
    pub fn frame_arrays(&self) -> FrameArrays<'_> {
        let FrameData { space, light, lamps, ground, own, .. } = &self.data;
        let reflections = self.tables.reflections.as_ref();
        let fields = ground.as_ref().map(|ground| &ground.fields);
        FrameArrays {
            light: &light.by_normal,
            lamps,
            light_changes: light.changes,
            rotation: space.rotation,
            center: space.origin,
            blockers_from_light: self.data.blockers_from_light,
            turns: &self.data.turns,
            radiance_channels: reflections.map_or(0, |tables| tables.channels(self.data.is_grey())),
            radiance: &self.data.radiance.vectors,
            ground: fields.map_or([&[], &[]], |fields| [&fields.seen, &fields.taken]),
            own_rotations: &own.rotations,
            own_spheres: &own.spheres,
        }
    }

    /// The blockers of each cut, in light space.
    pub fn cuts(&self) -> impl Iterator<Item = &[Blocker]> {
        self.data.cuts.all()
    }

    /// The cut of each emitter's sample points; `None` if they all share the first. Stays the same from frame to frame.
    pub fn cut_of_emitters(&self, emitters: &[u32]) -> Option<Vec<u32>> {
        let cuts = &self.data.cuts;
        cuts.is_by_cluster().then(|| emitters.iter().map(|&emitter| cuts.of_emitter(emitter)).collect())
    }

    /// The cut of each receiver; `None` if they all share the first. Stays the same from frame to frame.
    pub fn cut_of(&self, receivers: Receivers<'_>) -> Option<Vec<u32>> {
        self.data.cuts.of(receivers, &self.data.space, CutOf::Cluster)
    }
}
