//! Damaged files: whatever the bytes, loaders answer with a mesh, a map or an error, and never panic.

use super::gltf::glb;
use glam::Vec3;
use halfshade_scene::light::{ProbeOptions, Projection, load_probe};
use halfshade_scene::{SceneError, Texture, builtin, file, mesh};
use proptest::prelude::*;
use std::fmt::Write as _;
use std::path::{Path, PathBuf};
use std::sync::LazyLock;

/// A tetrahedron in every mesh format, a small probe in every image format, and a scene: name and bytes.
static SOUND: LazyLock<Vec<(&'static str, Vec<u8>)>> = LazyLock::new(|| {
    let (positions, triangles) = tetrahedron();
    let mut files = Vec::new();

    let mut obj = String::from("# tetrahedron\r\nmtllib none.mtl\r\n");
    positions.iter().for_each(|p| write!(obj, "v {} {} {}\r\n", p.x, p.y, p.z).unwrap());
    triangles.iter().for_each(|t| write!(obj, "f {} {} {}\r\n", t[0] + 1, t[1] + 1, t[2] + 1).unwrap());
    files.push(("sound.obj", obj.into_bytes()));

    let header = |format: &str| {
        format!(
            "ply\nformat {format} 1.0\nelement vertex 4\nproperty float x\nproperty float y\nproperty float z\n\
             element face 4\nproperty list uchar int vertex_indices\nend_header\n"
        )
    };
    let mut ascii = header("ascii");
    positions.iter().for_each(|p| writeln!(ascii, "{} {} {}", p.x, p.y, p.z).unwrap());
    triangles.iter().for_each(|t| writeln!(ascii, "3 {} {} {}", t[0], t[1], t[2]).unwrap());
    files.push(("ascii.ply", ascii.into_bytes()));
    for (name, format, big) in [("little.ply", "binary_little_endian", false), ("big.ply", "binary_big_endian", true)] {
        let ordered = |bytes: [u8; 4]| if big { bytes.map(|b| b) } else { [bytes[3], bytes[2], bytes[1], bytes[0]] };
        let mut binary = header(format).into_bytes();
        positions.iter().flat_map(|p| p.to_array()).for_each(|x| binary.extend(ordered(x.to_be_bytes())));
        for triangle in &triangles {
            binary.push(3);
            triangle.iter().for_each(|v| binary.extend(ordered(v.to_be_bytes())));
        }
        files.push((name, binary));
    }

    files.push(("sound.glb", tetrahedron_glb(&positions, &triangles)));

    let mut hdr = b"#?RADIANCE\nFORMAT=32-bit_rle_rgbe\nEXPOSURE=2\n\n-Y 4 +X 8\n".to_vec();
    for row in 0..4_u8 {
        // The newer encoding: four components, each as a run of five and three literal bytes.
        hdr.extend([2, 2, 0, 8]);
        for component in 0..4_u8 {
            hdr.extend([128 + 5, 120 + component + row, 3, 129, 130, 131 - row]);
        }
    }
    files.push(("latlong.hdr", hdr));
    let mut angular = b"#?RGBE\nFORMAT=32-bit_rle_rgbe\n\n-Y 6 +X 6\n".to_vec();
    angular.extend((0..36).flat_map(|i| [128, 100 + i, 130, 128]));
    files.push(("angular.hdr", angular));
    files.push(("sound.exr", exr_bytes(8, 4, |x, y| [x as f32, y as f32, 1.0])));

    let scene = "name = \"s\"\n[[object]]\nshape = \"box\"\nalbedo = [0.5, 0.5, 0.5]\nspheres = 4\n\
                 rotate = [0, 1, 0, 30]\n[environment]\nsky = { turbidity = 3, resolution = 8 }\n[[light]]\n\
                 sphere = { center = [0, 3, 0], radius = 0.5 }\nradiance = [1, 2, 3]\n[camera]\neye = [0, 1, 4]\n\
                 target = [0, 0.5, 0]\nresolution = [8, 6]\n";
    files.push(("sound.png", picture(image::ImageFormat::Png)));
    files.push(("sound.jpg", picture(image::ImageFormat::Jpeg)));
    files.push(("scene.toml", scene.as_bytes().to_vec()));
    files
});

