//! Geometry of glTF files: what stands where, against closed forms.

use super::glb::{self, Builder};
use glam::{DVec3, Quat, Vec3};
use halfshade_scene::mesh::{self, Animation, Mesh};
use halfshade_scene::{SceneError, Skin};
use std::path::PathBuf;

/// The unit square in the plane z = 0 as accessors 0 (positions) and 1 (indices).
fn square() -> Builder {
    let mut builder = Builder::default();
    builder.floats("VEC3", &[0.0, 0.0, 0.0, 1.0, 0.0, 0.0, 1.0, 1.0, 0.0, 0.0, 1.0, 0.0]);
    builder.indices(&[0, 1, 2, 0, 2, 3]);
    builder
}

/// A document of one node, `node` in its JSON, whose mesh has `mesh` beside its primitives and one primitive with
/// `attributes` beside the positions and `primitive` beside those.
fn document(node: &str, mesh: &str, attributes: &str, primitive: &str) -> String {
    format!(
        r#""scene":0,"scenes":[{{"nodes":[0]}}],"nodes":[{{"mesh":0{node}}}],
        "meshes":[{{"primitives":[{{"attributes":{{"POSITION":0{attributes}}},"indices":1{primitive}}}]{mesh}}}]"#
    )
}

fn written(name: &str, bytes: &[u8]) -> (tempfile::TempDir, PathBuf) {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join(name);
    std::fs::write(&path, bytes).unwrap();
    (folder, path)
}

fn load(bytes: &[u8]) -> Result<(Mesh, Vec<String>), SceneError> {
    mesh::load_with_notes(&written("x.glb", bytes).1)
}

fn animated(bytes: &[u8]) -> Result<(Mesh, Option<Skin>), SceneError> {
    mesh::load_animated(&written("x.glb", bytes).1, &Animation::Number(0))
}

fn area_of(positions: &[Vec3], triangles: &[[u32; 3]]) -> f64 {
    let doubled = |t: &[u32; 3]| {
        let [a, b, c] = t.map(|v| positions[v as usize].as_dvec3());
        (b - a).cross(c - a).length()
    };
    0.5 * triangles.iter().map(doubled).sum::<f64>()
}

fn area(mesh: &Mesh) -> f64 {
    area_of(&mesh.positions, &mesh.triangles)
}

fn holds(mesh: &Mesh, place: [f32; 3]) -> bool {
    mesh.positions.iter().any(|p| p.distance(Vec3::from(place)) < 1e-5)
}

