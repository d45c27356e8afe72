//! glTF 2.0 and GLB, read with `gltf`.
//!
//! The crate checks the document's structure; the bytes of vertices and indices are read here with every offset
//! checked, because the crate's own readers trust types and counts.
//!
//! Read are triangles, strips and fans with their node's place, copies of them (EXT_mesh_gpu_instancing), skins, morph
//! targets, base colour and alpha masks. A skinned mesh stands where its joints put it; the place of the node that holds
//! it doesn't count. Without normals each triangle is flat. Notes tell of anything else.

mod accessor;
mod buffers;
mod channels;
mod document;
mod emission;
mod extensions;
mod instances;
mod material;
mod morph;
mod movement;
mod nodes;
mod primitive;
mod skeleton;
mod stage;
mod textures;
mod track;
mod uri;

use super::animation::Animation;
use super::assemble::{RawMesh, RawMorph};
use super::file_scene::Punctual;
use crate::{Camera, Motion};
use crate::{Joint, SceneError};
use ::gltf::{Document, Node};
use buffers::Buffers;
use extensions::Aim;
use glam::DMat4;
use instances::instances;
use material::Coverage;
use nodes::{PlacedNode, world_from};
use primitive::{Part, Placement};
use skeleton::Skeleton;
use stage::Stage;
use std::collections::BTreeMap;
use std::path::Path;
use textures::Textures;

/// The mesh as the document has it, at rest.
pub(super) fn parse(path: &Path, bytes: &[u8]) -> Result<RawMesh, SceneError> {
    let (document, buffers, notes) = document::read(path, bytes, Aim::Mesh)?;
    let skeleton = if document.skins().len() > 0 { Some(Skeleton::new(&document, &buffers, None)?) } else { None };
    let mut collector = Collector::new(&document, &buffers, skeleton);
    collector.collect()?;
    collector.finish(notes).map(|(raw, _)| raw)
}

/// The mesh, the joints that an animation moves, on which the vertices hang as its influences say, and morph targets.
pub(super) fn parse_animated(
    path: &Path,
    bytes: &[u8],
    animation: &Animation,
) -> Result<(RawMesh, Vec<Joint>), SceneError> {
    let (document, buffers, notes) = document::read(path, bytes, Aim::Mesh)?;
    let skeleton = Skeleton::new(&document, &buffers, Some(animation))?;
    let mut collector = Collector { is_animated: true, ..Collector::new(&document, &buffers, Some(skeleton)) };
    collector.collect()?;
    let (raw, skeleton) = collector.finish(notes)?;
    match skeleton {
        Some(skeleton) if skeleton.has_skin() || !raw.morphs.is_empty() => Ok((raw, skeleton.into_joints())),
        _ => Err(SceneError::new("it has no skin and no morph targets that an animation could deform")
            .with_remedy("leave `animation` out; an object as a whole moves by `keyframe`")),
    }
}

/// A document as a scene.
pub(super) struct RawScene {
    pub(super) still: Option<RawMesh>,
    /// Name, mesh in its own space, and movement of what the first animation moves as a whole.
    pub(super) moving: Vec<(String, RawMesh, Motion)>,
    pub(super) camera: Option<Camera>,
    pub(super) lights: Vec<Punctual>,
    pub(super) notes: Vec<String>,
}

/// The document with what its first animation moves as a whole apart, its first camera, and its punctual lights. Skins and
/// morph targets stay at rest.
pub(super) fn parse_scene(path: &Path, bytes: &[u8]) -> Result<RawScene, SceneError> {
    let (document, buffers, mut notes) = document::read(path, bytes, Aim::Scene)?;
    let mut places = nodes::places(&document)?;
    let count = document.animations().len();
    if count > 0 {
        channels::read_channels(&document, &buffers, &Animation::Number(0), &mut places)?;
    }
    nodes::follow_moved(&mut places)?;
    let mut motions: BTreeMap<usize, Motion> = BTreeMap::new();
    let movers = places.iter().filter(|place| place.node.mesh().is_some() && place.node.skin().is_none());
    for moved in movers.filter_map(|place| place.moved) {
        match movement::motion(&places, moved) {
            Ok(motion) if motion.moves() => drop(motions.insert(moved, motion)),
            Ok(_) => {}
            Err(error) => notes.push(format!("a movement is left out: {}", error.problem)),
        }
    }
    if count > 1 && !motions.is_empty() {
        notes.push(format!("of {count} animations the first is shown"));
    }
    if places.iter().any(|place| place.node.skin().is_some() && count > 0 || !place.weights.is_empty()) {
        notes.push("skins and morph targets stay at rest; `animation` in a scene file moves them".to_owned());
    }
    let mut scene = RawScene { still: None, moving: Vec::new(), camera: None, lights: Vec::new(), notes };
    let groups: Vec<Option<usize>> = std::iter::once(None).chain(motions.keys().copied().map(Some)).collect();
    for moved in groups {
        let skeleton = if document.skins().len() > 0 { Some(Skeleton::new(&document, &buffers, None)?) } else { None };
        let group = Group { places: &places, motions: &motions, moved, stage: Stage::default() };
        let mut collector = Collector { group: Some(group), ..Collector::new(&document, &buffers, skeleton) };
        collector.collect()?;
        let stage = collector.group.take().map(|group| group.stage).unwrap_or_default();
        if moved.is_none() {
            (scene.camera, scene.lights) = (stage.camera, stage.lights);
            scene.notes.extend(stage.notes);
        }
        if collector.raw.triangles.is_empty() && collector.has_mesh && !motions.is_empty() {
            continue;
        }
        let (raw, _) = collector.finish(Vec::new())?;
        match moved.and_then(|moved| Some((moved, motions.get(&moved)?))) {
            Some((moved, motion)) => {
                let node = &places[moved].node;
                let name = node.name().map_or_else(|| format!("node {moved}"), str::to_owned);
                scene.moving.push((name, raw, motion.clone()));
            }
            None => scene.still = Some(raw),
        }
    }
    Ok(scene)
}

