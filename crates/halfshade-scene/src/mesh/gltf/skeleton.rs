//! The nodes of a glTF document as a skeleton that one of its animations moves.
//!
//! A joint `j` of a skin takes a point `p` of the mesh to `world_from_joint_j(t) · B_j · p`, where `B_j` is the joint's
//! inverse bind matrix; the transform of the node that holds the mesh doesn't count. The mesh at rest is what the skin's
//! first joint makes of it while all nodes stand as the document has them:
//!
//! ```text
//! rest = G p     G = world_from_joint_0 · B_0     M_j(t) = world_from_joint_j(t) · B_j · G⁻¹
//! ```
//!
//! In the pose in which the mesh was bound all joints agree on `G`, so this is the mesh as it was bound, upright and of
//! its size in the world. Meshes without a skin that stand in the same document follow their node.
//!
//! Only nodes that the animation moves, and nodes above them, become joints: what stands still below them is folded into
//! `joint_from_rest`, where it may be any affine map. Joints must be similarities, as a [`crate::Pose`] is.

use super::accessor::{WholeNumbers, numbers};
use super::channels::read_channels;
use super::nodes::{PlacedNode, base, follow_moved, label, places};
use super::track::{Weights, pose_of};
use super::{Animation, Buffers};
use crate::skin::INFLUENCES;
use crate::{Joint, Motion, Pose, SceneError};
use ::gltf::accessor::Dimensions;
use ::gltf::{Document, Node, Primitive, Semantic};
use glam::{DAffine3, DMat4, DVec4};
use std::collections::HashMap;

/// Joints and weights of a vertex, as in [`crate::Skin`].
pub(super) type Influences = [(u16, f32); INFLUENCES];

/// The nodes of a document, one animation, and the joints that meshes needed so far.
pub(super) struct Skeleton<'a> {
    buffers: &'a Buffers,
    places: Vec<PlacedNode<'a>>,
    joints: Vec<Joint>,
    /// Whether the `joint_from_rest` of a joint is in use.
    is_bound: Vec<bool>,
    bindings: Vec<Binding>,
    /// Bindings by skin.
    binding_of: HashMap<usize, usize>,
}

/// Binding of a mesh to the skeleton.
struct Binding {
    world_from_mesh: DMat4,
    /// Node and `B_j · G⁻¹` of each joint of the skin; empty where the mesh follows `joints[0]` as a whole.
    nodes: Vec<(usize, DMat4)>,
    /// The number of each among the skeleton's joints, once a vertex has asked for it.
    joints: Vec<Option<u16>>,
}

impl<'a> Skeleton<'a> {
    pub(super) fn new(
        document: &'a Document,
        buffers: &'a Buffers,
        animation: Option<&Animation>,
    ) -> Result<Self, SceneError> {
        let mut places = places(document)?;
        if let Some(animation) = animation {
            read_channels(document, buffers, animation, &mut places)?;
        }
        follow_moved(&mut places)?;
        let (joints, is_bound, bindings, binding_of) = Default::default();
        Ok(Self { buffers, places, joints, is_bound, bindings, binding_of })
    }

    /// Binding of a node's mesh to the skeleton, by number, and the place of the mesh at rest.
    pub(super) fn bind(&mut self, node: &Node<'_>) -> Result<(usize, DMat4), SceneError> {
        let known = node.skin().and_then(|skin| self.binding_of.get(&skin.index()).copied());
        let number = known.unwrap_or(self.bindings.len());
        if known.is_none() {
            let binding = match node.skin() {
                Some(skin) => {
                    self.binding_of.insert(skin.index(), number);
                    self.skin(&skin).map_err(|error| about_skin(&skin, error))?
                }
                None => self.rigid(node.index())?,
            };
            self.bindings.push(binding);
        }
        Ok((number, self.bindings[number].world_from_mesh))
    }