fn picture(format: image::ImageFormat) -> Vec<u8> {
    let mut bytes = std::io::Cursor::new(Vec::new());
    let image = image::RgbImage::from_fn(9, 7, |x, y| image::Rgb([(x * 28) as u8, (y * 36) as u8, (x * y) as u8]));
    image.write_to(&mut bytes, format).unwrap();
    bytes.into_inner()
}

fn tetrahedron() -> (Vec<Vec3>, Vec<[u32; 3]>) {
    let positions = vec![Vec3::ZERO, Vec3::new(1.5, 0.25, 0.0), Vec3::new(0.0, 1.25, 0.5), Vec3::new(0.0, 0.0, 1.75)];
    (positions, vec![[0, 2, 1], [0, 1, 3], [1, 2, 3], [0, 3, 2]])
}

fn tetrahedron_glb(positions: &[Vec3], triangles: &[[u32; 3]]) -> Vec<u8> {
    let json = r#"{"asset":{"version":"2.0"},"scene":0,"scenes":[{"nodes":[0]}],"nodes":[{"mesh":0}],
        "meshes":[{"primitives":[{"attributes":{"POSITION":0},"indices":1}]}],
        "accessors":[{"bufferView":0,"componentType":5126,"count":4,"type":"VEC3","min":[0,0,0],"max":[2,2,2]},
        {"bufferView":1,"componentType":5125,"count":12,"type":"SCALAR"}],
        "bufferViews":[{"buffer":0,"byteLength":48},{"buffer":0,"byteOffset":48,"byteLength":48}],
        "buffers":[{"byteLength":96}]}"#;
    let mut data: Vec<u8> = positions.iter().flat_map(|p| p.to_array()).flat_map(f32::to_le_bytes).collect();
    data.extend(triangles.iter().flatten().flat_map(|v| v.to_le_bytes()));
    glb::glb(json, &data)
}

fn exr_bytes(width: usize, height: usize, radiance: impl Fn(usize, usize) -> [f32; 3] + Sync) -> Vec<u8> {
    use exr::prelude::{Image, SpecificChannels, WritableImage};
    let channels = SpecificChannels::rgb(|position: exr::math::Vec2<usize>| {
        let [r, g, b] = radiance(position.x(), position.y());
        (r, g, b)
    });
    let mut bytes = std::io::Cursor::new(Vec::new());
    Image::from_channels((width, height), channels).write().to_buffered(&mut bytes).unwrap();
    bytes.into_inner()
}

/// Loads a file by what its name says it is.
fn load(path: &Path) -> Result<(), SceneError> {
    match path.extension().and_then(|e| e.to_str()) {
        Some("toml") => file::load(path).map(drop),
        Some("hdr" | "exr") => {
            let angular = path.file_name().is_some_and(|name| name.to_string_lossy().contains("angular"));
            let projection = Some(if angular { Projection::Angular } else { Projection::LatLong });
            load_probe(path, &ProbeOptions { projection, ..ProbeOptions::default() }).map(drop)
        }
        Some("png" | "jpg") => Texture::load(path).map(drop),
        _ => mesh::load(path).map(drop),
    }
}

fn written(folder: &tempfile::TempDir, name: &str, bytes: &[u8]) -> PathBuf {
    let path = folder.path().join(name);
    std::fs::write(&path, bytes).unwrap();
    path
}

fn error_of(name: &str, bytes: &[u8]) -> String {
    let folder = tempfile::tempdir().unwrap();
    let path = written(&folder, name, bytes);
    let error = load(&path).expect_err(name).to_string();
    assert!(error.starts_with(&path.display().to_string()), "{error}");
    error
}

