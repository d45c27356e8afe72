//! Rotations of bodies that move.

use crate::{
    prt::{bake::volume::Volume, kernel::volume::BANDS},
    shared::rotate::blocks,
};
use glam::{DMat3, DQuat};
use halfshade_scene::{Frame, Pose};
use halfshade_sh::rotation::ShRotation;

/// By object, the rotation from its own space into the world as it was when transfer was baked; none where none is asked for.
pub(crate) fn of(frame: &Frame<'_>, volume: &Volume, baked_from_world: &Pose) -> Vec<Vec<f32>> {
    let world: DQuat = baked_from_world.rotation.as_dquat().normalize();
    let turn = |(own, pose): (&Option<_>, &Pose)| {
        let rotation = DMat3::from_quat(world * pose.rotation.as_dquat().normalize());
        // Rows of the rotation are the columns of its transpose.
        own.as_ref().map_or(Vec::new(), |_| blocks(&ShRotation::new(BANDS, &rotation.transpose().to_cols_array_2d())))
    };
    volume.own.iter().zip(&frame.world_from_object).map(turn).collect()
}