    /// Joints and weights of the vertices of a primitive of a mesh so bound.
    pub(super) fn influences(
        &mut self,
        binding: usize,
        primitive: &Primitive<'_>,
        count: usize,
    ) -> Result<Vec<Influences>, SceneError> {
        if self.bindings[binding].nodes.is_empty() {
            let joint = self.bindings[binding].joints.first().copied().flatten().unwrap_or(0);
            return Ok(vec![[(joint, 1.0), (0, 0.0), (0, 0.0), (0, 0.0)]; count]);
        }
        let mut result = Vec::with_capacity(count);
        for (vertex, mut list) in self.weights_of_joints(primitive, count)?.into_iter().enumerate() {
            list.truncate(INFLUENCES);
            let sum: f64 = list.iter().map(|(_, weight)| weight).sum();
            let mut influences = [(0, 0.0); INFLUENCES];
            for (slot, (joint, weight)) in influences.iter_mut().zip(list) {
                *slot = (self.joint_of_skin(binding, vertex, joint)?, (weight / sum) as f32);
            }
            result.push(influences);
        }
        Ok(result)
    }

    /// Transform of each vertex of a primitive by the joints of a skin, as the document has them.
    pub(super) fn at_joints(
        &self,
        skin: &::gltf::Skin<'_>,
        primitive: &Primitive<'_>,
        count: usize,
    ) -> Result<Vec<DMat4>, SceneError> {
        let (nodes, inverse_binds) = self.joints_of(skin).map_err(|error| about_skin(skin, error))?;
        let mut matrices: Vec<DMat4> = Vec::with_capacity(nodes.len());
        for (node, inverse_bind) in nodes.iter().zip(&inverse_binds) {
            let matrix = affine(self.places[*node].world_from_node * *inverse_bind).ok_or_else(|| {
                let problem = format!("the inverse bind matrix of {} is not affine or not finite", self.label(*node));
                about_skin(skin, SceneError::new(problem))
            })?;
            matrices.push(matrix);
        }
        let blended = |(vertex, list): (usize, Vec<(usize, f64)>)| {
            let sum: f64 = list.iter().map(|(_, weight)| weight).sum();
            let mut matrix = DMat4::ZERO;
            for (joint, weight) in list {
                let of_joint = matrices.get(joint).ok_or_else(|| no_such_joint(vertex, joint, matrices.len()))?;
                matrix += *of_joint * (weight / sum);
            }
            Ok(matrix)
        };
        self.weights_of_joints(primitive, count)?.into_iter().enumerate().map(blended).collect()
    }

    /// Animated weights of a node's morph targets; empty where there are none.
    pub(super) fn weights(&self, node: usize) -> &[Weights] {
        &self.places[node].weights
    }

    /// Joints that move each vertex, and their weights, which are positive: the heaviest first, at least one.
    fn weights_of_joints(&self, primitive: &Primitive<'_>, count: usize) -> Result<Vec<Vec<(usize, f64)>>, SceneError> {
        let mut of_vertices: Vec<Vec<(usize, f64)>> = vec![Vec::new(); count];
        for set in 0.. {
            let what = format!("JOINTS_{set} and WEIGHTS_{set}");
            let pair = (primitive.get(&Semantic::Joints(set)), primitive.get(&Semantic::Weights(set)));
            let (joints, weights) = match pair {
                (Some(joints), Some(weights)) => (joints, weights),
                (None, None) if set > 0 => break,
                _ => return Err(SceneError::new(format!("a primitive with a skin lacks {what}"))),
            };
            let joints = numbers::<4>(&joints, self.buffers, Dimensions::Vec4, WholeNumbers::Number)?;
            let weights = numbers::<4>(&weights, self.buffers, Dimensions::Vec4, WholeNumbers::Fraction)?;
            if joints.len() != count || weights.len() != count {
                let (joints, weights) = (joints.len(), weights.len());
                let problem = format!("{joints} joints and {weights} weights of {what} for {count} positions");
                return Err(SceneError::new(problem));
            }
            for (list, (joints, weights)) in of_vertices.iter_mut().zip(joints.into_iter().zip(weights)) {
                list.extend(joints.into_iter().map(|joint| joint as usize).zip(weights));
            }
        }
        for (vertex, list) in of_vertices.iter_mut().enumerate() {
            if let Some((joint, weight)) = list.iter().find(|(_, weight)| *weight < 0.0) {
                return Err(SceneError::new(format!("vertex {vertex} has the weight {weight} of joint {joint}")));
            }
            list.retain(|(_, weight)| *weight > 0.0);
            // Stable: of equal weights the first ones stay.
            list.sort_by(|a, b| b.1.total_cmp(&a.1));
            if list.is_empty() {
                return Err(SceneError::new(format!("vertex {vertex} hangs on no joint: its weights are all zero"))
                    .with_remedy("give every vertex a weight in the program that wrote the file"));
            }
        }
        Ok(of_vertices)
    }

