//! glTF 2.0 and GLB, read with `gltf`.
//!
//! The crate checks the document's structure; the bytes of vertices and indices are read here with every offset
//! checked, because the crate's own readers trust types and counts.

mod numbers;
mod skeleton;
mod track;

use super::assemble::RawMesh;
use super::load::Animation;
use crate::texture::Wrap;
use crate::{Joint, SceneError, Texture};
use ::gltf::accessor::{DataType, Dimensions};
use ::gltf::image::Source;
use ::gltf::mesh::Mode;
use ::gltf::texture::WrappingMode;
use ::gltf::{Accessor, Document, Gltf, Node, Primitive, Semantic};
use glam::{DMat3, DMat4, DVec2, DVec3, Vec3};
use skeleton::Skeleton;
use std::collections::HashMap;
use std::path::Path;
use std::sync::Arc;

type Buffers = Vec<::gltf::buffer::Data>;

/// The mesh as the document has it, at rest.
pub(super) fn parse(path: &Path, bytes: &[u8]) -> Result<RawMesh, SceneError> {
    let (document, buffers) = read(path, bytes)?;
    collect(&document, &buffers, path, None)
}

/// The mesh and the joints that an animation moves, on which the vertices hang as its influences say.
pub(super) fn parse_animated(
    path: &Path,
    bytes: &[u8],
    animation: &Animation,
) -> Result<(RawMesh, Vec<Joint>), SceneError> {
    let (document, buffers) = read(path, bytes)?;
    let mut skeleton = Skeleton::new(&document, &buffers, animation)?;
    let raw = collect(&document, &buffers, path, Some(&mut skeleton))?;
    if !skeleton.has_skin() {
        return Err(SceneError::new("it has no skin that an animation could deform")
            .with_remedy("leave `animation` out; an object as a whole moves by `keyframe`"));
    }
    Ok((raw, skeleton.into_joints()))
}

/// The document, checked, and its buffers.
fn read(path: &Path, bytes: &[u8]) -> Result<(Document, Buffers), SceneError> {
    if bytes.starts_with(b"glTF") {
        check_length(bytes)?;
    }
    let wrong = |error: ::gltf::Error| SceneError::new(format!("this is no valid glTF: {error}"));
    let Gltf { document, blob } = Gltf::from_slice_without_validation(bytes).map_err(wrong)?;
    let json = document.into_json();
    check_positions(&json)?;
    let document = Document::from_json(json).map_err(wrong)?;
    let folder = path.parent().unwrap_or(Path::new(""));
    for buffer in document.buffers() {
        if let ::gltf::buffer::Source::Uri(uri) = buffer.source() {
            record(uri, folder)?;
        }
    }
    let buffers = ::gltf::import_buffers(&document, Some(folder), blob)
        .map_err(|error| SceneError::new(format!("a buffer cannot be read: {error}")))?;
    Ok((document, buffers))
}

