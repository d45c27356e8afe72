//! Frame data: everything that shading reads of a frame.

use crate::{
    mask::{bake::boxes::SolidBox, kernel::boxes::PlacedBox},
    shared::{
        blockers::{Blockers, BlockingSphere, blocking_spheres},
        divided_light::DividedLight,
        light_space::LightSpace,
        placed_lamps::{Lamp, placed_lamps},
    },
};
use glam::DVec3;
use halfshade_scene::{EyeLobes, Frame, Pose};

/// Spheres, boxes and lamps of a frame.
#[derive(Debug, Default)]
pub(crate) struct FrameData {
    pub(crate) space: LightSpace,
    pub(crate) spheres: Vec<BlockingSphere>,
    pub(crate) boxes: Vec<PlacedBox>,
    pub(crate) lamps: Vec<Lamp>,
    /// Where anything is glossy.
    pub(crate) eye_lobes: Option<EyeLobes>,
    /// Rows of the rotation into the space of each object.
    pub(crate) object_from_light: Vec<[[f32; 3]; 3]>,
}

impl FrameData {
    /// A frame of a scene with these blockers; `boxes` has an entry per object.
    pub(crate) fn new(
        frame: &Frame<'_>,
        blockers: &Blockers,
        boxes: &[Option<SolidBox>],
        light: &DividedLight,
    ) -> Self {
        let by_object: Vec<Vec<(DVec3, f32)>> = blockers.placed_by_object(frame).collect();
        let places = by_object.iter().flatten().map(|(center, _)| *center);
        let solid = || boxes.iter().zip(&frame.world_from_object).enumerate();
        let grounds = solid().filter(|(_, (solid, _))| solid.is_some());
        let space = LightSpace::new(frame, places.chain(grounds.map(|(_, (_, pose))| pose.translation.as_dvec3())));
        let boxes = solid().filter_map(|(object, (solid, pose))| {
            let solid = (*solid)?;
            Some(placed_box(&solid, pose, &space, object as u32))
        });
        Self {
            spheres: blocking_spheres(&by_object, &space),
            boxes: boxes.collect(),
            lamps: placed_lamps(frame, light.suns(&frame.scene.environment), |point| space.point(point)),
            eye_lobes: EyeLobes::new(frame),
            object_from_light: frame.world_from_object.iter().map(|pose| space.rows_into_object(pose)).collect(),
            space,
        }
    }

    pub(crate) fn bytes(&self) -> usize {
        size_of_val(self.spheres.as_slice()) + size_of_val(self.boxes.as_slice()) + size_of_val(self.lamps.as_slice())
    }
}

fn placed_box(solid: &SolidBox, pose: &Pose, space: &LightSpace, object: u32) -> PlacedBox {
    let center = pose.rotation.as_dquat().normalize() * (f64::from(pose.scale) * solid.center.as_dvec3());
    PlacedBox {
        center: space.point(center + pose.translation.as_dvec3()).to_array(),
        half: (pose.scale * solid.half).to_array(),
        rotation: space.rows_into_object(pose),
        object,
    }
}