    /// Whether any mesh had a skin.
    pub(super) fn has_skin(&self) -> bool {
        !self.binding_of.is_empty()
    }

    pub(super) fn into_joints(self) -> Vec<Joint> {
        self.joints
    }

    /// Nodes and inverse bind matrices of the joints of a skin.
    fn joints_of(&self, skin: &::gltf::Skin<'_>) -> Result<(Vec<usize>, Vec<DMat4>), SceneError> {
        let nodes: Vec<usize> = skin.joints().map(|node| node.index()).collect();
        let inverse_binds: Vec<DMat4> = match skin.inverse_bind_matrices() {
            Some(accessor) => numbers::<16>(&accessor, self.buffers, Dimensions::Mat4, WholeNumbers::Refused)?
                .iter()
                .map(DMat4::from_cols_array)
                .collect(),
            None => vec![DMat4::IDENTITY; nodes.len()],
        };
        if inverse_binds.len() < nodes.len() {
            let (found, count) = (inverse_binds.len(), nodes.len());
            return Err(SceneError::new(format!("{found} inverse bind matrices for {count} joints")));
        }
        Ok((nodes, inverse_binds))
    }

    /// A skin as the document has it; joints are checked once they are used.
    fn skin(&self, skin: &::gltf::Skin<'_>) -> Result<Binding, SceneError> {
        let (nodes, inverse_binds) = self.joints_of(skin)?;
        let (Some(first), Some(inverse_bind)) = (nodes.first(), inverse_binds.first()) else {
            return Err(SceneError::new("it has no joints"));
        };
        let world_from_mesh = affine(self.places[*first].world_from_node * *inverse_bind);
        let mesh_from_world = world_from_mesh.and_then(|matrix| inverse(&matrix));
        let (Some(world_from_mesh), Some(mesh_from_world)) = (world_from_mesh, mesh_from_world) else {
            let problem = format!("its first joint, {}, flattens the mesh or is not affine", self.label(*first));
            return Err(SceneError::new(problem));
        };
        let nodes: Vec<_> = nodes.into_iter().zip(inverse_binds.iter().map(|bind| *bind * mesh_from_world)).collect();
        Ok(Binding { world_from_mesh, joints: vec![None; nodes.len()], nodes })
    }

    /// A mesh without a skin follows its node, or rather the nearest one above that moves.
    fn rigid(&mut self, node: usize) -> Result<Binding, SceneError> {
        let world_from_mesh = self.places[node].world_from_node;
        let joint = match self.places[node].moved {
            Some(moved) => {
                let moved_from_world = inverse(&self.places[moved].world_from_node).ok_or_else(|| {
                    SceneError::new(format!("{} has a scale of zero, but carries a mesh", self.label(moved)))
                })?;
                self.attach(moved, moved_from_world)?
            }
            None => self.push(None, Motion::Still(Pose::IDENTITY), DMat4::IDENTITY, true)?,
        };
        Ok(Binding { world_from_mesh, nodes: Vec::new(), joints: vec![Some(joint as u16)] })
    }

    /// The skeleton's joint that a joint of a skin is.
    fn joint_of_skin(&mut self, binding: usize, vertex: usize, joint: usize) -> Result<u16, SceneError> {
        let Binding { nodes, joints, .. } = &self.bindings[binding];
        let Some(&(node, node_from_rest)) = nodes.get(joint) else {
            return Err(no_such_joint(vertex, joint, nodes.len()));
        };
        if let Some(known) = joints[joint] {
            return Ok(known);
        }
        let number = self.attach(node, node_from_rest)? as u16;
        self.bindings[binding].joints[joint] = Some(number);
        Ok(number)
    }

