//! Documents in small GLB files.

use super::*;
use glam::Vec3;

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

/// Colour of each vertex by its texture.
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
    let read = |image: &str, info: &str, png: &[u8]| parse(&folder.path().join("x.glb"), &textured(image, info, png));
    let beside = read(r#""uri":"a%20b.png""#, "", &[]).unwrap();
    assert_eq!(colors_of(&beside)[3..], [Vec3::X, Vec3::Z, Vec3::Z]);
    // One white pixel.
    let uri = "data:image/png;base64,iVBORw0KGgoAAAANSUhEUgAAAAEAAAABCAAAAAA6fptVAAAACklEQVR4nGP4DwABAQEAsTj2FAAAAABJRU5ErkJggg==";
    let data = read(&format!(r#""uri":"{uri}""#), "", &[]).unwrap();
    assert_eq!(colors_of(&data), [Vec3::ONE; 6]);

    let error = |image: &str, info: &str, png: &[u8]| read(image, info, png).unwrap_err().to_string();
    assert!(error(r#""uri":"none.png""#, "", &[]).contains("image 0 (`none.png`) cannot be read"));
    assert!(error(r#""uri":"data:image/png;base64,*""#, "", &[]).contains("data URI"));
    assert!(error(EMBEDDED, "", &red_and_blue()[..40]).contains("image 0"));
    assert!(error(r#""bufferView":3,"mimeType":"image/webp""#, "", b"RIFF").contains("PNG"));
    assert!(error(r#""bufferView":3"#, "", &red_and_blue()).contains("doesn't say as what"));
    assert!(error(r#""name":"x""#, "", &red_and_blue()).contains("neither a file nor"));
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
}
