//! Fields and frames as plain arrays, for kernels that run elsewhere than on the processor.

pub use super::{
    bake::basis::Storage,
    kernel::light_order::Containment,
    prepare::frame::{LocalLight, ObjectPlacement},
};
use super::{
    bake::{
        details::distinct,
        field::Field,
        meshes::Source,
        sh::shell::{ShShell, Values},
        shell::Shell,
    },
    prepare::sh::ShFrame,
    settings::{Basis, OwnOcclusion, Settings},
    sh::ShBaked,
};
use glam::{DQuat, DVec3};
use half::slice::HalfFloatSliceExt;
use halfshade_scene::{Frame, Receivers, VertexWeights};
use halfshade_strategy::{Params, StrategyError};
use std::sync::Arc;

/// The settings that decide which kernels there must be.
#[derive(Debug, Clone, Copy)]
pub struct FieldSettings {
    /// Bands of spherical harmonics; `None` for another basis.
    pub bands: Option<usize>,
    /// Whether rays are in the place of fields.
    pub is_traced: bool,
    /// How samples are stored.
    pub storage: Storage,
    /// Whether own occlusion holds the cosine.
    pub own_is_projected: bool,
}

impl FieldSettings {
    /// Those of a strategy with `params`.
    pub fn new(params: &Params) -> Self {
        let settings = Settings::read(params);
        Self {
            bands: (settings.basis == Basis::Sh).then_some(settings.bands),
            is_traced: settings.source() != Source::Fields,
            storage: settings.storage,
            own_is_projected: settings.own == OwnOcclusion::Projected,
        }
    }
}

/// Everything that holds for all frames of a scene.
#[derive(Debug, Clone)]
pub struct SceneArrays<'a> {
    /// Bands of all vectors.
    pub bands: usize,
    /// Clamped cosine over π by band, times `sqrt(4π/(2l+1))` of the rotation to an axis.
    pub cosine: &'a [f32],
    /// Each mesh once.
    pub meshes: Vec<MeshArrays<'a>>,
    /// The mesh of each object.
    pub mesh_of: Vec<usize>,
}

/// Occlusion by one mesh.
#[derive(Debug, Clone)]
pub struct MeshArrays<'a> {
    /// Occlusion around it; `None` if it hides nothing, or is traced.
    pub field: Option<FieldArrays<'a>>,
    /// Occlusion of its own vertices, by vertex and coefficient; where that is projected, the visibility that it leaves times
    /// the cosine over π.
    pub own: &'a [f32],
}

/// A field: shells from the centre outward.
#[derive(Debug, Clone)]
pub struct FieldArrays<'a> {
    /// Radii of the shells, from 0, in radii of the object.
    pub radii: &'a [f32],
    /// By distance from the centre in steps of `step` radii, the next shell outward.
    pub outer: &'a [u8],
    /// Distance of which all radii are multiples.
    pub step: f32,
    /// The shells.
    pub shells: Vec<ShellArrays<'a>>,
}

/// Sample points at one distance, row by row from the +Y pole.
#[derive(Debug, Clone, Copy)]
pub struct ShellArrays<'a> {
    /// Points along longitude, as along latitude: a power of two.
    pub resolution: usize,
    /// Coefficients of one sample after another; each takes as many as there are in `least`.
    pub values: StoredValues<'a>,
    /// Smallest value of each coefficient: `least + step · value` is what was stored.
    pub least: &'a [f32],
    /// Step of each coefficient.
    pub step: &'a [f32],
}

/// Coefficients as they are stored.
#[derive(Debug, Clone, Copy)]
pub enum StoredValues<'a> {
    /// Steps above the smallest value.
    U8(&'a [u8]),
    /// Half precision, as bits.
    F16(&'a [u16]),
    /// Single precision.
    F32(&'a [f32]),
}

/// Data of a frame.
#[derive(Debug, Clone, Copy)]
pub struct FrameArrays<'a> {
    /// Where each object is.
    pub objects: &'a [ObjectPlacement],
    /// Local lights.
    pub lights: &'a [LocalLight],
    /// Per object the others, from near to far.
    pub nearest_first: &'a [Vec<usize>],
    /// Per object the blocks of the SH rotation from its space into light space, band by band, row by row.
    pub rotations: &'a [Vec<f32>],
    /// Distant light, coefficient by coefficient, in light space.
    pub light: &'a [[f32; 3]],
    /// Rotation of light space: `light_from_world · (point - origin)` of a point in world space.
    pub light_from_world: DQuat,
    /// Its origin.
    pub origin: DVec3,
}

impl ShBaked {
    /// Fields of the scene.
    pub fn scene_arrays(&self) -> SceneArrays<'_> {
        let objects = &self.fields.objects;
        let firsts: Vec<_> = distinct(objects).collect();
        let meshes = firsts.iter().map(|object| MeshArrays {
            field: object.occlusion.field.as_ref().map(field_arrays),
            own: &object.occlusion.own,
        });
        let mesh_of = objects
            .iter()
            .filter_map(|object| firsts.iter().position(|first| Arc::ptr_eq(&first.occlusion, &object.occlusion)));
        SceneArrays {
            bands: self.fields.bands,
            cosine: &self.fields.cosine,
            meshes: meshes.collect(),
            mesh_of: mesh_of.collect(),
        }
    }

    /// Places and light of a frame.
    pub fn prepare_frame(&mut self, frame: &Frame<'_>) -> Result<FrameArrays<'_>, StrategyError> {
        let frame = ShFrame::new(&self.fields, frame, self.frame.take())?;
        let ShFrame { data, light, rotations } = self.frame.insert(frame);
        Ok(FrameArrays {
            objects: &data.objects,
            lights: &data.lights,
            nearest_first: &data.nearest_first,
            rotations,
            light: &light.coefficients,
            light_from_world: data.light_from_world,
            origin: data.origin,
        })
    }

    /// The vertices between which each receiver lies, to interpolate own occlusion; `None` where it isn't known.
    pub fn vertices_around(&self, receivers: Receivers<'_>) -> impl Iterator<Item = Option<VertexWeights>> {
        receivers.surface.iter().zip(receivers.object).map(|(place, &object)| {
            let object = self.fields.objects.get(object as usize)?;
            place.weights_in_front(&object.mesh)
        })
    }
}

fn field_arrays(field: &Field<ShShell>) -> FieldArrays<'_> {
    FieldArrays {
        radii: &field.radii,
        outer: &field.outer,
        step: field.layout.step(),
        shells: field.shells.iter().map(shell_arrays).collect(),
    }
}

fn shell_arrays(shell: &ShShell) -> ShellArrays<'_> {
    ShellArrays {
        resolution: shell.resolution(),
        values: match &shell.values {
            Values::U8(values) => StoredValues::U8(values),
            Values::F16(values) => StoredValues::F16(values.reinterpret_cast()),
            Values::F32(values) => StoredValues::F32(values),
        },
        least: &shell.least,
        step: &shell.step,
    }
}
