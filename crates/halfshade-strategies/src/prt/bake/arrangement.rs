//! How objects stand to each other: transfer is baked for one arrangement, which may move and turn as a whole. Objects that move against
//! it are refused, or left out.

use crate::prt::settings::Moving;
use glam::{DMat3, DQuat, DVec3};
use halfshade_scene::{Object, Pose, Scene};
use halfshade_strategy::StrategyError;
use std::{borrow::Cow, sync::Arc};

/// Rounding of poses, as a part of the numbers that they are made of: a few steps of single precision.
const ROUNDING: f64 = 32.0 * f32::EPSILON as f64;

/// Poses of all objects, at the frame that was baked.
#[derive(Debug)]
pub(crate) struct Arrangement {
    poses: Vec<Pose>,
    /// Whether each object moves against the rest, or deforms.
    moves: Vec<bool>,
    /// The object against which others move: one that stands still, if any does.
    base: usize,
}

impl Arrangement {
    /// The arrangement of a scene that keeps it at every frame, but for objects that may be left out.
    ///
    /// # Errors
    /// Why transfer can't be baked for the scene.
    pub(crate) fn of(scene: &Scene, moving: Moving) -> Result<Self, StrategyError> {
        let deforms = |object: &Object| object.skin.as_ref().is_some_and(|skin| skin.moves());
        let moves: Vec<bool> = scene.objects.iter().map(deforms).collect();
        if let Some(number) = moves.iter().position(|deforms| *deforms && moving == Moving::Refuse) {
            let what = format!("`{}` deforms", scene.objects[number].name);
            return Err(refused(
                &what,
                "sh-exp, mask and ray-traced follow that, and so does moving=volume, in a volume of light",
            ));
        }
        let stays = |number: &usize| !moves[*number];
        let stands = |number: &usize| stays(number) && !scene.objects[*number].motion.moves();
        let mut all = 0..scene.objects.len();
        let Some(base) = all.clone().find(stands).or_else(|| all.find(stays)).or(moves.is_empty().then_some(0)) else {
            return Err(refused("all of them deform", "sh-exp, mask and ray-traced follow that"));
        };
        let poses = |index: usize| -> Vec<Pose> {
            let time_secs = index as f64 / scene.frames_per_sec;
            scene.objects.iter().map(|object| object.motion.at(time_secs)).collect()
        };
        let mut arrangement = Self { poses: poses(0), moves, base };
        if scene.objects.iter().any(|object| object.motion.moves()) {
            for index in 1..scene.frame_count {
                match moving {
                    Moving::Refuse => arrangement.check(&poses(index), &scene.objects, index)?,
                    Moving::Volume => arrangement.leave_out(&poses(index)),
                }
            }
        }
        Ok(arrangement)
    }

    /// Leaves out whoever doesn't stand as before.
    fn leave_out(&mut self, poses: &[Pose]) {
        let moved: Vec<usize> = self.moved(poses).collect();
        moved.into_iter().for_each(|number| self.moves[number] = true);
    }

    /// Whether an object is left out.
    pub(crate) fn moves(&self, number: usize) -> bool {
        self.moves.get(number).is_some_and(|moves| *moves)
    }

    /// The same by object.
    pub(crate) fn movers(&self) -> &[bool] {
        &self.moves
    }

    /// Whether any is.
    pub(crate) fn has_movers(&self) -> bool {
        self.moves.contains(&true)
    }

    /// The scene without what moves: no triangles are left of that.
    pub(crate) fn at_rest<'a>(&self, scene: &'a Scene) -> Cow<'a, Scene> {
        let mut rest = Cow::Borrowed(scene);
        for number in (0..scene.objects.len()).filter(|&number| self.moves[number]) {
            let object = &mut rest.to_mut().objects[number];
            (object.mesh, object.skin) = (Arc::default(), None);
        }
        rest
    }

    /// Whether objects stand to each other as they did, at the frame with this number.
    ///
    /// # Errors
    /// The first object that doesn't.
    pub(crate) fn check(&self, poses: &[Pose], objects: &[Object], index: usize) -> Result<(), StrategyError> {
        if poses.len() != self.poses.len() {
            return Err(StrategyError::Failed("the frame is of another scene than was baked".into()));
        }
        match self.moved(poses).next() {
            None => Ok(()),
            Some(moved) => {
                let name = |number: usize| objects.get(number).map_or("?", |object| object.name.as_str());
                let what = format!("`{}` moves against `{}` by frame {index}", name(moved), name(self.base));
                let who = "sh-exp, shadow-field, mask and ray-traced follow that, and so does moving=volume, in a volume of light";
                Err(refused(&what, who))
            }
        }
    }

    /// Objects that don't stand to the base as they did, and aren't left out.
    fn moved(&self, poses: &[Pose]) -> impl Iterator<Item = usize> {
        let bases = self.poses.get(self.base).copied().zip(poses.get(self.base).copied());
        let pairs = self.poses.iter().zip(poses).enumerate();
        pairs.filter_map(move |(number, (then, now))| {
            let (base, base_now) = bases?;
            let is_still = self.moves[number] || is_same(&Relative::new(&base, then), &Relative::new(&base_now, now));
            (!is_still).then_some(number)
        })
    }

    /// The rotation from the world at a frame into the world as it was when transfer was baked.
    pub(crate) fn baked_from_world(&self, poses: &[Pose]) -> DMat3 {
        let turn = |pose: Option<&Pose>| pose.map_or(DQuat::IDENTITY, |pose| pose.rotation.as_dquat().normalize());
        DMat3::from_quat(turn(self.poses.get(self.base)) * turn(poses.get(self.base)).conjugate())
    }

    /// The same with scale and place.
    pub(crate) fn pose_from_world(&self, poses: &[Pose]) -> Pose {
        match (self.poses.get(self.base), poses.get(self.base)) {
            (Some(then), Some(now)) if then != now => now.inverse().then(then),
            _ => Pose::IDENTITY,
        }
    }
}

