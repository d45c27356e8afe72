//! Deforming meshes: linear blend skinning by a skeleton.
//!
//! Every joint carries its surroundings along, from where they are at rest to where the joint takes them; a vertex goes
//! to the weighted mean of where its joints would take it:
//!
//! ```text
//! p(t) = Σ_j w_j M_j(t) p        M_j(t) = object_from_joint_j(t) · joint_j_from_object(at rest)        Σ_j w_j = 1
//! ```
//!
//! Normals are turned by the cofactors of the blended matrix, which keep them upright to the deformed surface as far as
//! the weights are locally constant: the usual approximation.

use crate::morph::morphed;
use crate::{Deformed, Mesh, MorphTarget, Motion, Pose};
use glam::{Affine3A, Mat3A, Vec3, Vec3A};

/// Most joints that move one vertex.
pub const INFLUENCES: usize = 4;

/// A joint of a skeleton.
#[derive(Debug, Clone, PartialEq)]
pub struct Joint {
    /// The joint that this one hangs on, of a lower number; without one its motion is in the object's space.
    pub parent: Option<usize>,
    /// `parent_from_joint` over time.
    pub motion: Motion,
    /// Joint space from the object's space, at rest.
    pub joint_from_rest: Affine3A,
}

/// A skeleton and how it moves the vertices of a mesh, after morph targets have moved them.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct Skin {
    /// Parents before their children.
    pub joints: Vec<Joint>,
    /// Joints that move each vertex, and their weights, which are not negative and add up to 1.
    pub influences: Vec<[(u16, f32); INFLUENCES]>,
    /// Morph targets, if there are any.
    pub morphs: Vec<MorphTarget>,
    /// Triangles whose corners, which are no other triangle's, have its own normal also when it deforms.
    pub flat_triangles: Vec<u32>,
}

impl Skin {
    /// Whether any joint ever moves, or the weight of any morph target.
    pub fn moves(&self) -> bool {
        self.joints.iter().any(|joint| joint.motion.moves()) || self.morphs.iter().any(MorphTarget::moves)
    }

    /// The time of the last keyframe of any joint or morph target; 0 without one.
    pub fn last_key_secs(&self) -> f64 {
        let of_joints = self.joints.iter().filter_map(|joint| joint.motion.last_key_secs());
        of_joints.chain(self.morphs.iter().filter_map(MorphTarget::last_key_secs)).fold(0.0, f64::max)
    }

    /// A bound on how far from the object's origin any vertex of `mesh` ever comes.
    ///
    /// It adds up, along the chain of joints, the longest translations and the largest scales, as if all happened at once
    /// and in one direction: far too much for long chains, but in time that grows only with the number of keys. It is
    /// infinite where an f32 along the way might be.
    pub fn reach(&self, mesh: &Mesh) -> f64 {
        let at_rest = mesh.positions.iter().map(|p| p.as_dvec3().length()).fold(0.0, f64::max);
        let farthest = at_rest + self.morphs.iter().map(MorphTarget::reach).sum::<f64>();
        // By joint: how far its origin comes and how much it scales, at most.
        let mut bounds: Vec<(f64, f64)> = Vec::with_capacity(self.joints.len());
        let mut reach = 0.0_f64;
        for joint in &self.joints {
            let most = |of: fn(&Pose) -> f64| match &joint.motion {
                Motion::Still(pose) => of(pose),
                Motion::Keyframes(keys) => keys.iter().map(|(_, pose)| of(pose)).fold(0.0, f64::max),
            };
            let (moved, scaled) = (most(|p| p.translation.as_dvec3().length()), most(|p| p.scale.into()));
            let (far, scale) = joint.parent.and_then(|parent| bounds.get(parent)).copied().unwrap_or((0.0, 1.0));
            let (far, scale) = (far + scale * moved, scale * scaled);
            bounds.push((far, scale));
            let rest = joint.joint_from_rest;
            let stretch: f64 = [rest.x_axis, rest.y_axis, rest.z_axis].iter().map(|a| f64::from(a.length())).sum();
            let bound = far + scale * (rest.translation.as_dvec3().length() + stretch * farthest);
            let is_sound = far.max(scale) < f64::from(f32::MAX) && !bound.is_nan();
            reach = reach.max(if is_sound { bound } else { f64::INFINITY });
        }
        reach
    }