#[test]
fn the_sound_files_load_and_agree() {
    let folder = tempfile::tempdir().unwrap();
    let mut meshes = Vec::new();
    for (name, bytes) in SOUND.iter() {
        let path = written(&folder, name, bytes);
        load(&path).unwrap_or_else(|error| panic!("{error}"));
        if mesh::EXTENSIONS.contains(&path.extension().unwrap().to_str().unwrap()) {
            meshes.push(mesh::load(&path).unwrap());
        }
    }
    // By places: only a glTF's triangles are flat where normals are missing.
    let welded: Vec<mesh::Welded> = meshes.iter().map(mesh::weld).collect();
    let is_first = |m: &mesh::Welded| (&m.positions, &m.triangles) == (&welded[0].positions, &welded[0].triangles);
    assert!(welded.len() == 5 && welded.iter().all(is_first));
    assert!(mesh::Topology::of(&meshes[0]).is_solid());
    let map = load_probe(&folder.path().join("sound.exr"), &ProbeOptions::default()).unwrap().0;
    assert_eq!(map.texels()[8 + 3], Vec3::new(3.0, 1.0, 1.0));
}

#[test]
fn files_cut_anywhere_are_refused() {
    let folder = tempfile::tempdir().unwrap();
    for (name, bytes) in SOUND.iter().filter(|(name, _)| *name != "scene.toml") {
        // Text without its last line break, or with fewer digits in its last number, can't be told from a whole file.
        let text = name.ends_with(".obj") || *name == "ascii.ply";
        // Without its last check sum a PNG still has all of its texels.
        let last = bytes.len() - if text { 3 } else { 4 * usize::from(*name == "sound.png") };
        for end in 0..last {
            // An OBJ that ends after a whole face is a smaller mesh; see the next test for where that is noticed.
            let whole_lines = *name == "sound.obj" && bytes[..end].windows(2).any(|pair| pair == b"f ");
            let result = load(&written(&folder, name, &bytes[..end]));
            assert!(result.is_err() || whole_lines, "{name} cut at {end} of {}", bytes.len());
        }
    }
}

#[test]
fn an_obj_cut_within_a_line_with_faces_missing_is_refused() {
    let error = error_of("cut.obj", b"v 0 0 0\nv 1 0 0\nv 0 1 0\nv 0 0 1\nv 1 1 1\nf 1 2 3\nf 1 2 4");
    assert!(error.contains("cut short") && error.contains(":7: "), "{error}");
}

#[test]
fn garbage_empty_missing_and_unknown_files_are_named() {
    for name in ["g.obj", "g.ply", "g.gltf", "g.glb", "g.hdr", "g.exr", "g.png", "g.jpg"] {
        error_of(name, b"");
        error_of(name, b"\0\x01\x02garbage \xff\xfe\n\n\n\x80");
        error_of(name, &[0xff; 4096]);
        let missing = load(Path::new("no/such/folder").join(name).as_path()).unwrap_err().to_string();
        assert!(missing.contains("cannot be read"), "{missing}");
    }
    error_of("g.toml", b"\xff\xfe");
    assert!(error_of("g.stl", b"solid").contains(".obj, .ply"));
    let error = load_probe(Path::new("g.jpg"), &ProbeOptions::default()).unwrap_err().to_string();
    assert!(error.contains(".hdr") && error.contains(".exr"));
}