    /// A joint that carries along what lies in the space of `node` at rest.
    fn attach(&mut self, node: usize, node_from_rest: DMat4) -> Result<usize, SceneError> {
        let PlacedNode { moved, moved_from_node, .. } = self.places[node];
        let joint_from_rest = affine(moved_from_node * node_from_rest).filter(|m| m.as_mat4().is_finite());
        let Some(joint_from_rest) = joint_from_rest else {
            let problem = format!("the inverse bind matrix of {} is not affine or not finite", self.label(node));
            return Err(SceneError::new(problem));
        };
        // First, as it says more where a node above is at fault.
        let joint = moved.map(|moved| self.joint_of_node(moved)).transpose()?;
        if joint_from_rest.determinant() <= 0.0 {
            let problem = format!("{} mirrors or flattens the mesh where other joints don't", self.label(node));
            return Err(SceneError::new(problem).with_remedy("apply scales in the program that wrote the file"));
        }
        let Some(joint) = joint else {
            return self.push(None, Motion::Still(Pose::IDENTITY), joint_from_rest, true);
        };
        if self.is_bound[joint] {
            return self.push(Some(joint), Motion::Still(Pose::IDENTITY), joint_from_rest, true);
        }
        self.is_bound[joint] = true;
        self.joints[joint].joint_from_rest = DAffine3::from_mat4(joint_from_rest).as_affine3a();
        Ok(joint)
    }

    /// The joint that moves as a node does; it and those above it are made where there is none yet.
    fn joint_of_node(&mut self, node: usize) -> Result<usize, SceneError> {
        let mut missing = Vec::new();
        let mut next = Some(node);
        while let Some(index) = next.filter(|&index| self.places[index].joint.is_none()) {
            missing.push(index);
            next = self.places[index].parent;
        }
        let mut parent = next.and_then(|index| self.places[index].joint);
        while let Some(index) = missing.pop() {
            let place = &self.places[index];
            let motion = match &place.tracks {
                Some(tracks) => base(place).and_then(|base| tracks.motion(base)),
                None => pose_of(&place.parent_from_node).map(Motion::Still),
            };
            let motion = motion.map_err(|error| self.about(index, error))?;
            let joint = self.push(parent, motion, DMat4::IDENTITY, false)?;
            self.places[index].joint = Some(joint);
            parent = Some(joint);
        }
        // `node` was known or has been made.
        parent.ok_or_else(|| SceneError::new(format!("{} is no joint", self.label(node))))
    }

    fn push(
        &mut self,
        parent: Option<usize>,
        motion: Motion,
        joint_from_rest: DMat4,
        is_bound: bool,
    ) -> Result<usize, SceneError> {
        if self.joints.len() > usize::from(u16::MAX) {
            return Err(SceneError::new("the skeleton has more than 65536 joints"));
        }
        let joint_from_rest = DAffine3::from_mat4(joint_from_rest).as_affine3a();
        self.joints.push(Joint { parent, motion, joint_from_rest });
        self.is_bound.push(is_bound);
        Ok(self.joints.len() - 1)
    }

    fn label(&self, node: usize) -> String {
        label(&self.places[node].node)
    }

    fn about(&self, node: usize, error: SceneError) -> SceneError {
        SceneError { problem: format!("{}: {}", self.label(node), error.problem), ..error }
    }
}

fn no_such_joint(vertex: usize, joint: usize, count: usize) -> SceneError {
    SceneError::new(format!("vertex {vertex} names joint {joint}, but the skin has only {count}"))
}

fn about_skin(skin: &::gltf::Skin<'_>, error: SceneError) -> SceneError {
    let name = skin.name().map_or_else(|| skin.index().to_string(), |name| format!("`{name}`"));
    SceneError { problem: format!("skin {name}: {}", error.problem), ..error }
}

/// An affine matrix whose last row is exactly so; `None` for what isn't affine or not finite.
fn affine(mut matrix: DMat4) -> Option<DMat4> {
    let off = (matrix.row(3) - DVec4::W).abs().max_element();
    matrix.x_axis.w = 0.0;
    matrix.y_axis.w = 0.0;
    matrix.z_axis.w = 0.0;
    matrix.w_axis.w = 1.0;
    (off < 1e-3 && matrix.is_finite()).then_some(matrix)
}

/// The inverse of an affine matrix, unless it is singular.
fn inverse(matrix: &DMat4) -> Option<DMat4> {
    let inverse = DMat4::from(DAffine3::from_mat4(*matrix).inverse());
    (matrix.determinant() != 0.0 && inverse.is_finite()).then_some(inverse)
}
