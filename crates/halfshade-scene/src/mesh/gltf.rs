//! glTF 2.0 and GLB, read with `gltf`.
//!
//! The crate checks the document's structure; the bytes of vertices and indices are read here with every offset
//! checked, because the crate's own readers trust types and counts.

use super::assemble::RawMesh;
use crate::SceneError;
use ::gltf::accessor::{DataType, Dimensions};
use ::gltf::mesh::Mode;
use ::gltf::{Accessor, Gltf, Node, Primitive, Semantic};
use glam::{DMat3, DMat4, DVec3, Vec3};
use std::path::Path;

type Buffers = Vec<::gltf::buffer::Data>;

pub(super) fn parse(path: &Path, bytes: &[u8]) -> Result<RawMesh, SceneError> {
    if bytes.starts_with(b"glTF") {
        check_length(bytes)?;
    }
    let wrong = |error: ::gltf::Error| SceneError::new(format!("this is no valid glTF: {error}"));
    let Gltf { document, blob } = Gltf::from_slice_without_validation(bytes).map_err(wrong)?;
    let json = document.into_json();
    check_positions(&json)?;
    let document = ::gltf::Document::from_json(json).map_err(wrong)?;
    for buffer in document.buffers() {
        if let ::gltf::buffer::Source::Uri(uri) = buffer.source() {
            check_uri(uri)?;
        }
    }
    let buffers = ::gltf::import_buffers(&document, Some(path.parent().unwrap_or(Path::new(""))), blob)
        .map_err(|error| SceneError::new(format!("a buffer cannot be read: {error}")))?;

    let mut stack: Vec<(Node<'_>, DMat4)> = Vec::new();
    match document.default_scene().or_else(|| document.scenes().next()) {
        Some(scene) => stack.extend(scene.nodes().map(|node| (node, DMat4::IDENTITY))),
        None => {
            let mut is_root = vec![true; document.nodes().len()];
            document.nodes().flat_map(|node| node.children()).for_each(|child| is_root[child.index()] = false);
            stack.extend(document.nodes().filter(|node| is_root[node.index()]).map(|node| (node, DMat4::IDENTITY)));
        }
    }
    // The order of the file, depth first.
    stack.reverse();
    let mut raw = RawMesh::default();
    let mut seen = vec![false; document.nodes().len()];
    while let Some((node, world_from_parent)) = stack.pop() {
        if std::mem::replace(&mut seen[node.index()], true) {
            return Err(SceneError::new(format!("node {} has two parents or is its own ancestor", node.index())));
        }
        let local = node.transform().matrix().map(|column| column.map(f64::from));
        let world_from_node = world_from_parent * DMat4::from_cols_array_2d(&local);
        if let Some(mesh) = node.mesh() {
            for primitive in mesh.primitives() {
                append(&primitive, &buffers, world_from_node, &mut raw).map_err(|error| {
                    let name = mesh.name().map_or_else(|| mesh.index().to_string(), |name| format!("`{name}`"));
                    SceneError { problem: format!("mesh {name}: {}", error.problem), ..error }
                })?;
            }
        }
        let first_child = stack.len();
        stack.extend(node.children().map(|child| (child, world_from_node)));
        stack[first_child..].reverse();
    }
    Ok(raw)
}

/// A GLB says how long it is; a shorter file was cut.
fn check_length(bytes: &[u8]) -> Result<(), SceneError> {
    let declared = bytes.get(8..12).and_then(|b| b.try_into().ok()).map(u32::from_le_bytes);
    match declared {
        Some(length) if length >= 20 && length as usize <= bytes.len() => Ok(()),
        Some(length) => Err(SceneError::new(format!("{length} bytes are declared, but the file has {}", bytes.len()))
            .with_remedy("the file was cut short or damaged: get it again")),
        None => Err(SceneError::new("the file ends within its header")),
    }
}

/// Positions must name an accessor that exists: the crate's validation takes it for granted.
fn check_positions(json: &::gltf::json::Root) -> Result<(), SceneError> {
    let position = ::gltf::json::validation::Checked::Valid(Semantic::Positions);
    let primitives = json.meshes.iter().flat_map(|mesh| &mesh.primitives);
    let mut accessors = primitives.filter_map(|primitive| primitive.attributes.get(&position));
    match accessors.find(|accessor| accessor.value() >= json.accessors.len()) {
        Some(accessor) => Err(SceneError::new(format!("accessor {} is named, but doesn't exist", accessor.value()))),
        None => Ok(()),
    }
}

/// Percent escapes of a buffer's file name must spell UTF-8: the crate takes it for granted.
fn check_uri(uri: &str) -> Result<(), SceneError> {
    if uri.starts_with("data:") {
        return Ok(());
    }
    let bytes = uri.as_bytes();
    let mut decoded = Vec::with_capacity(bytes.len());
    let mut i = 0;
    while let Some(&byte) = bytes.get(i) {
        let escaped =
            (byte == b'%').then(|| uri.get(i + 1..i + 3)).flatten().and_then(|hex| u8::from_str_radix(hex, 16).ok());
        decoded.push(escaped.unwrap_or(byte));
        i += if escaped.is_some() { 3 } else { 1 };
    }
    match std::str::from_utf8(&decoded) {
        Ok(_) => Ok(()),
        Err(_) => Err(SceneError::new(format!("the buffer's file name `{uri}` is not UTF-8"))),
    }
}

/// Adds a primitive, moved to its place.
fn append(
    primitive: &Primitive<'_>,
    buffers: &Buffers,
    world_from_node: DMat4,
    raw: &mut RawMesh,
) -> Result<(), SceneError> {
    if !matches!(primitive.mode(), Mode::Triangles | Mode::TriangleStrip | Mode::TriangleFan) {
        return Ok(());
    }
    let Some(accessor) = primitive.get(&Semantic::Positions) else {
        return Err(SceneError::new("a primitive has no positions"));
    };
    let positions = vectors(&accessor, buffers, false)?;
    let of_length = |list: Vec<DVec3>, what: &str| {
        if list.len() == positions.len() {
            Ok(list)
        } else {
            Err(SceneError::new(format!("{} {what} for {} positions", list.len(), positions.len())))
        }
    };
    let normals = match primitive.get(&Semantic::Normals) {
        Some(accessor) => of_length(vectors(&accessor, buffers, false)?, "normals")?,
        None => vec![DVec3::ZERO; positions.len()],
    };
    let factor = primitive.material().pbr_metallic_roughness().base_color_factor();
    let factor = Vec3::from_slice(&factor).as_dvec3();
    let colors = match primitive.get(&Semantic::Colors(0)) {
        Some(accessor) => of_length(vectors(&accessor, buffers, true)?, "colours")?,
        None => vec![DVec3::ONE; positions.len()],
    };
    let indices = match primitive.indices() {
        Some(accessor) => indices(&accessor, buffers)?,
        None => (0..positions.len() as u32).collect(),
    };
    if let Some(index) = indices.iter().find(|&&index| index as usize >= positions.len()) {
        return Err(SceneError::new(format!("vertex {index} is named, but there are only {}", positions.len())));
    }

    let offset = raw.positions.len() as u32;
    let mirrored = world_from_node.determinant() < 0.0;
    raw.triangles.extend(triangles(primitive.mode(), &indices).map(|[a, b, c]| {
        let [a, b, c] = [a + offset, b + offset, c + offset];
        if mirrored { [a, c, b] } else { [a, b, c] }
    }));
    // Normals are covectors: the cofactor matrix keeps them upright under any scale, even a singular one.
    let m = DMat3::from_mat4(world_from_node);
    let sign = if mirrored { -1.0 } else { 1.0 };
    let cofactor =
        sign * DMat3::from_cols(m.y_axis.cross(m.z_axis), m.z_axis.cross(m.x_axis), m.x_axis.cross(m.y_axis));
    raw.positions.extend(positions.iter().map(|p| world_from_node.transform_point3(*p).as_vec3()));
    raw.normals.extend(normals.iter().map(|n| (cofactor * n.normalize_or_zero()).normalize_or_zero().as_vec3()));
    raw.colors.extend(colors.iter().map(|c| (factor * c).clamp(DVec3::ZERO, DVec3::ONE).as_vec3()));
    Ok(())
}

/// The triangles of a list, a strip or a fan of vertices.
fn triangles(mode: Mode, indices: &[u32]) -> impl Iterator<Item = [u32; 3]> {
    let count = match mode {
        Mode::Triangles => indices.len() / 3,
        _ => indices.len().saturating_sub(2),
    };
    (0..count).map(move |t| {
        let [a, b, c] = match mode {
            Mode::Triangles => [3 * t, 3 * t + 1, 3 * t + 2],
            Mode::TriangleFan => [0, t + 1, t + 2],
            _ if t % 2 == 0 => [t, t + 1, t + 2],
            _ => [t + 1, t, t + 2],
        };
        [indices[a], indices[b], indices[c]]
    })
}

/// Bytes of each element of an accessor, and nothing outside of its buffer.
fn elements<'a>(accessor: &Accessor<'_>, buffers: &'a Buffers) -> Result<impl Iterator<Item = &'a [u8]>, SceneError> {
    let index = accessor.index();
    if accessor.sparse().is_some() {
        return Err(SceneError::new(format!("accessor {index} is sparse, which is not supported"))
            .with_remedy("export without sparse accessors"));
    }
    let view = accessor.view().ok_or_else(|| {
        SceneError::new(format!("accessor {index} has no data")).with_remedy("export without mesh compression")
    })?;
    let (size, count) = (accessor.size(), accessor.count());
    let stride = view.stride().unwrap_or(size).max(1);
    let beyond = || SceneError::new(format!("accessor {index} reaches beyond its buffer"));
    let data = buffers.get(view.buffer().index()).ok_or_else(beyond)?;
    let data =
        view.offset().checked_add(view.length()).and_then(|end| data.get(view.offset()..end)).ok_or_else(beyond)?;
    let data = data.get(accessor.offset()..).ok_or_else(beyond)?;
    let needed = count.checked_sub(1).map_or(Some(0), |n| n.checked_mul(stride)?.checked_add(size));
    if needed.is_none_or(|needed| needed > data.len()) {
        return Err(beyond());
    }
    Ok((0..count).map(move |i| &data[i * stride..i * stride + size]))
}

/// An accessor of vectors of three or, for colours, four components. Whole numbers are fractions of their maximum.
fn vectors(accessor: &Accessor<'_>, buffers: &Buffers, is_color: bool) -> Result<Vec<DVec3>, SceneError> {
    let dimensions_fit =
        accessor.dimensions() == Dimensions::Vec3 || (is_color && accessor.dimensions() == Dimensions::Vec4);
    let component: fn(&[u8]) -> f64 = match accessor.data_type() {
        DataType::F32 => |b| f64::from(f32::from_le_bytes([b[0], b[1], b[2], b[3]])),
        DataType::U8 if is_color => |b| f64::from(b[0]) / 255.0,
        DataType::U16 if is_color => |b| f64::from(u16::from_le_bytes([b[0], b[1]])) / 65535.0,
        other => return Err(SceneError::new(format!("components of type {other:?} are not supported here"))),
    };
    if !dimensions_fit {
        let (index, found) = (accessor.index(), accessor.dimensions());
        return Err(SceneError::new(format!("accessor {index} should hold vectors of three, but holds {found:?}")));
    }
    let width = accessor.data_type().size();
    let vector = |bytes: &[u8]| DVec3::from_array([0, 1, 2].map(|i| component(&bytes[i * width..(i + 1) * width])));
    Ok(elements(accessor, buffers)?.map(vector).collect())
}

/// An accessor of vertex indices.
fn indices(accessor: &Accessor<'_>, buffers: &Buffers) -> Result<Vec<u32>, SceneError> {
    let index: fn(&[u8]) -> u32 = match (accessor.data_type(), accessor.dimensions()) {
        (DataType::U8, Dimensions::Scalar) => |b| b[0].into(),
        (DataType::U16, Dimensions::Scalar) => |b| u16::from_le_bytes([b[0], b[1]]).into(),
        (DataType::U32, Dimensions::Scalar) => |b| u32::from_le_bytes([b[0], b[1], b[2], b[3]]),
        (other, _) => return Err(SceneError::new(format!("vertex indices of type {other:?} are not supported"))),
    };
    Ok(elements(accessor, buffers)?.map(index).collect())
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A triangle in a GLB: three positions, then three indices; `node` is put into the node's JSON.
    fn glb(node: &str, material: &str, index_count: usize) -> Vec<u8> {
        let json = format!(
            r#"{{"asset":{{"version":"2.0"}},"scene":0,"scenes":[{{"nodes":[0]}}],"nodes":[{{"mesh":0{node}}}],"materials":[{{{material}}}],
            "meshes":[{{"primitives":[{{"attributes":{{"POSITION":0}},"indices":1,"material":0}}]}}],
            "accessors":[{{"bufferView":0,"componentType":5126,"count":3,"type":"VEC3","min":[0,0,0],"max":[1,1,0]}},
            {{"bufferView":1,"componentType":5123,"count":{index_count},"type":"SCALAR"}}],
            "bufferViews":[{{"buffer":0,"byteLength":36}},{{"buffer":0,"byteOffset":36,"byteLength":6}}],"buffers":[{{"byteLength":42}}]}}"#
        );
        let mut json = json.into_bytes();
        json.resize(json.len().next_multiple_of(4), b' ');
        let mut data: Vec<u8> =
            [0.0_f32, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0, 1.0, 0.0].iter().flat_map(|x| x.to_le_bytes()).collect();
        data.extend([0_u16, 1, 2, 0].iter().flat_map(|x| x.to_le_bytes()));
        let mut bytes = b"glTF".to_vec();
        bytes.extend(2_u32.to_le_bytes());
        bytes.extend((12 + 8 + json.len() as u32 + 8 + data.len() as u32).to_le_bytes());
        bytes.extend((json.len() as u32).to_le_bytes());
        bytes.extend(b"JSON");
        bytes.extend(&json);
        bytes.extend((data.len() as u32).to_le_bytes());
        bytes.extend(b"BIN\0");
        bytes.extend(&data);
        bytes
    }

    #[test]
    fn nodes_move_mirror_and_colour() {
        let material = r#""pbrMetallicRoughness":{"baseColorFactor":[0.5,0.25,1,1]}"#;
        let raw = parse(Path::new("x.glb"), &glb(r#","translation":[0,0,3],"scale":[-2,1,1]"#, material, 3)).unwrap();
        assert_eq!(raw.positions[1], Vec3::new(-2.0, 0.0, 3.0));
        assert_eq!(raw.triangles, [[0, 2, 1]]);
        assert_eq!(raw.colors[0], Vec3::new(0.5, 0.25, 1.0));
    }

    #[test]
    fn cut_anywhere_it_is_refused() {
        let bytes = glb("", "", 3);
        assert!(parse(Path::new("x.glb"), &bytes).is_ok());
        for end in 0..bytes.len() {
            assert!(parse(Path::new("x.glb"), &bytes[..end]).is_err(), "{end}");
        }
    }

    #[test]
    fn reaching_beyond_a_buffer_and_loops_are_refused() {
        let error = |bytes: &[u8]| parse(Path::new("x.glb"), bytes).unwrap_err().to_string();
        assert!(error(&glb("", "", 4)).contains("beyond its buffer"));
        assert!(error(&glb(r#","children":[0]"#, "", 3)).contains("ancestor"));
        assert!(check_uri("a%20b%FF.bin").is_err() && check_uri("a%20b%C3%A4.bin").is_ok());
    }
}