/// The part of a document that is collected: meshes that one node moves, or all that none does, with cameras and lights.
struct Group<'a> {
    places: &'a [PlacedNode<'a>],
    motions: &'a BTreeMap<usize, Motion>,
    moved: Option<usize>,
    stage: Stage,
}

impl Group<'_> {
    /// Whether a node is of the group, and where its mesh stands.
    fn place(&self, node: &Node<'_>) -> (bool, DMat4) {
        let place = &self.places[node.index()];
        let moved = place.moved.filter(|moved| node.skin().is_none() && self.motions.contains_key(moved));
        (moved == self.moved, if moved.is_some() { place.moved_from_node } else { place.world_from_node })
    }
}

/// All meshes of the document's scene on their way to become one.
struct Collector<'a> {
    document: &'a Document,
    buffers: &'a Buffers,
    /// Where a document has skins, or an animation was asked for.
    skeleton: Option<Skeleton<'a>>,
    is_animated: bool,
    /// Where only a part is collected.
    group: Option<Group<'a>>,
    textures: Textures<'a>,
    raw: RawMesh,
    left_out: LeftOut,
    /// Whether any node that is shown has a mesh.
    has_mesh: bool,
}

/// Number of parts of each kind that isn't read.
#[derive(Default)]
struct LeftOut {
    lines: usize,
    indices: usize,
    blended: usize,
    gone: usize,
    copies_of_skins: usize,
}

impl<'a> Collector<'a> {
    fn new(document: &'a Document, buffers: &'a Buffers, skeleton: Option<Skeleton<'a>>) -> Self {
        let (raw, left_out, textures) = (RawMesh::default(), LeftOut::default(), Textures::new(document));
        Self { document, buffers, skeleton, is_animated: false, group: None, textures, raw, left_out, has_mesh: false }
    }

