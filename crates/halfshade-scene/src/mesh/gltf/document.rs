//! Bytes of a file as a checked document and its buffers.
//!
//! The crate's validation takes some things for granted, which are looked at here first, and refuses others that do no
//! harm, which are mended here: bounds of positions that are missing, and accessors without data, which glTF says are
//! zero.

use super::buffers::Buffers;
use super::emission::emission_note;
use super::extensions::{self, Aim};
use super::instances;
use super::morph;
use super::uri;
use crate::{SceneError, text};
use ::gltf::json::{Index, Root, Value, accessor, deserialize, validation::Checked};
use ::gltf::{Document, Glb, Semantic, buffer};
use std::collections::HashSet;
use std::path::Path;

/// The document in a file, its buffers, and what of it isn't read, for people.
pub(super) fn read(path: &Path, bytes: &[u8], aim: Aim) -> Result<(Document, Buffers, Vec<String>), SceneError> {
    let (text, blob) = parts(bytes)?;
    let text = unpadded(&text)?;
    let mut json = parse(text, blob.is_none())?;
    let mut notes = extensions::check(&json, aim)?;
    notes.extend(emission_note(&json));
    notes.extend(instances::note(&json));
    notes.extend(morph::note(text, &json));
    let is_quantized = json.extensions_used.iter().any(|name| name == "KHR_mesh_quantization");
    check_positions(&json)?;
    check_matrices(&json)?;
    let zeros = complete(&mut json);
    json.extensions_required.clear();
    let document = Document::from_json(json).map_err(|error| no_gltf(&error))?;
    let folder = path.parent().unwrap_or(Path::new("")).to_owned();
    let data = document.buffers().map(|b| buffer(&b, &folder, blob.as_deref())).collect::<Result<_, _>>()?;
    Ok((document, Buffers { folder, data, zeros, is_quantized }, notes))
}

fn no_gltf(error: &::gltf::Error) -> SceneError {
    SceneError::new(format!("this is no valid glTF: {error}")).with_remedy("export it again, or run a glTF validator")
}

/// The JSON text and, of a GLB, the binary chunk, which may be empty.
fn parts(bytes: &[u8]) -> Result<(Vec<u8>, Option<Vec<u8>>), SceneError> {
    if !bytes.starts_with(b"glTF") {
        return Ok((bytes.to_vec(), None));
    }
    let number = |at: usize| bytes.get(at..at + 4).and_then(|b| b.try_into().ok()).map(u32::from_le_bytes);
    if let Some(version) = number(4).filter(|version| *version != 2) {
        return Err(other_version(&format!("{version} (binary)")));
    }
    match number(8) {
        Some(length) if length >= 20 && length as usize <= bytes.len() => {}
        Some(length) => {
            let problem = format!("{length} bytes are declared, but the file has {}", bytes.len());
            return Err(SceneError::new(problem).with_remedy("the file was cut short or damaged: get it again"));
        }
        None => {
            return Err(SceneError::new("the file ends within its header").with_remedy("get it again"));
        }
    }
    let glb = Glb::from_slice(bytes).map_err(|error| no_gltf(&error))?;
    Ok((glb.json.into_owned(), Some(glb.bin.map_or_else(Vec::new, std::borrow::Cow::into_owned))))
}

/// The text without a byte-order mark before it, and without the zeros with which some programs fill up a chunk.
fn unpadded(text: &[u8]) -> Result<&[u8], SceneError> {
    let text = text::without_mark(text)?;
    let end = text.iter().rposition(|byte| *byte != 0).map_or(0, |last| last + 1);
    Ok(&text[..end])
}

/// The JSON document.
fn parse(text: &[u8], has_lines: bool) -> Result<Root, SceneError> {
    match deserialize::from_slice::<Root>(text).or_else(|error| with_empty_scenes(text).ok_or(error)) {
        Ok(root) if is_version_2(&root.asset.version) && root.asset.min_version.as_deref().is_none_or(is_version_2) => {
            Ok(root)
        }
        Ok(root) => Err(other_version(root.asset.min_version.as_ref().unwrap_or(&root.asset.version))),
        Err(error) => {
            // Other versions have other keys, so that the version is what is wrong with them.
            let whole: Option<Value> = deserialize::from_slice(text).ok();
            let version = whole.as_ref().and_then(|value| value.get("asset")?.get("version")?.as_str());
            match version {
                Some(version) if !is_version_2(version) => Err(other_version(version)),
                _ => {
                    let line = error.line();
                    let error = no_gltf(&::gltf::Error::Deserialize(error));
                    Err(if has_lines && line > 0 { error.at_line(line) } else { error })
                }
            }
        }
    }
}

