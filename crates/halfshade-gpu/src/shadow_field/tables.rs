//! Tables that stay on the device from frame to frame, in rows of four numbers: fields, own occlusion, vertices around receivers,
//! reflectances.

use crate::{
    reflectance::{TERM_ROWS, terms},
    rows::{Row, filled},
};
use bytemuck::NoUninit;
use halfshade_scene::{Scene, VertexWeights};
use halfshade_strategies::shadow_field::arrays::{FieldArrays, SceneArrays, StoredValues};

/// Number of a field where there is none.
const NO_FIELD: u32 = u32::MAX;

/// Rows of `tables` in `shadow_field/frame.wgsl`, and what begins where.
#[derive(Debug)]
pub(super) struct Tables {
    pub(super) rows: Vec<Row>,
    /// Per object.
    pub(super) objects: Vec<ObjectTables>,
    /// The row at which receivers begin.
    pub(super) receivers: usize,
    pub(super) cosine: [f32; 8],
}

/// Rows at which the tables of an object begin.
#[derive(Debug, Clone, Copy)]
pub(super) struct ObjectTables {
    pub(super) field: u32,
    own: u32,
    /// Rows of its own occlusion's vectors.
    own_rows: u32,
    pub(super) terms: u32,
    pub(super) term_count: u32,
}

impl Tables {
    /// Tables of a scene, and the samples of all its fields.
    pub(super) fn new(arrays: &SceneArrays<'_>, scene: &Scene) -> (Self, Vec<Row>) {
        let (mut rows, mut samples) = (Vec::new(), Vec::new());
        let count = arrays.bands * arrays.bands;
        let of_mesh: Vec<[u32; 2]> = (arrays.meshes.iter())
            .map(|mesh| {
                let field =
                    mesh.field.as_ref().map_or(NO_FIELD, |field| add_field(&mut rows, &mut samples, field, count));
                let own = rows.len() as u32;
                add_values(&mut rows, mesh.own, [count, count]);
                [field, own]
            })
            .collect();
        let objects = (arrays.mesh_of.iter().zip(&scene.objects))
            .map(|(&mesh, object)| {
                let terms = terms(&object.material.reflectance);
                let [field, own] = of_mesh[mesh];
                let first = rows.len() as u32;
                rows.extend(&terms);
                let term_count = (terms.len() / TERM_ROWS) as u32;
                ObjectTables { field, own, own_rows: count.div_ceil(4) as u32, terms: first, term_count }
            })
            .collect();
        (Self { receivers: rows.len(), rows, objects, cosine: filled(arrays.cosine) }, samples)
    }

    /// Takes these receivers in the place of any others: the object of each and the vertices around it become those of its
    /// own occlusion, and their weights.
    pub(super) fn place_receivers(&mut self, receivers: impl Iterator<Item = (usize, Option<VertexWeights>)>) {
        let Self { rows, objects, receivers: first, .. } = self;
        rows.truncate(*first);
        for (object, around) in receivers {
            let (mut vertices, mut weights) = ([0; 4], [0.0; 4]);
            if let Some((around, own)) = around.zip(objects.get(object)) {
                vertices[3] = 1;
                for (k, (vertex, weight)) in around.parts().enumerate() {
                    vertices[k] = own.own + own.own_rows * vertex as u32;
                    weights[k] = weight;
                }
            }
            rows.extend([vertices, weights.map(f32::to_bits)]);
        }
    }
}

/// Adds a field as `shadow_field/shell_grid.wgsl` reads it; gives the row at which it begins.
fn add_field(rows: &mut Vec<Row>, samples: &mut Vec<Row>, field: &FieldArrays<'_>, count: usize) -> u32 {
    let first = rows.len();
    let shells = first + 2;
    rows.resize(shells + field.shells.len(), [0; 4]);
    for (number, (shell, &radius)) in field.shells.iter().zip(field.radii).enumerate() {
        let (first_sample, scales) = (samples.len(), rows.len());
        let stride = shell.least.len();
        match shell.values {
            StoredValues::U8(values) => {
                add_values(samples, values, [stride, count]);
                let scale = |k: usize| {
                    [shell.least, shell.step]
                        .map(|values| filled(values.get(k..).unwrap_or_default()).map(f32::to_bits))
                };
                rows.extend((0..count).step_by(4).flat_map(scale));
            }
            StoredValues::F16(values) => add_values(samples, values, [stride, count]),
            StoredValues::F32(values) => add_values(samples, values, [stride, count]),
        }
        rows[shells + number] = [shell.resolution as u32, first_sample as u32, scales as u32, radius.to_bits()];
    }
    let outermost = field.radii.last().copied().unwrap_or(0.0);
    rows[first] = [shells as u32, rows.len() as u32, field.outer.len().saturating_sub(1) as u32, 0];
    rows[first + 1] = [field.step.recip().to_bits(), outermost.to_bits(), 0, 0];
    add_values(rows, field.outer, [field.outer.len().max(1); 2]);
    first as u32
}

/// Adds the first `count` of every `stride` values in as few bits as they have, each time in rows of their own.
fn add_values<T: NoUninit>(rows: &mut Vec<Row>, values: &[T], [stride, count]: [usize; 2]) {
    for vector in values.chunks_exact(stride) {
        rows.extend(bytemuck::cast_slice::<T, u8>(&vector[..count]).chunks(16).map(packed));
    }
}

/// Up to 16 bytes as four numbers.
fn packed(bytes: &[u8]) -> Row {
    let byte = |i: usize| bytes.get(i).copied().unwrap_or(0);
    std::array::from_fn(|word| u32::from_le_bytes(std::array::from_fn(|k| byte(4 * word + k))))
}
