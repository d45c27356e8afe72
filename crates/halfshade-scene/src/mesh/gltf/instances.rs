//! Copies of a mesh: EXT_mesh_gpu_instancing.

use super::Buffers;
use super::accessor::{WholeNumbers, numbers};
use crate::SceneError;
use ::gltf::accessor::Dimensions;
use ::gltf::json::{Root, Value};
use ::gltf::{Document, Node};
use glam::{DMat4, DQuat, DVec3};
use std::collections::BTreeSet;

const NAME: &str = "EXT_mesh_gpu_instancing";

/// Attributes that are read.
const ATTRIBUTES: [&str; 3] = ["TRANSLATION", "ROTATION", "SCALE"];

/// Tells people which attributes of copies aren't read.
pub(super) fn note(json: &Root) -> Option<String> {
    let extensions = json.nodes.iter().filter_map(|node| node.extensions.as_ref()?.others.get(NAME));
    let attributes = extensions.filter_map(|extension| extension.get("attributes")?.as_object());
    let names = attributes.flat_map(|list| list.keys()).map(String::as_str);
    let left_out: BTreeSet<&str> = names.filter(|name| !ATTRIBUTES.contains(name)).collect();
    let names = left_out.into_iter().collect::<Vec<_>>().join(", ");
    (!names.is_empty()).then(|| format!("attributes of copies left out ({NAME}): {names}"))
}

/// Places of the copies that a node asks for, in its space; one at its place where it asks for none.
pub(super) fn instances(node: &Node<'_>, document: &Document, buffers: &Buffers) -> Result<Vec<DMat4>, SceneError> {
    let Some(extension) = node.extension_value(NAME) else { return Ok(vec![DMat4::IDENTITY]) };
    let about = |problem: String| SceneError::new(format!("{NAME}: {problem}"));
    let attributes = extension.get("attributes").and_then(Value::as_object);
    let attributes = attributes.ok_or_else(|| about("there are no attributes".to_owned()))?;
    let accessor = |name: &str| {
        let Some(value) = attributes.get(name) else { return Ok(None) };
        let number = value.as_u64().and_then(|number| usize::try_from(number).ok());
        let accessor = number.and_then(|number| document.accessors().nth(number));
        accessor.map(Some).ok_or_else(|| about(format!("{name} names accessor {value}, which doesn't exist")))
    };
    let places = |name: &str| {
        let read = |a| numbers::<3>(&a, buffers, Dimensions::Vec3, WholeNumbers::AsDeclared);
        accessor(name)?.map(read).transpose()
    };
    let [translation, rotation, scale] = ATTRIBUTES;
    let (translations, scales) = (places(translation)?, places(scale)?);
    let rotations =
        accessor(rotation)?.map(|a| numbers::<4>(&a, buffers, Dimensions::Vec4, WholeNumbers::Fraction)).transpose()?;
    let counts = [translations.as_ref().map(Vec::len), scales.as_ref().map(Vec::len), rotations.as_ref().map(Vec::len)];
    let mut known = counts.into_iter().flatten();
    let Some(count) = known.next() else { return Ok(vec![DMat4::IDENTITY]) };
    if let Some(other) = known.find(|other| *other != count) {
        return Err(about(format!("its attributes are of different lengths, {count} and {other}")));
    }
    let at = |list: &Option<Vec<[f64; 3]>>, i: usize, default| list.as_ref().map_or(default, |l| DVec3::from(l[i]));
    let turn = |i: usize| {
        let turn = rotations.as_ref().map_or(DQuat::IDENTITY, |list| DQuat::from_array(list[i]));
        if turn.length_squared() < 1e-12 { DQuat::IDENTITY } else { turn.normalize() }
    };
    let matrix = |i| {
        let (scale, translation) = (at(&scales, i, DVec3::ONE), at(&translations, i, DVec3::ZERO));
        DMat4::from_scale_rotation_translation(scale, turn(i), translation)
    };
    Ok((0..count).map(matrix).collect())
}