    /// `mesh`, of as many vertices as there are influences, at `time_secs`.
    pub fn deform(&self, mesh: &Mesh, time_secs: f64) -> Deformed {
        let mut object_from_joint: Vec<Affine3A> = Vec::with_capacity(self.joints.len());
        for joint in &self.joints {
            let pose = joint.motion.at(time_secs);
            let local =
                Affine3A::from_scale_rotation_translation(Vec3::splat(pose.scale), pose.rotation, pose.translation);
            let parent = joint.parent.and_then(|parent| object_from_joint.get(parent));
            object_from_joint.push(parent.map_or(local, |parent| *parent * local));
        }
        let moved: Vec<Affine3A> =
            object_from_joint.iter().zip(&self.joints).map(|(pose, joint)| *pose * joint.joint_from_rest).collect();
        let mut deformed = Deformed::default();
        let morphed = (!self.morphs.is_empty()).then(|| morphed(&self.morphs, mesh, time_secs));
        let (positions, normals) = match &morphed {
            Some(Deformed { positions, normals }) => (positions, normals),
            None => (&mesh.positions, &mesh.normals),
        };
        for ((position, normal), influences) in positions.iter().zip(normals).zip(&self.influences) {
            let (mut matrix, mut translation) = (Mat3A::ZERO, Vec3A::ZERO);
            for &(joint, weight) in influences.iter().filter(|(_, weight)| *weight > 0.0) {
                matrix += moved[joint as usize].matrix3 * weight;
                translation += moved[joint as usize].translation * weight;
            }
            deformed.positions.push((matrix * Vec3A::from(*position) + translation).into());
            let [x, y, z] = [matrix.x_axis, matrix.y_axis, matrix.z_axis];
            let turned = Mat3A::from_cols(y.cross(z), z.cross(x), x.cross(y)) * Vec3A::from(*normal);
            deformed.normals.push(Vec3::from(turned).normalize_or(*normal));
        }
        for &triangle in &self.flat_triangles {
            let corners = mesh.triangles[triangle as usize].map(|vertex| vertex as usize);
            let [a, b, c] = corners.map(|vertex| deformed.positions[vertex].as_dvec3());
            // A triangle without area keeps the normal that it had.
            if let Some(normal) = (b - a).cross(c - a).try_normalize() {
                corners.into_iter().for_each(|vertex| deformed.normals[vertex] = normal.as_vec3());
            }
        }
        deformed
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::builtin::shapes;
    use glam::Quat;

    /// Two joints on the y axis, the upper one bent about x at y = 0, weights by height.
    fn bent_column(angle: f32) -> (Mesh, Skin) {
        let mut mesh = shapes::sphere(8);
        mesh.positions.iter_mut().for_each(|p| *p *= Vec3::new(0.3, 1.0, 0.3));
        let still = |pose| Joint { parent: None, motion: Motion::Still(pose), joint_from_rest: Affine3A::IDENTITY };
        let bent = Pose { rotation: Quat::from_rotation_x(angle), ..Pose::IDENTITY };
        let influences = (mesh.positions.iter())
            .map(|p| {
                let upper = (0.5 + 2.0 * p.y).clamp(0.0, 1.0);
                [(0, 1.0 - upper), (1, upper), (0, 0.0), (0, 0.0)]
            })
            .collect();
        (mesh, Skin { joints: vec![still(Pose::IDENTITY), still(bent)], influences, ..Skin::default() })
    }

    #[test]
    fn at_rest_nothing_moves() {
        let (mesh, skin) = bent_column(0.0);
        let deformed = skin.deform(&mesh, 0.0);
        for (vertex, position) in deformed.positions.iter().enumerate() {
            assert!(position.distance(mesh.positions[vertex]) < 1e-6);
            assert!(deformed.normals[vertex].distance(mesh.normals[vertex]) < 1e-5);
        }
        assert!(!skin.moves());
    }

    #[test]
    fn ends_move_rigidly_and_the_bend_lies_between() {
        let angle = 0.8;
        let (mesh, skin) = bent_column(angle);
        let deformed = skin.deform(&mesh, 0.0);
        let turn = Quat::from_rotation_x(angle);
        let mut between = 0;
        for (vertex, (position, normal)) in mesh.positions.iter().zip(&mesh.normals).enumerate() {
            let (moved, turned) = (deformed.positions[vertex], deformed.normals[vertex]);
            if position.y > 0.25 {
                assert!(moved.distance(turn * *position) < 1e-6 && turned.distance(turn * *normal) < 1e-5);
            } else if position.y < -0.25 {
                assert!(moved.distance(*position) < 1e-6 && turned.distance(*normal) < 1e-5);
            } else {
                let halfway = 0.5 * (*position + turn * *position);
                between += usize::from(moved.distance(halfway) < 0.5 * position.distance(turn * *position) + 1e-6);
            }
        }
        assert!(between > 20);
    }

    #[test]
    fn children_follow_their_parents() {
        let (mesh, mut skin) = bent_column(0.0);
        let lift = Pose::from_translation(Vec3::Y);
        skin.joints[0].motion = Motion::Keyframes(vec![(0.0, Pose::IDENTITY), (1.0, lift)]);
        skin.joints[1].parent = Some(0);
        let deformed = skin.deform(&mesh, 1.0);
        assert!(skin.moves());
        for (moved, position) in deformed.positions.iter().zip(&mesh.positions) {
            assert!(moved.distance(*position + Vec3::Y) < 1e-6);
        }
        assert_eq!(skin.last_key_secs(), 1.0);
    }

    #[test]
    fn vertices_stay_within_reach() {
        let (mesh, mut skin) = bent_column(0.8);
        let large = Pose { scale: 3.0, ..Pose::from_translation(2.0 * Vec3::Y) };
        skin.joints[0].motion = Motion::Keyframes(vec![(0.0, Pose::IDENTITY), (1.0, large)]);
        skin.joints[1].parent = Some(0);
        let reach = skin.reach(&mesh);
        assert!(reach > 5.0 && reach < 12.0, "{reach}");
        for time in [0.0, 0.5, 1.0] {
            assert!(skin.deform(&mesh, time).positions.iter().all(|p| f64::from(p.length()) <= reach));
        }
    }
}