    /// Walks through the nodes of the scene.
    fn collect(&mut self) -> Result<(), SceneError> {
        let document = self.document;
        let mut stack: Vec<(Node<'a>, DMat4)> = Vec::new();
        let count = document.scenes().len();
        if document.default_scene().is_none() && count > 1 {
            self.raw.notes.push(format!("of {count} scenes the first is read, as the document doesn't say which"));
        }
        match document.default_scene().or_else(|| document.scenes().next()) {
            Some(scene) => stack.extend(scene.nodes().map(|node| (node, DMat4::IDENTITY))),
            None => {
                let mut is_root = vec![true; document.nodes().len()];
                document.nodes().flat_map(|node| node.children()).for_each(|child| is_root[child.index()] = false);
                stack.extend(document.nodes().filter(|node| is_root[node.index()]).map(|n| (n, DMat4::IDENTITY)));
            }
        }
        // The order of the file, depth first.
        stack.reverse();
        let mut seen = vec![false; document.nodes().len()];
        while let Some((node, world_from_parent)) = stack.pop() {
            if std::mem::replace(&mut seen[node.index()], true) {
                return Err(SceneError::new(format!("node {} has two parents or is its own ancestor", node.index()))
                    .with_remedy("the nodes must form trees: export it again"));
            }
            let visibility =
                node.extension_value("KHR_node_visibility").and_then(|value| value.get("visible")?.as_bool());
            if visibility == Some(false) {
                continue;
            }
            let world_from_node = world_from(&node, world_from_parent);
            self.add(&node, world_from_node)?;
            let first_child = stack.len();
            stack.extend(node.children().map(|child| (child, world_from_node)));
            stack[first_child..].reverse();
        }
        Ok(())
    }

    /// Adds the mesh of a node, if it has one.
    fn add(&mut self, node: &Node<'a>, world_from_node: DMat4) -> Result<(), SceneError> {
        let mut world_from_node = world_from_node;
        let mut is_of_group = true;
        if let Some(group) = &mut self.group {
            if group.moved.is_none() {
                let moves = group.places[node.index()].moved.is_some();
                group.stage.add(self.document, node, world_from_node, moves)?;
            }
            (is_of_group, world_from_node) = group.place(node);
        }
        let Some(mesh) = node.mesh() else { return Ok(()) };
        self.has_mesh = true;
        if !is_of_group {
            return Ok(());
        }
        let name = mesh.name().map_or_else(|| mesh.index().to_string(), |name| format!("`{name}`"));
        let about = |error: SceneError| SceneError { problem: format!("mesh {name}: {}", error.problem), ..error };
        let mut copies = instances(node, self.document, self.buffers).map_err(about)?;
        if node.skin().is_some() && node.extension_value("EXT_mesh_gpu_instancing").is_some() {
            self.left_out.copies_of_skins += 1;
            copies = vec![DMat4::IDENTITY];
        }
        let (bound, world_from_mesh) = match self.skeleton.as_mut().filter(|_| self.is_animated) {
            Some(skeleton) => {
                let (binding, world_from_mesh) = skeleton.bind(node).map_err(about)?;
                (Some(binding), world_from_mesh)
            }
            None => (None, world_from_node),
        };
        let weights = morph::weights(node);
        let moving = self.skeleton.as_ref().filter(|_| self.is_animated).map_or(&[][..], |s| s.weights(node.index()));
        let first_morph = self.raw.morphs.len();
        self.raw.morphs.extend(moving.iter().enumerate().map(|(target, keys)| {
            let at_rest = weights.get(target).copied().unwrap_or(0.0) as f32;
            RawMorph {
                weight: keys.iter().map(|&(time, weight)| (time, weight - at_rest)).collect(),
                shifts: Vec::new(),
            }
        }));
        for primitive in mesh.primitives() {
            let Some(mut part) = Part::read(&primitive, self.buffers).map_err(about)? else {
                self.left_out.lines += 1;
                continue;
            };
            self.left_out.indices += part.left_over;
            part.morph(&weights);
            let at_joints = match (self.skeleton.as_ref().filter(|_| !self.is_animated), node.skin()) {
                (Some(skeleton), Some(skin)) => {
                    Some(skeleton.at_joints(&skin, &primitive, part.vertex_count()).map_err(about)?)
                }
                _ => None,
            };
            let influences = match (self.skeleton.as_mut(), bound) {
                (Some(skeleton), Some(binding)) => {
                    skeleton.influences(binding, &primitive, part.vertex_count()).map_err(about)?
                }
                _ => Vec::new(),
            };
            for copy in &copies {
                let placement = match &at_joints {
                    Some(matrices) => Placement::Each(matrices),
                    None => Placement::Rigid(world_from_mesh * *copy),
                };
                let before = self.raw.positions.len();
                let placed = part.place(&placement, &mut self.textures, self.buffers, &mut self.raw).map_err(about)?;
                self.left_out.blended += usize::from(placed.coverage == Coverage::Blended);
                self.left_out.gone += usize::from(placed.coverage == Coverage::Gone);
                if self.is_animated {
                    self.raw.influences.extend(placed.sources.iter().map(|&v| influences[v as usize]));
                    self.raw.flat.resize(before, false);
                    self.raw.flat.resize(self.raw.positions.len(), part.is_flat());
                    let morphs = &mut self.raw.morphs[first_morph..];
                    for (morph, target) in morphs.iter_mut().zip(&part.targets) {
                        morph.shifts.extend(part.shifts(target, &placement, &placed.sources, before));
                    }
                }
            }
        }
        Ok(())
    }

    /// The mesh, and what moves it; `notes` are those of the document.
    fn finish(self, notes: Vec<String>) -> Result<(RawMesh, Option<Skeleton<'a>>), SceneError> {
        let Self { mut raw, textures, left_out, skeleton, has_mesh, .. } = self;
        if !has_mesh {
            return Err(SceneError::new("its scene is empty: no node that is shown has a mesh")
                .with_remedy("export a scene with a mesh"));
        }
        let LeftOut { lines, indices, blended, gone, copies_of_skins } = left_out;
        if raw.triangles.is_empty() && gone > 0 {
            return Err(SceneError::new("its alpha masks cut out all that there is")
                .with_remedy("raise alpha, lower alphaCutoff, or make the material opaque"));
        }
        if raw.triangles.is_empty() && lines > 0 {
            return Err(SceneError::new("it has points or lines only, and no triangles")
                .with_remedy("surfaces are what is read: export triangles"));
        }
        raw.notes.splice(0..0, notes);
        for (count, what) in [
            (lines, "parts of points or lines left out"),
            (indices, "indices after the last whole triangle left out"),
            (blended, "parts that alpha blending makes translucent taken for opaque"),
            (copies_of_skins, "meshes with a skin taken once, not in copies as EXT_mesh_gpu_instancing says"),
        ] {
            if count > 0 {
                raw.notes.push(format!("{what}: {count}"));
            }
        }
        if textures.is_used() {
            raw.textures = textures.list;
        } else {
            raw.texture_coordinates.iter_mut().for_each(|place| place.z = 0.0);
        }
        if !textures.masks.is_empty() {
            let note =
                "alpha masks cut holes, which rays see; spheres, and what is made of them, take triangles for whole";
            raw.notes.push(note.to_owned());
        }
        raw.masks = textures.masks;
        Ok((raw, skeleton))
    }
}

#[cfg(test)]
mod tests;