/// All meshes of the document's scene as one; with a skeleton, with what moves each vertex.
fn collect(
    document: &Document,
    buffers: &Buffers,
    path: &Path,
    mut skeleton: Option<&mut Skeleton<'_>>,
) -> Result<RawMesh, SceneError> {
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
    let folder = path.parent().unwrap_or(Path::new(""));
    let mut textures = Textures { folder, list: Vec::new(), number_of: HashMap::new() };
    let mut seen = vec![false; document.nodes().len()];
    while let Some((node, world_from_parent)) = stack.pop() {
        if std::mem::replace(&mut seen[node.index()], true) {
            return Err(SceneError::new(format!("node {} has two parents or is its own ancestor", node.index())));
        }
        let local = node.transform().matrix().map(|column| column.map(f64::from));
        let world_from_node = world_from_parent * DMat4::from_cols_array_2d(&local);
        if let Some(mesh) = node.mesh() {
            let about = |error: SceneError| {
                let name = mesh.name().map_or_else(|| mesh.index().to_string(), |name| format!("`{name}`"));
                SceneError { problem: format!("mesh {name}: {}", error.problem), ..error }
            };
            let bound = skeleton.as_mut().map(|skeleton| skeleton.bind(&node)).transpose().map_err(about)?;
            let world_from_mesh = bound.map_or(world_from_node, |(_, world_from_mesh)| world_from_mesh);
            for primitive in mesh.primitives() {
                let before = raw.positions.len();
                append(&primitive, buffers, world_from_mesh, &mut textures, &mut raw).map_err(about)?;
                let added = raw.positions.len() - before;
                if let (Some(skeleton), Some((binding, _)), 1..) = (skeleton.as_mut(), bound, added) {
                    raw.influences.extend(skeleton.influences(binding, &primitive, added).map_err(about)?);
                }
            }
        }
        let first_child = stack.len();
        stack.extend(node.children().map(|child| (child, world_from_node)));
        stack[first_child..].reverse();
    }
    if textures.number_of.keys().any(Option::is_some) {
        raw.textures = textures.list;
    } else {
        raw.texture_coordinates.iter_mut().for_each(|place| place.z = 0.0);
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

/// Tells of a file that the crate is about to read itself. What can't be read is left to its error.
fn record(uri: &str, folder: &Path) -> Result<(), SceneError> {
    let Some(name) = file_name(uri)? else { return Ok(()) };
    let _ = crate::input::read(&folder.join(name));
    Ok(())
}

/// The file that a URI names, as the crate understands it; nothing if it holds the data itself.
///
/// Percent escapes of a file name must spell UTF-8: the crate takes it for granted.
fn file_name(uri: &str) -> Result<Option<String>, SceneError> {
    if uri.starts_with("data:") {
        return Ok(None);
    }
    if let Some(path) = uri.strip_prefix("file:") {
        return Ok(Some(path.strip_prefix("//").unwrap_or(path).to_owned()));
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
    let name = String::from_utf8(decoded);
    name.map(Some).map_err(|_| SceneError::new(format!("the file name `{uri}` is not UTF-8")))
}

/// The base colour textures met so far, by number.
struct Textures<'a> {
    /// Where files are that the document names.
    folder: &'a Path,
    list: Vec<Arc<Texture>>,
    /// The place in `list` of each texture of the document; of `None`, that of a white one, for parts without.
    number_of: HashMap<Option<usize>, usize>,
}

impl Textures<'_> {
    /// The number of a texture, which is read when first asked for.
    fn number(&mut self, texture: Option<::gltf::Texture<'_>>, buffers: &Buffers) -> Result<usize, SceneError> {
        let key = texture.as_ref().map(::gltf::Texture::index);
        if let Some(number) = self.number_of.get(&key) {
            return Ok(*number);
        }
        let texture = match texture {
            None => Texture::new(1, 1, vec![Vec3::ONE])?,
            Some(texture) => {
                let wrap = |mode| match mode {
                    WrappingMode::ClampToEdge => Wrap::Clamp,
                    WrappingMode::MirroredRepeat => Wrap::Mirror,
                    WrappingMode::Repeat => Wrap::Repeat,
                };
                let (image, sampler) = (texture.source(), texture.sampler());
                let decoded = image_bytes(image.source(), self.folder, buffers).and_then(|b| Texture::decode(&b));
                let decoded = decoded.map_err(|error| SceneError {
                    problem: format!("image {}: {}", image.index(), error.problem),
                    ..error
                })?;
                decoded.wrapped([wrap(sampler.wrap_s()), wrap(sampler.wrap_t())])
            }
        };
        self.list.push(Arc::new(texture));
        self.number_of.insert(key, self.list.len() - 1);
        Ok(self.list.len() - 1)
    }
}

/// An encoded image: a view of a buffer, a data URI, or a file beside the document.
fn image_bytes(source: Source<'_>, folder: &Path, buffers: &Buffers) -> Result<Vec<u8>, SceneError> {
    match source {
        Source::View { view, .. } => view_bytes(&view, buffers)
            .map(<[u8]>::to_vec)
            .ok_or_else(|| SceneError::new("it reaches beyond its buffer")),
        Source::Uri { uri, .. } => {
            record(uri, folder)?;
            let read = ::gltf::buffer::Data::from_source(::gltf::buffer::Source::Uri(uri), Some(folder));
            read.map(|data| data.0).map_err(|error| {
                let name = if uri.starts_with("data:") { "its data URI" } else { uri };
                SceneError::new(format!("{name} cannot be read: {error}"))
            })
        }
    }
}

/// The part of a buffer that a view names; `None` if it lies beyond.
fn view_bytes<'a>(view: &::gltf::buffer::View<'_>, buffers: &'a Buffers) -> Option<&'a [u8]> {
    let data = buffers.get(view.buffer().index())?;
    data.get(view.offset()..view.offset().checked_add(view.length())?)
}

/// Adds a primitive, moved to its place.
fn append(
    primitive: &Primitive<'_>,
    buffers: &Buffers,
    world_from_node: DMat4,
    textures: &mut Textures<'_>,
    raw: &mut RawMesh,
) -> Result<(), SceneError> {
    if !matches!(primitive.mode(), Mode::Triangles | Mode::TriangleStrip | Mode::TriangleFan) {
        return Ok(());
    }
    let Some(accessor) = primitive.get(&Semantic::Positions) else {
        return Err(SceneError::new("a primitive has no positions"));
    };
    let positions = vectors(&accessor, buffers, Meaning::Place)?;
    let of_length = |list: Vec<DVec3>, what: &str| {
        if list.len() == positions.len() {
            Ok(list)
        } else {
            Err(SceneError::new(format!("{} {what} for {} positions", list.len(), positions.len())))
        }
    };
    let normals = match primitive.get(&Semantic::Normals) {
        Some(accessor) => of_length(vectors(&accessor, buffers, Meaning::Place)?, "normals")?,
        None => vec![DVec3::ZERO; positions.len()],
    };
    let surface = primitive.material().pbr_metallic_roughness();
    let factor = surface.base_color_factor();
    let factor = Vec3::from_slice(&factor).as_dvec3();
    let colors = match primitive.get(&Semantic::Colors(0)) {
        Some(accessor) => of_length(vectors(&accessor, buffers, Meaning::Color)?, "colours")?,
        None => vec![DVec3::ONE; positions.len()],
    };
    let texture = surface.base_color_texture();
    let transform = texture.as_ref().and_then(|info| info.texture_transform());
    let set = texture.as_ref().map_or(0, |info| info.tex_coord());
    let set = transform.as_ref().and_then(|transform| transform.tex_coord()).unwrap_or(set);
    let mut coordinates = match primitive.get(&Semantic::TexCoords(set)) {
        Some(accessor) => of_length(vectors(&accessor, buffers, Meaning::Coordinate)?, "texture coordinates")?,
        None if texture.is_some() => {
            return Err(SceneError::new(format!("a primitive has a texture, but no TEXCOORD_{set}")));
        }
        None => Vec::new(),
    };
    if let Some(transform) = transform {
        let (offset, scale) = (DVec2::from(transform.offset().map(f64::from)), transform.scale().map(f64::from));
        let (sin, cos) = f64::from(transform.rotation()).sin_cos();
        for place in &mut coordinates {
            let scaled = place.truncate() * DVec2::from(scale);
            let turned = DVec2::new(cos * scaled.x + sin * scaled.y, cos * scaled.y - sin * scaled.x);
            *place = (offset + turned).extend(0.0);
        }
    }
    let indices = match primitive.indices() {
        Some(accessor) => indices(&accessor, buffers)?,
        None => (0..positions.len() as u32).collect(),
    };
    if let Some(index) = indices.iter().find(|&&index| index as usize >= positions.len()) {
        return Err(SceneError::new(format!("vertex {index} is named, but there are only {}", positions.len())));
    }

    let offset = raw.positions.len() as u32;
    if !coordinates.is_empty() || !raw.texture_coordinates.is_empty() {
        // Parts of the file without coordinates have (0, 0) of the white texture.
        let white = if texture.is_none() || raw.texture_coordinates.len() < raw.positions.len() {
            textures.number(None, buffers)? as f64
        } else {
            0.0
        };
        let number = match texture {
            Some(info) => textures.number(Some(info.texture()), buffers)? as f64,
            None => white,
        };
        raw.texture_coordinates.resize(raw.positions.len(), Vec3::new(0.0, 0.0, white as f32));
        coordinates.resize(positions.len(), DVec3::ZERO);
        raw.texture_coordinates.extend(coordinates.iter().map(|c| c.truncate().extend(number).as_vec3()));
    }
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
    let data = view_bytes(&view, buffers).and_then(|data| data.get(accessor.offset()..)).ok_or_else(beyond)?;
    let needed = count.checked_sub(1).map_or(Some(0), |n| n.checked_mul(stride)?.checked_add(size));
    if needed.is_none_or(|needed| needed > data.len()) {
        return Err(beyond());
    }
    Ok((0..count).map(move |i| &data[i * stride..i * stride + size]))
}

/// What an accessor of vectors is read for.
#[derive(Debug, Clone, Copy, PartialEq)]
enum Meaning {
    /// A position or a normal: three components.
    Place,
    /// A colour: three components, or four, the last of which is dropped.
    Color,
    /// A texture coordinate: two components, and 0.
    Coordinate,
}

/// An accessor of vectors. Whole numbers, which places can't be, are fractions of their maximum.
fn vectors(accessor: &Accessor<'_>, buffers: &Buffers, meaning: Meaning) -> Result<Vec<DVec3>, SceneError> {
    let fraction = meaning != Meaning::Place;
    let component: fn(&[u8]) -> f64 = match accessor.data_type() {
        DataType::F32 => |b| f64::from(f32::from_le_bytes([b[0], b[1], b[2], b[3]])),
        DataType::U8 if fraction => |b| f64::from(b[0]) / 255.0,
        DataType::U16 if fraction => |b| f64::from(u16::from_le_bytes([b[0], b[1]])) / 65535.0,
        other => return Err(SceneError::new(format!("components of type {other:?} are not supported here"))),
    };
    let count = match (meaning, accessor.dimensions()) {
        (Meaning::Coordinate, Dimensions::Vec2) => 2,
        (Meaning::Place | Meaning::Color, Dimensions::Vec3) | (Meaning::Color, Dimensions::Vec4) => 3,
        (_, found) => {
            let (index, wanted) = (accessor.index(), if meaning == Meaning::Coordinate { "two" } else { "three" });
            return Err(SceneError::new(format!(
                "accessor {index} should hold vectors of {wanted}, but holds {found:?}"
            )));
        }
    };
    let width = accessor.data_type().size();
    let vector = |bytes: &[u8]| {
        DVec3::from_array([0, 1, 2].map(|i| if i < count { component(&bytes[i * width..]) } else { 0.0 }))
    };
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
        glb_of(
            &format!(
                r#"{{"asset":{{"version":"2.0"}},"scene":0,"scenes":[{{"nodes":[0]}}],"nodes":[{{"mesh":0{node}}}],"materials":[{{{material}}}],
            "meshes":[{{"primitives":[{{"attributes":{{"POSITION":0}},"indices":1,"material":0}}]}}],
            "accessors":[{{"bufferView":0,"componentType":5126,"count":3,"type":"VEC3","min":[0,0,0],"max":[1,1,0]}},
            {{"bufferView":1,"componentType":5123,"count":{index_count},"type":"SCALAR"}}],
            "bufferViews":[{{"buffer":0,"byteLength":36}},{{"buffer":0,"byteOffset":36,"byteLength":6}}],"buffers":[{{"byteLength":42}}]}}"#
            ),
            &triangle_data(),
        )
    }

    fn triangle_data() -> Vec<u8> {
        let positions = [0.0_f32, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0, 1.0, 0.0];
        let indices = [0_u16, 1, 2, 0];
        positions.iter().flat_map(|x| x.to_le_bytes()).chain(indices.iter().flat_map(|x| x.to_le_bytes())).collect()
    }

    fn glb_of(json: &str, data: &[u8]) -> Vec<u8> {
        let mut json = json.as_bytes().to_vec();
        json.resize(json.len().next_multiple_of(4), b' ');
        let mut bytes = b"glTF".to_vec();
        bytes.extend(2_u32.to_le_bytes());
        bytes.extend((12 + 8 + json.len() as u32 + 8 + data.len() as u32).to_le_bytes());
        bytes.extend((json.len() as u32).to_le_bytes());
        bytes.extend(b"JSON");
        bytes.extend(&json);
        bytes.extend((data.len() as u32).to_le_bytes());
        bytes.extend(b"BIN\0");
        bytes.extend(data);
        bytes
    }

    /// A PNG of two columns, red and blue.
    fn red_and_blue() -> Vec<u8> {
        let mut bytes = std::io::Cursor::new(Vec::new());
        let image = image::RgbImage::from_fn(2, 1, |x, _| image::Rgb(if x == 0 { [255, 0, 0] } else { [0, 0, 255] }));
        image.write_to(&mut bytes, image::ImageFormat::Png).unwrap();
        bytes.into_inner()
    }

    /// Two triangles, the first textured by `image` (a JSON object's inside) as `info` adds to its texture's reference.
    fn textured(image: &str, info: &str, png: &[u8]) -> Vec<u8> {
        let mut data = triangle_data();
        data.extend([0.25_f32, 0.5, 0.75, 0.5, 1.25, 0.5].iter().flat_map(|x| x.to_le_bytes()));
        data.extend(png);
        data.resize(data.len().next_multiple_of(4), 0);
        glb_of(
            &format!(
                r#"{{"asset":{{"version":"2.0"}},"scene":0,"scenes":[{{"nodes":[0]}}],"nodes":[{{"mesh":0}}],
            "materials":[{{"pbrMetallicRoughness":{{"baseColorTexture":{{"index":0{info}}}}}}}],
            "textures":[{{"source":0,"sampler":0}}],"samplers":[{{"wrapS":33071,"wrapT":33648}}],"images":[{{{image}}}],
            "meshes":[{{"primitives":[{{"attributes":{{"POSITION":0}},"indices":1}},
            {{"attributes":{{"POSITION":0,"TEXCOORD_0":2}},"indices":1,"material":0}}]}}],
            "accessors":[{{"bufferView":0,"componentType":5126,"count":3,"type":"VEC3","min":[0,0,0],"max":[1,1,0]}},
            {{"bufferView":1,"componentType":5123,"count":3,"type":"SCALAR"}},
            {{"bufferView":2,"componentType":5126,"count":3,"type":"VEC2"}}],
            "bufferViews":[{{"buffer":0,"byteLength":36}},{{"buffer":0,"byteOffset":36,"byteLength":6}},
            {{"buffer":0,"byteOffset":44,"byteLength":24}},{{"buffer":0,"byteOffset":68,"byteLength":{}}}],
            "buffers":[{{"byteLength":{}}}]}}"#,
                png.len(),
                data.len()
            ),
            &data,
        )
    }

    const EMBEDDED: &str = r#""bufferView":3,"mimeType":"image/png""#;

    /// What the texture of each vertex says there.
    fn colors_of(raw: &RawMesh) -> Vec<Vec3> {
        let color = |c: &Vec3| raw.textures[c.z as usize].at(c.truncate().as_dvec2());
        raw.texture_coordinates.iter().map(color).collect()
    }

    #[test]
    fn an_embedded_texture_wraps_as_its_sampler_says_and_other_parts_stay_white() {
        let raw = parse(Path::new("x.glb"), &textured(EMBEDDED, "", &red_and_blue())).unwrap();
        assert_eq!(raw.positions.len(), 6);
        // Clamped: beyond the right edge it stays blue, where a repeating texture would be red again.
        assert_eq!(colors_of(&raw), [Vec3::ONE, Vec3::ONE, Vec3::ONE, Vec3::X, Vec3::Z, Vec3::Z]);
    }

    #[test]
    fn a_texture_transform_moves_coordinates() {
        let info = r#","extensions":{"KHR_texture_transform":{"offset":[1,0.25],"scale":[1,2],"rotation":1.5707963}}"#;
        let raw = parse(Path::new("x.glb"), &textured(EMBEDDED, info, &red_and_blue())).unwrap();
        // (u, v) → (1, 1/4) + (2 v, -u), a quarter turn of (u, 2 v).
        let expected = Vec3::new(1.0 + 1.0, 0.25 - 0.75, raw.texture_coordinates[4].z);
        assert!(raw.texture_coordinates[4].distance(expected) < 1e-6, "{:?}", raw.texture_coordinates);
    }

    #[test]
    fn images_come_from_data_uris_and_files_and_wrong_ones_are_named() {
        let folder = tempfile::tempdir().unwrap();
        std::fs::write(folder.path().join("a b.png"), red_and_blue()).unwrap();
        let read =
            |image: &str, info: &str, png: &[u8]| parse(&folder.path().join("x.glb"), &textured(image, info, png));
        let beside = read(r#""uri":"a%20b.png""#, "", &[]).unwrap();
        assert_eq!(colors_of(&beside)[3..], [Vec3::X, Vec3::Z, Vec3::Z]);
        // One white pixel.
        let uri = "data:image/png;base64,iVBORw0KGgoAAAANSUhEUgAAAAEAAAABCAAAAAA6fptVAAAACklEQVR4nGP4DwABAQEAsTj2FAAAAABJRU5ErkJggg==";
        let data = read(&format!(r#""uri":"{uri}""#), "", &[]).unwrap();
        assert_eq!(colors_of(&data), [Vec3::ONE; 6]);

        let error = |image: &str, info: &str, png: &[u8]| read(image, info, png).unwrap_err().to_string();
        assert!(error(r#""uri":"none.png""#, "", &[]).contains("none.png cannot be read"));
        assert!(error(r#""uri":"data:image/png;base64,*""#, "", &[]).contains("data URI"));
        assert!(error(EMBEDDED, "", &red_and_blue()[..40]).contains("image 0"));
        assert!(error(r#""bufferView":3,"mimeType":"image/webp""#, "", b"RIFF").contains("PNG"));
        assert!(error(EMBEDDED, r#","texCoord":1"#, &red_and_blue()).contains("TEXCOORD_1"));
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
