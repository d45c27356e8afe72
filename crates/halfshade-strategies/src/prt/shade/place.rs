//! Where a receiver is in the table of transfer.

use crate::prt::{
    bake::{
        rows::{Back, ObjectRows},
        table::Transfer,
    },
    kernel::dot::Between,
};
use halfshade_scene::{Mesh, Receivers, SurfacePoint};
use halfshade_sh::kernel::LANES;
use std::sync::Arc;

/// Transfer of a receiver.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Place {
    /// Between three rows of the table, with weights of sum 1.
    Between([(usize, f32); 3]),
    /// No light arrives.
    Dark,
    /// Nothing is known: as if nothing hid any light.
    Open,
}

impl Place {
    /// That of receiver `i`.
    pub(crate) fn of(transfer: &Transfer, receivers: &Receivers<'_>, i: usize) -> Self {
        let place = |object: &(Arc<Mesh>, ObjectRows)| Self::on(object, receivers.surface[i]);
        transfer.objects.get(receivers.object[i] as usize).map_or(Self::Open, place)
    }

    /// That of a point on an object.
    pub(crate) fn on((mesh, rows): &(Arc<Mesh>, ObjectRows), surface: SurfacePoint) -> Self {
        let Some(weights) = surface.weights(mesh) else { return Self::Open };
        let first = match rows.back {
            _ if !surface.is_from_behind() => rows.first,
            Back::Rows(back) => back,
            Back::Dark => return Self::Dark,
            Back::Open => return Self::Open,
        };
        let mut between: Between = [(0, 0.0); 3];
        between.iter_mut().zip(weights.parts()).for_each(|(place, (vertex, weight))| *place = (first + vertex, weight));
        Self::Between(between)
    }
}

/// The row of receiver `start`, if the next seven are vertices that follow it.
pub(crate) fn first_of_eight(transfer: &Transfer, receivers: &Receivers<'_>, start: usize) -> Option<usize> {
    let objects: &[u32; LANES] = receivers.object[start..].first_chunk()?;
    let surface: &[SurfacePoint; LANES] = receivers.surface[start..].first_chunk()?;
    let SurfacePoint::Vertex(first) = surface[0] else { return None };
    // Without branches: what isn't a vertex is one past any.
    let vertex = |lane: usize| if let SurfacePoint::Vertex(vertex) = surface[lane] { vertex } else { u32::MAX };
    let off = |lane: usize| (vertex(lane) ^ first.wrapping_add(lane as u32)) | (objects[lane] ^ objects[0]);
    let is_run = (0..LANES).fold(0, |all, lane| all | off(lane)) == 0;
    let (mesh, rows) = transfer.objects.get(objects[0] as usize).filter(|_| is_run)?;
    (first as usize + LANES <= mesh.positions.len()).then_some(rows.first + first as usize)
}
