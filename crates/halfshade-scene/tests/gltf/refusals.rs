//! Files that are no glTF 2.0, or damaged: errors say where, what and what to do, and no damage makes the reader panic.

use super::glb::{self, Builder};
use glam::Vec3;
use halfshade_scene::mesh::{self, Animation, Mesh};
use halfshade_scene::{Environment, SceneError, file};
use rand::{RngExt, SeedableRng};
use rand_pcg::Pcg64Mcg;
use std::time::{Duration, Instant};

const POSITIONS: &str = "AAAAAAAAAAAAAAAAAACAPwAAAAAAAAAAAACAPwAAgD8AAAAAAAAAAAAAgD8AAAAAAAABAAIAAAACAAMA";

/// The unit square as text, its buffer being `buffer`, with `more` beside the rest.
fn text(buffer: &str, more: &str) -> String {
    format!(
        r#"{{"asset":{{"version":"2.0"}},"scene":0,"scenes":[{{"nodes":[0]}}],"nodes":[{{"mesh":0}}],
        "meshes":[{{"primitives":[{{"attributes":{{"POSITION":0}},"indices":1}}]}}],
        "accessors":[{{"bufferView":0,"componentType":5126,"count":4,"type":"VEC3"}},
        {{"bufferView":1,"componentType":5123,"count":6,"type":"SCALAR"}}],
        "bufferViews":[{{"buffer":0,"byteLength":48}},{{"buffer":0,"byteOffset":48,"byteLength":12}}],
        "buffers":[{{"byteLength":60{buffer}}}]{more}}}"#
    )
}