/// The document of a text in which scenes lack the list of their nodes, which glTF lets them and the crate doesn't.
fn with_empty_scenes(text: &[u8]) -> Option<Root> {
    let mut value: Value = deserialize::from_slice(text).ok()?;
    let mut is_mended = false;
    for scene in value.get_mut("scenes")?.as_array_mut()? {
        let nodes = || {
            is_mended = true;
            Value::Array(Vec::new())
        };
        scene.as_object_mut()?.entry("nodes").or_insert_with(nodes);
    }
    // Other faults mustn't be lost on the way: a value forgets keys that are there twice.
    if is_mended { deserialize::from_value(value).ok() } else { None }
}

/// Whether this is 2.0, or a later version that is compatible with it.
fn is_version_2(version: &str) -> bool {
    version == "2" || version.starts_with("2.")
}

fn other_version(version: &str) -> SceneError {
    SceneError::new(format!("this is glTF {version}, and only glTF 2.0 is read"))
        .with_remedy("convert it to glTF 2.0, or export it again")
}

/// Positions must name an accessor that exists: the crate's validation takes it for granted.
fn check_positions(json: &Root) -> Result<(), SceneError> {
    let primitives = json.meshes.iter().flat_map(|mesh| &mesh.primitives);
    let mut accessors =
        primitives.filter_map(|primitive| primitive.attributes.get(&Checked::Valid(Semantic::Positions)));
    match accessors.find(|accessor| accessor.value() >= json.accessors.len()) {
        Some(accessor) => Err(SceneError::new(format!("accessor {} is named, but doesn't exist", accessor.value()))),
        None => Ok(()),
    }
}

/// Matrices of nodes must be affine: the bottom row is taken for 0, 0, 0, 1.
fn check_matrices(json: &Root) -> Result<(), SceneError> {
    for (number, node) in json.nodes.iter().enumerate() {
        let Some(matrix) = node.matrix else { continue };
        let bottom = [matrix[3], matrix[7], matrix[11], matrix[15]];
        if bottom.iter().zip([0.0, 0.0, 0.0, 1.0]).any(|(found, expected)| (found - expected).abs() > 1e-5) {
            return Err(SceneError::new(format!(
                "the bottom row of the matrix of node {number} is {bottom:?}, not 0, 0, 0, 1"
            ))
            .with_remedy("glTF has affine matrices, column by column: export it again"));
        }
    }
    Ok(())
}

/// Fills in what the crate wants and nobody reads; returns the accessors that have no data.
fn complete(json: &mut Root) -> HashSet<usize> {
    let mut zeros = HashSet::new();
    let has_views = !json.buffer_views.is_empty();
    for (number, accessor) in json.accessors.iter_mut().enumerate() {
        if accessor.type_ == Checked::Valid(accessor::Type::Vec3) {
            for bound in [&mut accessor.min, &mut accessor.max] {
                bound.get_or_insert_with(|| Value::from(vec![0.0; 3]));
            }
        }
        if accessor.buffer_view.is_none() {
            zeros.insert(number);
            if has_views && accessor.sparse.is_none() {
                accessor.buffer_view = Some(Index::new(0));
            }
        }
    }
    zeros
}

/// The bytes of a buffer, as many as it declares.
fn buffer(buffer: &::gltf::Buffer<'_>, folder: &Path, blob: Option<&[u8]>) -> Result<Vec<u8>, SceneError> {
    let (label, data) = match buffer.source() {
        buffer::Source::Uri(uri) => {
            let label = format!("buffer {} ({})", buffer.index(), uri::label(uri));
            let data = uri::bytes(uri, folder).map_err(|error| SceneError {
                problem: format!("{label} cannot be read: {}", error.problem),
                ..error
            })?;
            (label, data)
        }
        buffer::Source::Bin => {
            let label = format!("buffer {}", buffer.index());
            let Some(blob) = blob.filter(|_| buffer.index() == 0) else {
                let compressed = extensions::COMPRESSIONS.iter().find(|name| buffer.extension_value(name).is_some());
                return Err(compressed.map_or_else(
                    || {
                        SceneError::new(format!("{label} has no data: it names no file, and no binary chunk holds it"))
                            .with_remedy("export again, as .glb or with the buffers beside the .gltf file")
                    },
                    |name| extensions::compressed(name),
                ));
            };
            (label, blob.to_vec())
        }
    };
    if data.len() < buffer.length() {
        let problem = format!("{label} has {} bytes, but {} are declared", data.len(), buffer.length());
        return Err(SceneError::new(problem).with_remedy("it was cut short or belongs to another file: get it again"));
    }
    Ok(data)
}