fn refused(what: &str, who: &str) -> StrategyError {
    StrategyError::Unsupported(format!(
        "transfer is baked for one arrangement of all objects, but {what}; {who}, or hold the scene still at one frame"
    ))
}

/// A pose in the space of another one.
struct Relative {
    scale: f64,
    rotation: DQuat,
    translation: DVec3,
    /// The largest of the numbers that the translation is made of.
    magnitude: f64,
}

impl Relative {
    fn new(first: &Pose, other: &Pose) -> Self {
        let inverse = first.rotation.as_dquat().normalize().conjugate();
        let scale = f64::from(first.scale).recip();
        let offset = other.translation.as_dvec3() - first.translation.as_dvec3();
        let largest = other.translation.abs().max_element().max(first.translation.abs().max_element());
        Self {
            scale: scale * f64::from(other.scale),
            rotation: inverse * other.rotation.as_dquat().normalize(),
            translation: scale * (inverse * offset),
            magnitude: scale * f64::from(largest),
        }
    }
}

fn is_same(a: &Relative, b: &Relative) -> bool {
    // Twice the sine of half the angle between both.
    let turn = 2.0 * (a.rotation.conjugate() * b.rotation).xyz().length();
    let offset = (a.translation - b.translation).abs().max_element();
    (a.scale - b.scale).abs() <= ROUNDING * a.scale.max(b.scale)
        && turn <= ROUNDING
        && offset <= ROUNDING * a.magnitude.max(b.magnitude)
}

#[cfg(test)]
mod tests {
    use super::*;
    use glam::{Quat, Vec3};
    use halfshade_scene::{Environment, Motion, builtin::shapes};

    fn scene(motions: [Motion; 2]) -> Scene {
        let objects = motions.into_iter().enumerate();
        let objects = objects.map(|(i, motion)| Object::new(format!("o{i}"), shapes::plane(1)).motion(motion));
        let mut scene = Scene::at_rest("two", objects.collect(), Environment::constant(Vec3::ONE));
        scene.frame_count = 31;
        scene
    }

    fn at(x: f32) -> Pose {
        Pose { scale: 0.3, rotation: Quat::from_rotation_x(0.4), translation: Vec3::new(x, 3.0, -7.0) }
    }

    #[test]
    fn a_scene_may_move_as_a_whole() {
        let outer =
            |turn| Pose { scale: 2.5, rotation: Quat::from_rotation_z(turn), translation: Vec3::new(9.0, turn, 1.0) };
        let scene = scene([Motion::Still(at(1.0)), Motion::Still(at(5.0))]);
        let arrangement = Arrangement::of(&scene, Moving::Refuse).unwrap();
        for turn in [0.0, 0.3, 2.0, 6.0] {
            let moved = [at(1.0), at(5.0)].map(|pose| pose.then(&outer(turn)));
            arrangement.check(&moved, &scene.objects, 3).unwrap();
            let expected = DMat3::from_quat(outer(turn).rotation.as_dquat().normalize().conjugate());
            let found = arrangement.baked_from_world(&moved);
            assert!(found.abs_diff_eq(expected, 1e-6), "{found} {expected}");
        }
        let same = [at(1.0), Pose { translation: Vec3::new(5.000_1, 3.0, -7.0), ..at(5.0) }];
        assert!(arrangement.check(&same, &scene.objects, 3).is_err());
    }

    #[test]
    fn who_moves_is_named() {
        let keys = Motion::Keyframes(vec![(0.5, at(1.0)), (1.0, at(2.0))]);
        let error =
            Arrangement::of(&scene([Motion::Still(at(0.0)), keys.clone()]), Moving::Refuse).unwrap_err().to_string();
        assert!(error.contains("`o1` moves against `o0` by frame 16") && error.contains("shadow-field"), "{error}");
        let together = Motion::Keyframes(vec![(0.5, at(4.0)), (1.0, at(5.0))]);
        assert!(Arrangement::of(&scene([keys.clone(), together]), Moving::Refuse).is_ok());
        // Whoever stands still is what others move against, whatever the order.
        let scene = scene([keys, Motion::Still(at(0.0))]);
        let arrangement = Arrangement::of(&scene, Moving::Volume).unwrap();
        assert!(
            arrangement.moves(0)
                && !arrangement.moves(1)
                && arrangement.at_rest(&scene).objects[0].mesh.positions.is_empty()
        );
        let error = Arrangement::of(&scene, Moving::Refuse).unwrap_err().to_string();
        assert!(error.contains("`o0` moves against `o1`"), "{error}");
    }
}