fn inline() -> String {
    text(&format!(r#","uri":"data:application/octet-stream;base64,{POSITIONS}""#), "")
}

fn load(name: &str, bytes: &[u8]) -> Result<Mesh, SceneError> {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join(name);
    std::fs::write(&path, bytes).unwrap();
    let result = mesh::load(&path);
    if let Err(error) = &result {
        assert!(error.to_string().starts_with(&path.display().to_string()), "{error}");
    }
    result
}

fn assert_refused(bytes: &[u8], parts: &[&str]) {
    let error = load("x.gltf", bytes).unwrap_err();
    let text = error.to_string();
    assert!(parts.iter().all(|part| text.contains(part)), "{parts:?}: {text}");
    assert!(error.remedy.is_some(), "{text}");
}

fn is_square(mesh: &Mesh) -> bool {
    mesh.triangles.len() == 2 && mesh.positions.contains(&Vec3::new(1.0, 1.0, 0.0))
}

#[test]
fn marks_and_zeros_around_the_document_are_no_part_of_it() {
    assert!(is_square(&load("x.gltf", inline().as_bytes()).unwrap()));
    assert!(is_square(&load("x.gltf", format!("\u{feff}{}", inline()).as_bytes()).unwrap()));
    let data: Vec<u8> = [0.0_f32, 0.0, 0.0, 1.0, 0.0, 0.0, 1.0, 1.0, 0.0, 0.0, 1.0, 0.0]
        .iter()
        .flat_map(|x| x.to_le_bytes())
        .chain([0, 0, 1, 0, 2, 0, 0, 0, 2, 0, 3, 0])
        .collect();
    let mut json = text("", "");
    json.push_str(&"\0".repeat(4 - json.len() % 4));
    assert!(is_square(&load("x.glb", &glb::glb(&json, &data)).unwrap()));
}

#[test]
fn what_is_missing_or_damaged_is_named() {
    let data = |digits: &str| text(&format!(r#","uri":"data:application/octet-stream;base64,{digits}""#), "");
    let replaced = |from: &str, to: &str| {
        let whole = inline();
        assert!(whole.contains(from), "{from}");
        whole.replacen(from, to, 1)
    };
    for (document, parts) in [
        (text(r#","uri":"missing data.bin""#, ""), &["buffer 0 (`missing data.bin`)", "cannot be read", ".glb"][..]),
        (text(r#","uri":"https://example.org/a.bin""#, ""), &["buffer 0", "`https:` is not fetched"]),
        (text("", ""), &["buffer 0 has no data", "binary chunk"]),
        (data("A*AA"), &["buffer 0 (a data URI)", "cannot be read"]),
        // Two bytes short, which filling up to four would hide.
        (data(&format!("{}A==", &POSITIONS[..77])), &["buffer 0 (a data URI) has 58 bytes, but 60 are declared"]),
        (replaced(r#""version":"2.0""#, r#""version":"1.0""#), &["glTF 1.0", "only glTF 2.0", "convert"]),
        (replaced(r#""version":"2.0""#, r#""version":"2.0","minVersion":"3.1""#), &["glTF 3.1"]),
        (r#"{"asset":{"version":"1.1"},"meshes":{"a":{}},"scene":"s"}"#.to_owned(), &["glTF 1.1", "convert"]),
        (replaced(r#""count":4"#, r#""count":4000000000"#), &["accessor 0 reaches beyond its buffer"]),
        (replaced(r#""count":6"#, r#""count":7"#), &["accessor 1 reaches beyond its buffer"]),
        (replaced(r#""count":4"#, r#""count":3"#), &["vertex 3 is named, but there are only 3"]),
        (replaced(r#""mesh":0"#, r#""mesh":0,"children":[0]"#), &["node 0", "its own ancestor"]),
        (replaced(r#""bufferView":0,"#, ""), &["no triangle of the mesh has an area"]),
        (replaced(r#""asset""#, r#""asset"#), &["no valid glTF"]),
        (replaced("AAAAAAAA", "AADAfwAA"), &["mesh 0", "POSITION", "not finite"]),
    ] {
        let error = load("x.gltf", document.as_bytes()).unwrap_err().to_string();
        assert!(parts.iter().all(|part| error.contains(part)), "{parts:?}: {error}");
        if !error.contains("no triangle") {
            assert_refused(document.as_bytes(), parts);
        }
    }
    let zeros =
        replaced(r#""bufferView":0,"componentType":5126,"count":4"#, r#""componentType":5126,"count":4000000000"#);
    assert!(load("x.gltf", zeros.as_bytes()).unwrap_err().to_string().contains("at most"));
    let utf16: Vec<u8> = [0xfeff].into_iter().chain(inline().encode_utf16()).flat_map(u16::to_le_bytes).collect();
    assert_refused(&utf16, &["UTF-16", "UTF-8"]);
    let mut first = glb::glb(&text("", ""), &[0; 60]);
    first[4] = 1;
    assert!(load("x.glb", &first).unwrap_err().to_string().contains("glTF 1 (binary)"));
}

#[test]
fn what_compresses_or_is_required_is_named_first() {
    let draco = r#","extensions":{"KHR_draco_mesh_compression":{"bufferView":0,"attributes":{"POSITION":0}}}"#;
    let without_data = inline()
        .replace(r#""bufferView":0,"componentType""#, r#""componentType""#)
        .replace(r#""indices":1"#, &format!(r#""indices":1{draco}"#));
    assert_refused(without_data.as_bytes(), &["compressed with KHR_draco_mesh_compression", "decompress"]);
    // Where the data is there in plain, too, it is read.
    let beside = inline().replace(r#""indices":1"#, &format!(r#""indices":1{draco}"#));
    assert!(is_square(&load("x.gltf", beside.as_bytes()).unwrap()));
    for name in ["KHR_draco_mesh_compression", "EXT_meshopt_compression", "ACME_shape"] {
        let required = text(r#","uri":"none.bin""#, &format!(r#","extensionsRequired":["{name}"]"#));
        assert_refused(required.as_bytes(), &[name]);
    }
    let fallback = r#","extensions":{"EXT_meshopt_compression":{"fallback":true}}"#;
    assert_refused(text(fallback, "").as_bytes(), &["compressed with EXT_meshopt_compression"]);
}

/// Small documents that use all that is read.
fn corpus() -> Vec<Vec<u8>> {
    let mut builder = Builder::default();
    builder.floats("VEC3", &[0.0, 0.0, 0.0, 1.0, 0.0, 0.0, 1.0, 1.0, 0.0, 0.0, 1.0, 0.0]);
    builder.indices(&[0, 1, 2, 0, 2, 3]);
    builder.floats("VEC2", &[0.0, 0.0, 1.0, 0.0, 1.0, 1.0, 0.0, 1.0]);
    builder.floats("VEC4", &[1.0, 0.5, 0.25, 0.75].repeat(4));
    builder.list("VEC4", 5121, 4, &[0, 1, 0, 0].repeat(4), "");
    builder.floats("VEC4", &[0.5, 0.5, 0.0, 0.0].repeat(4));
    builder.floats("VEC3", &[0.0, 0.0, 0.5].repeat(4));
    builder.floats("SCALAR", &[0.0, 1.0]);
    builder.floats("SCALAR", &[0.0, 1.0]);
    builder.floats("VEC3", &[0.0, 0.0, 0.0, 0.0, 4.0, 0.0]);
    let (places, values) = (builder.view(&[1]), builder.view(&[0; 12]));
    builder.accessor(format!(
        r#"{{"componentType":5126,"count":4,"type":"VEC3","sparse":{{"count":1,"indices":{{"bufferView":{places},"componentType":5121}},"values":{{"bufferView":{values}}}}}}}"#
    ));
    let mut png = std::io::Cursor::new(Vec::new());
    let image = image::RgbaImage::from_fn(2, 2, |x, y| image::Rgba([255, 0, 9, if x == y { 255 } else { 0 }]));
    image.write_to(&mut png, image::ImageFormat::Png).unwrap();
    let view = builder.view(&png.into_inner());
    let material = format!(
        r#""materials":[{{"pbrMetallicRoughness":{{"baseColorTexture":{{"index":0,"extensions":{{"KHR_texture_transform":{{"scale":[2,2]}}}}}}}},
        "alphaMode":"MASK"}}],"textures":[{{"source":0}}],"images":[{{"bufferView":{view},"mimeType":"image/png"}}]"#
    );
    let scene = r#""scene":0,"scenes":[{"nodes":[0]}]"#;
    let skinned = format!(
        r#"{scene},"nodes":[{{"children":[1,2,3]}},{{"mesh":0,"skin":0,"weights":[0.5,1]}},{{"translation":[0,1,0]}},{{"scale":[2,2,2]}}],
        "skins":[{{"joints":[2,3]}}],{material},"meshes":[{{"primitives":[{{"attributes":{{"POSITION":0,"TEXCOORD_0":2,"COLOR_0":3,
        "JOINTS_0":4,"WEIGHTS_0":5}},"indices":1,"material":0,"targets":[{{"POSITION":6}},{{"POSITION":10}}]}}]}}],
        "animations":[{{"samplers":[{{"input":7,"output":9}}],"channels":[{{"sampler":0,"target":{{"node":2,"path":"translation"}}}}]}}]"#
    );
    let copies = format!(
        r#"{scene},"nodes":[{{"mesh":0,"extensions":{{"EXT_mesh_gpu_instancing":{{"attributes":{{"TRANSLATION":6,"ROTATION":5}}}}}}}}],
        {material},"meshes":[{{"weights":[1],"primitives":[{{"attributes":{{"POSITION":0,"NORMAL":6}},"indices":1,"mode":5,"targets":[{{"POSITION":6,"NORMAL":10}}]}}]}}],
        "animations":[{{"samplers":[{{"input":7,"output":8,"interpolation":"STEP"}}],"channels":[{{"sampler":0,"target":{{"node":0,"path":"weights"}}}}]}}]"#
    );
    let staged = format!(
        r#"{scene},"nodes":[{{"mesh":0,"camera":0,"children":[1]}},{{"mesh":0,"extensions":{{"KHR_lights_punctual":{{"light":0}}}}}}],
        "meshes":[{{"primitives":[{{"attributes":{{"POSITION":0}},"indices":1}}]}}],"cameras":[{{"type":"perspective","perspective":{{"yfov":0.5,"znear":0.1}}}}],
        "extensions":{{"KHR_lights_punctual":{{"lights":[{{"type":"point","intensity":9,"color":[1,0.5,0]}}]}}}},
        "animations":[{{"samplers":[{{"input":7,"output":9}}],"channels":[{{"sampler":0,"target":{{"node":0,"path":"translation"}}}},
        {{"sampler":0,"target":{{"node":1,"path":"translation"}}}}]}}]"#
    );
    vec![builder.glb(&skinned), builder.glb(&copies), inline().into_bytes(), builder.glb(&staged)]
}

/// `HALFSHADE_FUZZ_SECS` sets how long; three seconds without.
#[test]
fn no_damage_makes_the_reader_panic_or_hang() {
    let corpus = corpus();
    let folder = tempfile::tempdir().unwrap();
    let paths = ["x.glb", "x.glb", "x.gltf", "x.glb"].map(|name| folder.path().join(name));
    for (bytes, path) in corpus.iter().zip(&paths) {
        std::fs::write(path, bytes).unwrap();
        mesh::load(path).unwrap_or_else(|error| panic!("{error}"));
    }
    let seconds = std::env::var("HALFSHADE_FUZZ_SECS").ok().and_then(|text| text.parse().ok()).unwrap_or(3);
    let end = Instant::now() + Duration::from_secs(seconds);
    let mut random = Pcg64Mcg::seed_from_u64(17);
    let mut slowest = Duration::ZERO;
    while Instant::now() < end {
        let number = random.random_range(0..corpus.len());
        let mut bytes = corpus[number].clone();
        for _ in 0..random.random_range(1..6) {
            let place = random.random_range(0..bytes.len());
            match random.random_range(0..6_u8) {
                0 => bytes[place] = random.random(),
                1 => bytes[place] ^= 1 << random.random_range(0..8_u8),
                2 if bytes.len() > 100 => {
                    drop(bytes.drain(place..(place + random.random_range(1..9)).min(bytes.len())))
                }
                3 => bytes.insert(place, b'0' + random.random_range(0..10)),
                _ => {
                    // A digit for a digit: plausible numbers that are wrong.
                    if let Some(digit) = bytes[place..].iter_mut().find(|byte| byte.is_ascii_digit()) {
                        *digit = b'0' + random.random_range(0..10);
                    }
                }
            }
        }
        std::fs::write(&paths[number], &bytes).unwrap();
        let start = Instant::now();
        let still = mesh::load(&paths[number]);
        let moving = mesh::load_animated(&paths[number], &Animation::Number(0));
        let scene = file::from_mesh(&paths[number], Some(Environment::constant(glam::Vec3::ONE)));
        slowest = slowest.max(start.elapsed());
        if let Ok(scene) = scene {
            let poses = scene.frame(scene.frame_count - 1).world_from_object;
            assert!(poses.iter().all(|pose| pose.translation.is_finite() && pose.scale > 0.0));
            assert!(scene.lights.iter().all(|(light, _)| light.radiance.is_finite() && light.radius > 0.0));
        }
        for mesh in still.iter().chain(moving.iter().map(|(mesh, _)| mesh)) {
            assert!(mesh.positions.iter().chain(&mesh.normals).chain(&mesh.colors).all(|p| p.is_finite()));
            assert!(
                (0..mesh.triangles.len())
                    .all(|t| !mesh.is_cut_out(t, glam::DVec3::splat(1.0 / 3.0)) || mesh.has_cutouts())
            );
        }
        if let Ok((mesh, Some(skin))) = &moving {
            let deformed = skin.deform(mesh, 0.3);
            assert!(deformed.positions.iter().chain(&deformed.normals).all(|p| p.is_finite()));
        }
    }
    assert!(slowest < Duration::from_secs(5), "{slowest:?}");
}