#[test]
fn weights_of_mesh_and_node_morph_and_the_nodes_win() {
    let mut builder = square();
    // The right side goes right by 1.
    builder.floats("VEC3", &[0.0, 0.0, 0.0, 1.0, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0, 0.0, 0.0]);
    let target = r#","targets":[{"POSITION":2}]"#;
    for (node, mesh, expected) in [
        ("", r#","weights":[1]"#, 2.0),
        (r#","weights":[2]"#, r#","weights":[1]"#, 3.0),
        (r#","weights":[0.5]"#, "", 1.5),
        (r#","weights":[]"#, r#","weights":[1]"#, 1.0),
        ("", "", 1.0),
        // The node's place applies to what is morphed.
        (r#","scale":[1,3,1]"#, r#","weights":[1]"#, 6.0),
    ] {
        let (mesh, notes) = load(&builder.glb(&document(node, mesh, "", target))).unwrap();
        assert!((area(&mesh) - expected).abs() < 1e-6 && notes.is_empty(), "{node} {}: {notes:?}", area(&mesh));
    }
}

#[test]
fn morph_targets_may_be_sparse_or_of_whole_numbers_and_turn_normals() {
    let mut builder = square();
    builder.floats("VEC3", &[0.0, 0.0, 1.0].repeat(4));
    // Two of four vertices go by (1, 0, 0): indices, then values.
    let places = builder.view(&[1, 2]);
    let values: Vec<u8> = [1.0_f32, 0.0, 0.0, 1.0, 0.0, 0.0].iter().flat_map(|x| x.to_le_bytes()).collect();
    let values = builder.view(&values);
    let sparse = format!(
        r#"{{"componentType":5126,"count":4,"type":"VEC3","sparse":{{"count":2,
        "indices":{{"bufferView":{places},"componentType":5121}},"values":{{"bufferView":{values}}}}}}}"#
    );
    let sparse = builder.accessor(sparse);
    let signed = |list: [i8; 12]| list.map(|x| x as u8);
    let shifts = signed([0, 0, 0, 127, 0, 0, 127, 0, 0, 0, 0, 0]);
    let bytes = builder.list("VEC3", 5120, 4, &shifts, r#","normalized":true"#);
    let normals = builder.floats("VEC3", &[1.0, 0.0, -1.0].repeat(4));
    for accessor in [sparse, bytes] {
        let target = format!(r#","targets":[{{"POSITION":{accessor},"NORMAL":{normals}}}]"#);
        let (mesh, _) = load(&builder.glb(&document("", r#","weights":[1]"#, r#","NORMAL":2"#, &target))).unwrap();
        assert!((area(&mesh) - 2.0).abs() < 1e-6, "{}", area(&mesh));
        assert!(mesh.normals.iter().all(|n| n.distance(Vec3::X) < 1e-6), "{:?}", mesh.normals);
    }
}

/// The square with a target that lifts its right side by 1 along z, and an animation of the weight at 0 s and 2 s.
fn lifted(interpolation: &str, weights: &[f32], normals: bool) -> Vec<u8> {
    let mut builder = square();
    builder.floats("VEC3", &[0.0, 0.0, 0.0, 0.0, 0.0, 1.0, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0]);
    builder.floats("SCALAR", &[0.0, 2.0]);
    builder.floats("SCALAR", weights);
    builder.floats("VEC3", &[0.0, 0.0, 1.0].repeat(4));
    builder.floats("VEC3", &[-1.0, 0.0, 0.0].repeat(4));
    let (attribute, target) = if normals { (r#","NORMAL":5"#, r#","NORMAL":6"#) } else { ("", "") };
    let target = format!(r#","targets":[{{"POSITION":2{target}}}]"#);
    let animation = format!(
        r#","animations":[{{"samplers":[{{"input":3,"output":4,"interpolation":"{interpolation}"}}],
        "channels":[{{"sampler":0,"target":{{"node":0,"path":"weights"}}}}]}}]"#
    );
    let mesh = r#","weights":[0.25]"#;
    builder.glb(&(document(r#","translation":[0,0,5],"scale":[2,2,2]"#, mesh, attribute, &target) + &animation))
}

#[test]
fn animated_weights_move_as_their_channel_says() {
    let eased = |x: f32| x * x * (3.0 - 2.0 * x);
    for (interpolation, weights, at) in [
        ("LINEAR", &[0.0, 1.0][..], &(|x: f32| x) as &dyn Fn(f32) -> f32),
        ("STEP", &[0.0, 1.0], &f32::floor),
        ("CUBICSPLINE", &[0.0, 0.0, 0.0, 0.0, 1.0, 0.0], &eased),
    ] {
        for normals in [false, true] {
            let (mesh, skin) = animated(&lifted(interpolation, weights, normals)).unwrap();
            let skin = skin.unwrap();
            assert!(skin.moves() && skin.last_key_secs() == 2.0);
            for time in [0.0, 0.5, 1.0, 1.7, 2.0, 3.0_f32] {
                let weight = at((0.5 * time).min(1.0));
                let deformed = skin.deform(&mesh, time.into());
                // A side of length √(1 + w²), in a space twice as large.
                let side = (1.0 + weight * weight).sqrt();
                let found = area_of(&deformed.positions, &mesh.triangles);
                assert!((found - f64::from(4.0 * side)).abs() < 2e-3, "{interpolation} {time}: {found}");
                let slope = if interpolation == "CUBICSPLINE" { 1e-3 } else { 1e-5 };
                let normal = Vec3::new(-weight, 0.0, 1.0).normalize();
                assert!(
                    deformed.normals.iter().all(|n| n.distance(normal) < slope),
                    "{interpolation} {time} {normals}"
                );
                assert!(deformed.positions.iter().all(|p| (p.z - 5.0 - weight * p.x).abs() < 2e-3));
            }
        }
    }
    // Without the animation, the weight of the mesh.
    let (still, _) = load(&lifted("LINEAR", &[0.0, 1.0], true)).unwrap();
    assert!((area(&still) - 4.0 * 1.0625_f64.sqrt()).abs() < 1e-5);
}

#[test]
fn an_animated_weight_that_stands_still_is_a_pose_and_mistakes_are_named() {
    let (mesh, skin) = animated(&lifted("LINEAR", &[1.0, 1.0], false)).unwrap();
    assert!(skin.is_none() && (area(&mesh) - 4.0 * 2.0_f64.sqrt()).abs() < 1e-5);
    let error = animated(&lifted("LINEAR", &[0.0, 1.0, 2.0], false)).unwrap_err().to_string();
    assert!(error.contains("node 0") && error.contains("3 values for 2 times"), "{error}");
    let huge = animated(&lifted("LINEAR", &[0.0, 1e20], false)).unwrap_err().to_string();
    assert!(huge.contains("too far out"), "{huge}");
}

/// A square bound to joints 2 and 3, half each, whose node stands elsewhere; `joints` are the JSON of these nodes'
/// insides.
fn skinned(joints: [&str; 2], targets: &str, rest: &str) -> Vec<u8> {
    let mut builder = square();
    builder.list("VEC4", 5121, 4, &[0, 1, 0, 0].repeat(4), "");
    builder.floats("VEC4", &[0.5, 0.5, 0.0, 0.0].repeat(4));
    builder.floats("VEC3", &[0.0, 0.0, 0.0, 1.0, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0, 0.0, 0.0]);
    builder.floats("SCALAR", &[0.0, 1.0]);
    builder.floats("SCALAR", &[0.0, 1.0]);
    builder.floats("VEC3", &[0.0, 0.0, 0.0, 0.0, 4.0, 0.0]);
    let [a, b] = joints;
    builder.glb(&format!(
        r#""scene":0,"scenes":[{{"nodes":[0]}}],"nodes":[{{"children":[1,2]}},
        {{"mesh":0,"skin":0,"translation":[0,7,0],"scale":[100,100,100]}},{{{a}}},{{{b}}}],
        "skins":[{{"joints":[2,3],"skeleton":0}}],
        "meshes":[{{"primitives":[{{"attributes":{{"POSITION":0,"JOINTS_0":2,"WEIGHTS_0":3}},"indices":1{targets}}}]}}]{rest}"#
    ))
}

#[test]
fn a_skinned_mesh_stands_at_its_joints_wherever_its_node_is() {
    // The second joint is in no scene; it counts all the same.
    let bytes = skinned([r#""translation":[0,0,2]"#, r#""translation":[0,0,2]"#], "", "");
    let (mesh, notes) = load(&bytes).unwrap();
    assert!(notes.is_empty() && (area(&mesh) - 1.0).abs() < 1e-6);
    assert!([[0.0, 0.0, 2.0], [1.0, 1.0, 2.0]].iter().all(|place| holds(&mesh, *place)), "{:?}", mesh.positions);
    assert!(mesh.positions.iter().all(|p| p.z == 2.0) && mesh.normals.iter().all(|n| n.distance(Vec3::Z) < 1e-6));
    // Half of twice as wide and half of as wide as it was; half of 2 up.
    let bytes = skinned([r#""scale":[3,1,1],"translation":[0,2,0]"#, ""], "", "");
    let (mesh, _) = load(&bytes).unwrap();
    assert!((area(&mesh) - 2.0).abs() < 1e-6 && holds(&mesh, [2.0, 2.0, 0.0]), "{:?}", mesh.positions);
    // A joint of scale 0, as programs hide things: half of it is left.
    let (mesh, _) = load(&skinned([r#""scale":[0,0,0]"#, ""], "", "")).unwrap();
    assert!((area(&mesh) - 0.25).abs() < 1e-6);
    // Mirrored, its normals still are upright to its faces, and face as the mirrored square does.
    let (mesh, _) = load(&skinned([r#""scale":[-1,1,1]"#, r#""scale":[-1,1,1]"#], "", "")).unwrap();
    assert!(holds(&mesh, [-1.0, 1.0, 0.0]) && mesh.normals.iter().all(|n| n.distance(Vec3::Z) < 1e-6));
}

#[test]
fn morphs_come_before_skins() {
    let animation = r#","animations":[{"samplers":[{"input":5,"output":6},{"input":5,"output":7}],
        "channels":[{"sampler":0,"target":{"node":1,"path":"weights"}},{"sampler":1,"target":{"node":2,"path":"translation"}}]}]"#;
    let turn = Quat::from_rotation_z(std::f32::consts::FRAC_PI_2).to_array();
    let turned = format!(r#""rotation":[{},{},{},{}]"#, turn[0], turn[1], turn[2], turn[3]);
    let bytes = skinned([&turned, &turned], r#","targets":[{"POSITION":4}]"#, animation);
    let (mesh, skin) = animated(&bytes).unwrap();
    let deformed = skin.unwrap().deform(&mesh, 0.5);
    // By half, to the right, which the joints turn upward; then half of 2 up with the first joint.
    let at = |x: f32, y: f32| Vec3::new(-y, x, 0.0) + Vec3::Y;
    for (x, y) in [(0.0, 0.0), (1.5, 0.0), (1.5, 1.0), (0.0, 1.0)] {
        assert!(deformed.positions.iter().any(|p| p.distance(at(x, y)) < 1e-5), "{x} {y}: {:?}", deformed.positions);
    }
    assert!(deformed.normals.iter().all(|n| n.distance(Vec3::Z) < 1e-5));
}

#[test]
fn flat_triangles_stay_flat_as_they_bend() {
    // Two triangles that a target folds along their diagonal: the corner (1, 0) goes up.
    let mut builder = square();
    builder.floats("VEC3", &[0.0, 0.0, 0.0, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0]);
    builder.floats("SCALAR", &[0.0, 1.0]);
    builder.floats("SCALAR", &[0.0, 1.0]);
    let animation = r#","animations":[{"samplers":[{"input":3,"output":4}],"channels":[{"sampler":0,"target":{"node":0,"path":"weights"}}]}]"#;
    let bytes = builder.glb(&(document("", "", "", r#","targets":[{"POSITION":2}]"#) + animation));
    let (mesh, skin) = animated(&bytes).unwrap();
    let deformed = skin.unwrap().deform(&mesh, 1.0);
    for triangle in &mesh.triangles {
        let [a, b, c] = triangle.map(|v| deformed.positions[v as usize]);
        let across = (b - a).cross(c - a).normalize();
        assert!(
            triangle.iter().all(|&v| deformed.normals[v as usize].distance(across) < 1e-6),
            "{:?}",
            deformed.normals
        );
    }
}

#[test]
fn a_cube_without_normals_has_flat_faces() {
    let mut builder = Builder::default();
    let corners: Vec<f32> = (0..8).flat_map(|i| [i >> 2 & 1, i >> 1 & 1, i & 1].map(|bit| bit as f32)).collect();
    builder.floats("VEC3", &corners);
    builder.indices(&[
        0, 1, 3, 0, 3, 2, 4, 6, 7, 4, 7, 5, 0, 4, 5, 0, 5, 1, 2, 3, 7, 2, 7, 6, 0, 2, 6, 0, 6, 4, 1, 5, 7, 1, 7, 3,
    ]);
    let (mesh, _) = load(&builder.glb(&document("", "", "", ""))).unwrap();
    // Four corners on each of six faces.
    assert_eq!((mesh.positions.len(), mesh.triangles.len()), (24, 12));
    let center = DVec3::splat(0.5);
    for triangle in &mesh.triangles {
        let [a, b, c] = triangle.map(|v| mesh.positions[v as usize].as_dvec3());
        let across = (b - a).cross(c - a).normalize();
        assert!(across.dot((a + b + c) / 3.0 - center) > 0.0);
        assert!(triangle.iter().all(|&v| mesh.normals[v as usize].as_dvec3().distance(across) < 1e-6));
    }
}

#[test]
fn copies_stand_where_instances_say() {
    let mut builder = square();
    builder.floats("VEC3", &[0.0, 0.0, 0.0, 3.0, 0.0, 0.0, 6.0, 0.0, 0.0]);
    builder.floats("VEC3", &[1.0, 1.0, 1.0, 2.0, 2.0, 2.0, 1.0, 3.0, 1.0]);
    // A half turn about x for the third, as signed bytes.
    let turns: Vec<u8> = [0, 0, 0, 127, 0, 0, 0, 127, 127, 0, 0, 0].to_vec();
    builder.list("VEC4", 5120, 3, &turns, r#","normalized":true"#);
    let node = |attributes: &str| {
        format!(r#","scale":[2,2,2],"extensions":{{"EXT_mesh_gpu_instancing":{{"attributes":{{{attributes}}}}}}}"#)
    };
    let of = |attributes: &str| load(&builder.glb(&document(&node(attributes), "", "", "")));
    let (mesh, notes) = of(r#""TRANSLATION":2"#).unwrap();
    assert!((area(&mesh) - 12.0).abs() < 1e-5 && notes.is_empty());
    assert!(holds(&mesh, [14.0, 2.0, 0.0]) && holds(&mesh, [6.0, 0.0, 0.0]));
    let (mesh, _) = of(r#""TRANSLATION":2,"SCALE":3,"ROTATION":4,"_ID":7"#).unwrap();
    assert!(
        (area(&mesh) - 4.0 * (1.0 + 4.0 + 3.0)).abs() < 1e-4 && holds(&mesh, [14.0, -6.0, 0.0]),
        "{:?}",
        mesh.positions
    );
    for (attributes, parts) in [
        (r#""TRANSLATION":9"#, ["EXT_mesh_gpu_instancing", "accessor 9"]),
        (r#""TRANSLATION":0,"SCALE":3"#, ["EXT_mesh_gpu_instancing", "4 and 3"]),
    ] {
        let error = of(attributes).unwrap_err().to_string();
        assert!(parts.iter().all(|part| error.contains(part)), "{error}");
    }
}

#[test]
fn positions_and_normals_may_be_whole_numbers() {
    let mut builder = Builder::default();
    let shorts: Vec<u8> =
        [0_i16, 0, 0, 0, 100, 0, 0, 0, 100, 100, 0, 0, 0, 100, 0, 0].iter().flat_map(|x| x.to_le_bytes()).collect();
    let view = builder.view(&shorts);
    // Elements of six bytes stand eight apart.
    builder.accessor(format!(
        r#"{{"bufferView":{view},"componentType":5122,"count":4,"type":"VEC3","min":[0,0,0],"max":[100,100,0]}}"#
    ));
    builder.indices(&[0, 1, 2, 0, 2, 3]);
    builder.list("VEC3", 5120, 4, &[0, 0, 129].repeat(4), r#","normalized":true"#);
    let rest = document(r#","scale":[0.01,0.01,0.01]"#, "", r#","NORMAL":2"#, "")
        + r#","extensionsUsed":["KHR_mesh_quantization"]"#;
    let bytes = builder.glb(&rest);
    let strided = |bytes: Vec<u8>| {
        let text = String::from_utf8_lossy(&bytes).into_owned();
        assert!(text.contains(r#""byteLength":32}"#));
        let json_length = u32::from_le_bytes(bytes[12..16].try_into().unwrap()) as usize;
        let json = String::from_utf8(bytes[20..20 + json_length].to_vec()).unwrap();
        glb::glb(
            &json.replacen(r#""byteLength":32}"#, r#""byteLength":32,"byteStride":8}"#, 1),
            &bytes[28 + json_length..],
        )
    };
    let (mesh, notes) = load(&strided(bytes)).unwrap();
    assert!((area(&mesh) - 1.0).abs() < 1e-6 && notes.is_empty(), "{:?}", mesh.positions);
    assert!(mesh.normals.iter().all(|n| n.distance(Vec3::NEG_Z) < 1e-6));
}

#[test]
fn strips_and_fans_are_triangles_and_lines_are_a_note() {
    let of = |mode: u32, indices: &[u16]| {
        let mut builder = Builder::default();
        builder.floats("VEC3", &[0.0, 0.0, 0.0, 1.0, 0.0, 0.0, 1.0, 1.0, 0.0, 0.0, 1.0, 0.0]);
        builder.indices(indices);
        load(&builder.glb(&document("", "", "", &format!(r#","mode":{mode}"#))))
    };
    for (mode, indices) in [(4, &[0, 1, 2, 0, 2, 3][..]), (5, &[0, 1, 3, 2]), (6, &[0, 1, 2, 3])] {
        let (mesh, _) = of(mode, indices).unwrap();
        assert!((area(&mesh) - 1.0).abs() < 1e-6 && mesh.triangles.len() == 2, "{mode}");
        assert!(mesh.normals.iter().all(|n| n.distance(Vec3::Z) < 1e-6), "{mode}");
    }
    let (_, notes) = of(4, &[0, 1, 2, 0, 2, 3, 1]).unwrap();
    assert_eq!(notes, ["indices after the last whole triangle left out: 1"]);
    let error = of(1, &[0, 1]).unwrap_err().to_string();
    assert!(error.contains("points or lines only") && error.contains("export triangles"), "{error}");
    let mut builder = square();
    builder.indices(&[0, 1]);
    let second = r#"},{"attributes":{"POSITION":0},"indices":2,"mode":1"#;
    let (_, notes) = load(&builder.glb(&document("", "", "", second))).unwrap();
    assert_eq!(notes, ["parts of points or lines left out: 1"]);
}

#[test]
fn what_is_hidden_stays_out_and_what_is_not_read_is_told_once() {
    let used = r#","extensionsUsed":["KHR_node_visibility","KHR_lights_punctual","KHR_materials_variants"]"#;
    let hidden = r#","extensions":{"KHR_node_visibility":{"visible":false}}"#;
    let error = load(&square().glb(&(document(hidden, "", "", "") + used))).unwrap_err().to_string();
    assert!(error.contains("its scene is empty"), "{error}");
    let (_, notes) = load(&square().glb(&(document("", "", r#","_ID":0"#, "") + used))).unwrap();
    assert_eq!(notes, ["extensions of glTF that are not read: KHR_lights_punctual, KHR_materials_variants"]);
}

#[test]
fn morph_targets_of_colours_and_attributes_of_copies_are_told() {
    let targets = r#","targets":[{"POSITION":0,"COLOR_0":0,"TEXCOORD_0":0},{"COLOR_0":0,"TANGENT":0}]"#;
    let (_, notes) = load(&square().glb(&document("", "", "", targets))).unwrap();
    assert_eq!(notes, ["of morph targets only positions and normals are read, left out: COLOR_0, TEXCOORD_0"]);
    let copies = r#","extensions":{"EXT_mesh_gpu_instancing":{"attributes":{"TRANSLATION":2,"_COLOR_0":2,"_ID":2}}}"#;
    let mut builder = square();
    builder.floats("VEC3", &[0.0, 0.0, 0.0, 0.0, 0.0, 5.0]);
    let used = r#","extensionsUsed":["EXT_mesh_gpu_instancing"]"#;
    let (mesh, notes) = load(&builder.glb(&(document(copies, "", "", "") + used))).unwrap();
    assert_eq!(notes, ["attributes of copies left out (EXT_mesh_gpu_instancing): _COLOR_0, _ID"]);
    assert!((area(&mesh) - 2.0).abs() < 1e-6);
}

#[test]
fn which_scene_is_read_is_told_where_the_document_does_not_say() {
    let scenes = |scene: &str, list: &str| {
        let document =
            document("", "", "", "").replace(r#""scene":0,"scenes":[{"nodes":[0]}]"#, &format!("{scene}{list}"));
        load(&square().glb(&document))
    };
    let two = r#""scenes":[{"nodes":[0]},{"name":"empty"}]"#;
    let (mesh, notes) = scenes("", two).unwrap();
    assert_eq!(notes, ["of 2 scenes the first is read, as the document doesn't say which"]);
    assert!((area(&mesh) - 1.0).abs() < 1e-6);
    assert!(scenes(r#""scene":0,"#, two).unwrap().1.is_empty());
    let error = scenes(r#""scene":1,"#, two).unwrap_err();
    assert!(error.problem.contains("scene is empty") && error.remedy.is_some(), "{error}");
}

#[test]
fn matrices_of_nodes_are_affine() {
    let of = |matrix: &str| load(&square().glb(&document(&format!(r#","matrix":[{matrix}]"#), "", "", "")));
    let (mesh, _) = of("1,0,0,0, 0,1,0,0, 0,0,1,0, 3,0,0,1").unwrap();
    assert!(holds(&mesh, [4.0, 1.0, 0.0]));
    // Row by row, a translation is in the bottom row.
    let error = of("1,0,0,3, 0,1,0,0, 0,0,1,0, 0,0,0,1").unwrap_err();
    assert!(error.problem.contains("bottom row of the matrix of node 0 is [3.0, 0.0, 0.0, 1.0]"), "{error}");
    assert!(error.remedy.unwrap().contains("column by column"));
    assert!(of("1,0,0,0, 0,1,0,0, 0,0,1,0, 0,0,0,2").is_err());
}