#[test]
fn a_gltf_with_its_buffer_beside_it_needs_all_of_it() {
    let (positions, triangles) = tetrahedron();
    let whole = tetrahedron_glb(&positions, &triangles);
    let json_length = u32::from_le_bytes(whole[12..16].try_into().unwrap()) as usize;
    let json = String::from_utf8(whole[20..20 + json_length].to_vec()).unwrap();
    let json = json.replace(r#"[{"byteLength":96}]"#, r#"[{"byteLength":96,"uri":"a%20b.bin"}]"#);
    let folder = tempfile::tempdir().unwrap();
    let path = written(&folder, "split.gltf", json.as_bytes());
    assert!(load(&path).unwrap_err().to_string().contains("buffer"));
    let buffer = &whole[20 + json_length + 8..];
    written(&folder, "a b.bin", buffer);
    assert!(mesh::Topology::of(&mesh::load(&path).unwrap()).is_solid());
    written(&folder, "a b.bin", &buffer[..90]);
    assert!(load(&path).unwrap_err().to_string().contains("buffer"));
    written(&folder, "split.gltf", json.replace("%20", "%FF").as_bytes());
    assert!(load(&path).unwrap_err().to_string().contains("UTF-8"));
}

#[test]
fn impossible_radiance_and_shapes_of_probes_are_named() {
    for bad in [f32::NAN, f32::INFINITY, f32::NEG_INFINITY, -5.0] {
        let bytes = exr_bytes(8, 4, |x, y| if (x, y) == (5, 2) { [1.0, bad, 1.0] } else { [1.0; 3] });
        let error = error_of("bad.exr", &bytes);
        assert!(error.contains("column 5, row 2"), "{error}");
    }
    assert!(error_of("square.exr", &exr_bytes(6, 6, |_, _| [1.0; 3])).contains("angular"));
    assert!(error_of("odd.exr", &exr_bytes(7, 4, |_, _| [1.0; 3])).contains("twice as wide"));
    assert!(error_of("angular.exr", &exr_bytes(8, 4, |_, _| [1.0; 3])).contains("latlong"));
}

#[test]
fn meshes_without_a_surface_are_refused() {
    assert!(error_of("p.obj", b"v 0 0 0\nv 1 0 0\nv 2 0 0\nf 1 2 3\n").contains("area"));
    assert!(error_of("p.obj", b"v 0 0 0\nv 1 0 0\nv 2 1 0\n").contains("no triangles"));
    assert!(error_of("p.obj", b"# nothing\n").contains("no triangles"));
    let ply = "ply\nformat ascii 1.0\nelement vertex 0\nproperty float x\nproperty float y\nproperty float z\n\
               element face 0\nproperty list uchar int vertex_indices\nend_header\n";
    assert!(error_of("p.ply", ply.as_bytes()).contains("no triangles"));
}

#[test]
fn scene_files_find_their_meshes_beside_them() {
    let folder = tempfile::tempdir().unwrap();
    let (_, obj) = &SOUND[0];
    written(&folder, "sound.obj", obj);
    let text = "[[object]]\nmesh = \"sound.obj\"\n[[object]]\nmesh = \"sound.obj\"\nscale = 2\n";
    let scene = file::load(&written(&folder, "two.toml", text.as_bytes())).unwrap();
    assert!(std::sync::Arc::ptr_eq(&scene.objects[0].mesh, &scene.objects[1].mesh));
    assert_eq!((scene.name.as_str(), scene.objects[1].name.as_str()), ("two", "sound"));
    written(&folder, "sound.obj", b"v 0 0 0\nv 1 nan 0\n");
    let error = file::load(&folder.path().join("two.toml")).unwrap_err().to_string();
    assert!(error.contains("sound.obj:2: "), "{error}");
    assert!(builtin::SHAPES.iter().all(|shape| {
        file::load(&written(&folder, "s.toml", format!("[[object]]\nshape = \"{shape}\"").as_bytes())).is_ok()
    }));
}

#[test]
fn a_scene_file_textures_a_mesh_that_has_coordinates() {
    let folder = tempfile::tempdir().unwrap();
    let obj = "v 0 0 0\nv 1 0 0\nv 0 1 0\nvt 0.25 1\nvt 0.75 1\nvt 1.25 1\nf 1/1 2/2 3/3\n";
    written(&folder, "t.obj", obj.as_bytes());
    let mut png = std::io::Cursor::new(Vec::new());
    let image = image::GrayImage::from_fn(2, 1, |x, _| image::Luma([255 * x as u8]));
    image.write_to(&mut png, image::ImageFormat::Png).unwrap();
    written(&folder, "t.png", &png.into_inner());
    let read = |texture: &str| {
        let text = format!("[[object]]\nmesh = \"t.obj\"\nalbedo = [1, 0.5, 0]\nalbedo_texture = \"{texture}\"\n");
        file::load(&written(&folder, "t.toml", text.as_bytes()))
    };
    let scene = read("t.png").unwrap();
    let object = &scene.objects[0];
    let albedo = Vec3::new(1.0, 0.5, 0.0);
    assert_eq!([0, 1, 2].map(|v| object.albedo_at_vertex(v)), [Vec3::ZERO, albedo, Vec3::ZERO]);
    // Halfway from the first vertex to the second: halfway between the texels.
    let between = object.albedo_at(0, glam::DVec3::new(0.5, 0.5, 0.0));
    assert!(between.distance(0.5 * albedo) < 1e-6, "{between}");
    // From the second to the third, not through the middle of their colours: a texture has its own resolution.
    assert!(object.albedo_at(0, glam::DVec3::new(0.0, 0.9, 0.1)).distance(0.9 * albedo) < 1e-6);
    let buffer = halfshade_scene::ReceiverBuffer::vertices(&scene.frame(0));
    assert_eq!([0, 1, 2].map(|v| buffer.view().albedo_at(v)), [Vec3::ZERO, albedo, Vec3::ZERO]);

    // The same picture for gloss: it multiplies specular scale and exponent.
    let glossy = "[[object]]\nmesh = \"t.obj\"\nreflectance = { model = \"phong\", specular = [1, 1, 1], exponent = 9, \
                  specular_texture = \"t.png\", exponent_texture = \"t.png\" }";
    let glossy = file::load(&written(&folder, "g.toml", glossy.as_bytes())).unwrap();
    let buffer = halfshade_scene::ReceiverBuffer::vertices(&glossy.frame(0));
    let found = [0, 1].map(|v| (buffer.view().gloss_at(v).specular, buffer.view().gloss_at(v).exponent));
    assert_eq!(found, [(Vec3::ZERO, 0.0), (Vec3::ONE, 1.0)]);

    let missing = read("none.png").unwrap_err().to_string();
    assert!(missing.contains("t.toml:4:18: ") && missing.contains("none.png: cannot be read"), "{missing}");
    let wrong = read("t.obj").unwrap_err().to_string();
    assert!(wrong.contains("t.obj: the image is neither PNG nor JPEG"), "{wrong}");
    written(&folder, "t.obj", b"v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n");
    let bare = read("t.png").unwrap_err().to_string();
    assert!(bare.contains("t.toml:4:18: `t` has no texture coordinates"), "{bare}");
}

proptest! {
    #![proptest_config(ProptestConfig { cases: 2000, failure_persistence: None, ..ProptestConfig::default() })]

    /// Bytes changed, pieces removed, doubled or inserted: nothing panics, and errors name the file.
    #[test]
    fn no_damage_makes_a_loader_panic(
        file in 0..SOUND.len(),
        edits in prop::collection::vec((any::<prop::sample::Index>(), 0..6_u8, any::<u8>(), 1..9_usize), 1..6),
    ) {
        let (name, sound) = &SOUND[file];
        let mut bytes = sound.clone();
        for (place, kind, value, length) in edits {
            if bytes.is_empty() {
                break;
            }
            let start = place.index(bytes.len());
            let end = (start + length).min(bytes.len());
            match kind {
                0 => bytes[start] = value,
                1 => bytes[start] ^= 1 << (value % 8),
                2 => drop(bytes.drain(start..end)),
                3 => bytes[start..end].fill([0, 0xff, b'9', b'-', b' ', b'e'][usize::from(value) % 6]),
                4 => drop(bytes.splice(start..start, bytes[start..end].to_vec())),
                // A digit for a digit: plausible numbers that are wrong.
                _ => if let Some(digit) = bytes[start..].iter_mut().find(|byte| byte.is_ascii_digit()) {
                    *digit = b'0' + value % 10;
                },
            }
        }
        let folder = tempfile::tempdir().unwrap();
        let path = written(&folder, name, &bytes);
        if let Err(error) = load(&path) {
            prop_assert!(error.to_string().starts_with(&path.display().to_string()), "{error}");
        }
    }
}
