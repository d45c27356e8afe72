//! Spheres in light space: where the levels of every object's hierarchy are in a frame.

use crate::{
    sh_exp::{
        bake::hierarchy::{Hierarchies, Level},
        kernel::{Blocker, OwnSpheres},
    },
    shared::{light_space::LightSpace, placed_spheres},
};
use glam::{DMat3, DQuat, DVec3};
use halfshade_scene::{Frame, Object, Pose, Sphere};
use halfshade_sh::kernel::MAX_BANDS;
use halfshade_strategy::StrategyError;
use std::sync::Arc;

/// All spheres of a frame.
pub(crate) struct PlacedSpheres {
    /// Objects with spheres.
    pub(crate) objects: Vec<PlacedObject>,
    /// How each sphere of every level has turned within its object since rest, in the order of the emitters.
    pub(crate) turns: Vec<DQuat>,
    /// Numbers of the spheres of every object of the scene, of all levels.
    pub(crate) own: Vec<OwnSpheres>,
    pub(crate) space: LightSpace,
    /// A space that turns with the blockers, that of the first object with spheres, from light space: samples in fixed
    /// directions there don't change when light and scene are turned, however the light's turn is described.
    pub(crate) blockers_from_light: DMat3,
}

/// The spheres of one object in light space, level by level.
pub(crate) struct PlacedObject {
    pub(crate) levels: Arc<[Level]>,
    pub(crate) spheres: Vec<Vec<(DVec3, f64)>>,
    /// Number of the first sphere of each level among all emitters.
    pub(crate) first: Vec<u32>,
}

impl PlacedSpheres {
    pub(crate) fn new(frame: &Frame<'_>, hierarchies: &mut Hierarchies) -> Result<Self, StrategyError> {
        let mut objects = Vec::new();
        let mut first = 0;
        let mut turns = Vec::new();
        let mut own = vec![OwnSpheres::default(); frame.scene.objects.len()];
        for (number, (object, pose)) in frame.scene.objects.iter().zip(&frame.world_from_object).enumerate() {
            if object.sphere_count == 0 {
                continue;
            }
            let levels = hierarchies.of(object).ok_or_else(|| {
                StrategyError::Failed(format!("object `{}` blocks but its sphere set is not built", object.name))
            })?;
            let mut place = |level: &Level| -> Vec<(DVec3, f64)> {
                let followed = level.followed(&object.mesh, frame.deformed(number));
                turns.extend(followed.iter().map(|followed| followed.rotation));
                followed.iter().map(|followed| placed(&followed.sphere, pose)).collect()
            };
            let spheres: Vec<Vec<(DVec3, f64)>> = levels.iter().map(&mut place).collect();
            let firsts = spheres.iter().map(|level| {
                first += level.len() as u32;
                first - level.len() as u32
            });
            let firsts: Vec<u32> = firsts.collect();
            let count = spheres.iter().map(|level| level.len() as u32).sum();
            own[number] = OwnSpheres { first: firsts[0], count };
            objects.push(PlacedObject { first: firsts, levels, spheres });
        }
        let leaves = objects.iter().flat_map(|object| &object.spheres[0]);
        let space = LightSpace::new(frame, leaves.map(|(center, _)| *center));
        let blocks = |(object, pose): (&Object, &Pose)| (object.sphere_count > 0).then_some(*pose);
        let first = frame.scene.objects.iter().zip(&frame.world_from_object).find_map(blocks);
        let blockers_from_light = space.object_from_light(&first.unwrap_or(Pose::IDENTITY));
        for (place, _) in objects.iter_mut().flat_map(|object| &mut object.spheres).flatten() {
            *place = space.place(*place);
        }
        Ok(Self { objects, turns, own, space, blockers_from_light })
    }
}

impl PlacedObject {
    /// All spheres of a level as they are.
    pub(crate) fn level(&self, level: usize) -> impl Iterator<Item = Blocker> {
        (0..self.spheres[level].len()).map(move |i| self.blocker(level, i))
    }

    pub(crate) fn blocker(&self, level: usize, i: usize) -> Blocker {
        let (center, radius) = self.spheres[level][i];
        Blocker {
            center: center.as_vec3().to_array(),
            radius: radius as f32,
            factors: [self.levels[level].shares[i]; MAX_BANDS],
            emitter: self.first[level] + i as u32,
            reflection_factor: 1.0,
        }
    }

    /// The children of a blocker, as they are; itself if it is a leaf.
    pub(crate) fn children_of(&self, blocker: &Blocker) -> Vec<Blocker> {
        let level = self.first.partition_point(|&first| first <= blocker.emitter) - 1;
        let children = &self.levels[level].children[(blocker.emitter - self.first[level]) as usize];
        if children.is_empty() {
            return vec![*blocker];
        }
        children.iter().map(|&child| self.blocker(level - 1, child as usize)).collect()
    }

    /// The leaves below a sphere, as they are; itself if it is one.
    pub(crate) fn leaves_of(&self, level: usize, i: usize) -> Vec<Blocker> {
        let (mut open, mut leaves) = (vec![(level, i)], Vec::new());
        while let Some((level, i)) = open.pop() {
            match self.levels[level].children[i].as_slice() {
                [] => leaves.push(self.blocker(level, i)),
                children => open.extend(children.iter().map(|&child| (level - 1, child as usize))),
            }
        }
        leaves
    }
}

/// A sphere of an object in world space: centre and radius.
pub(crate) fn placed(sphere: &Sphere, pose: &Pose) -> (DVec3, f64) {
    let (center, radius) = placed_spheres::placed(sphere, pose, pose.rotation.as_dquat());
    (center, f64::from(radius))
}
