//! Visibility past a receiver's own object and past each other one, in light space.

use super::batch::Batch;
use crate::shadow_field::{
    kernel::reconstruct::{MOST, transposed},
    prepare::sh::ShPrepared,
    settings::OwnOcclusion,
};
use crate::shared::{
    rotate::{rotated, visible},
    vertex_vectors::interpolated,
};
use glam::Vec3;
use halfshade_sh::kernel::{LANES, ShBatch};
use wide::f32x8;

/// Own occlusion of eight receivers.
pub(crate) enum Own<const N: usize> {
    /// The visibility that it leaves.
    Visible(ShBatch<N>),
    /// Visibility times the cosine over π; and where that is known.
    Transfer(ShBatch<N>, f32x8),
}

/// Own occlusion, interpolated between the vertices that the receivers lie between.
pub(crate) fn own<const N: usize>(prepared: &ShPrepared<'_>, batch: &Batch<'_>) -> Own<N> {
    let object = &prepared.fields.objects[batch.object];
    let surface = |lane| batch.receivers.surface[batch.number(lane)];
    let (vector, known) = interpolated(&object.mesh, &object.occlusion.own, surface);
    let vector = rotated(&vector, &prepared.frame.rotations[batch.object]);
    match prepared.fields.own_kind {
        OwnOcclusion::Product => Own::Visible(visible(&vector)),
        OwnOcclusion::Projected => Own::Transfer(vector, known),
    }
}

/// The visibility that another object leaves at eight places; `None` if it hides nothing.
#[inline(never)]
pub(crate) fn visibility<const N: usize>(
    prepared: &ShPrepared<'_>,
    object: usize,
    position: &[f32x8; 3],
) -> Option<ShBatch<N>> {
    let mut blocked = [[0.0; MOST]; LANES];
    let placement = &prepared.frame.data.objects[object];
    let occlusion = &prepared.fields.objects[object].occlusion;
    if let Some(field) = &occlusion.field {
        field.add_at(placement.on_shells(position), &mut blocked);
    } else {
        let traced = occlusion.traced.as_ref()?;
        let points = placement.in_object(position).map(f32x8::to_array);
        for (k, blocked) in blocked.iter_mut().enumerate() {
            let vector = traced.blocked_from(&prepared.fields.basis, Vec3::from(points.map(|axis| axis[k])));
            blocked[..N].copy_from_slice(&vector);
        }
    }
    Some(visible(&rotated(&transposed(&blocked), &prepared.frame.rotations[object])))
}
