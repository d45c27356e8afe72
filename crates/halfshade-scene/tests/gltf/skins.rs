//! Skins and animations of glTF files, against closed forms.

use super::glb;
use glam::{Affine3A, Mat4, Quat, Vec3};
use halfshade_scene::mesh::{self, Animation};
use halfshade_scene::{Scene, SceneError, Skin, file};
use proptest::prelude::*;
use std::f32::consts::FRAC_PI_2;
use std::path::PathBuf;

/// A square column of height 2 in five rings, in a folder of its own.
///
/// `armature` turns z up into y up, halves and shifts; `lower` stands on it and slides along x from 0.5 s to 1.5 s;
/// `upper` stands 1 above and bends by a quarter turn about x from 0 s to 2 s. The node of the mesh is elsewhere, which
/// mustn't count.
struct Column {
    upper_times: Vec<f32>,
    /// Rotations of `upper`, as quaternions.
    upper_values: Vec<[f32; 4]>,
    interpolation: &'static str,
    /// Per vertex, in steps of four.
    joints: Vec<u16>,
    weights: Vec<f32>,
    inverse_binds: Vec<Mat4>,
    /// Changes the document at last.
    edit: Box<dyn Fn(String) -> String>,
}

/// Raw positions: the first vertex is in no triangle, and rings come from the top downward.
fn positions() -> Vec<Vec3> {
    let ring =
        |y: f32| [(-1.0, -1.0), (1.0, -1.0), (1.0, 1.0), (-1.0, 1.0)].map(|(x, z)| Vec3::new(0.2 * x, y, 0.2 * z));
    let rings = [2.0, 1.5, 1.0, 0.5, 0.0].into_iter().flat_map(ring);
    std::iter::once(Vec3::splat(9.0)).chain(rings).collect()
}

fn triangles() -> Vec<u16> {
    let mut list = Vec::new();
    for ring in (0..4_u16).rev() {
        for side in 0..4 {
            let [a, b] = [side, (side + 1) % 4].map(|corner| 1 + 4 * ring + corner);
            list.extend([a, b, b + 4, a, b + 4, a + 4]);
        }
    }
    list.extend([1, 4, 3, 1, 3, 2, 17, 18, 19, 17, 19, 20]);
    list
}

/// The weight of `upper` at a height.
fn upper_weight(y: f32) -> f32 {
    ((y - 0.5) / 1.0).clamp(0.0, 1.0)
}

fn armature() -> Affine3A {
    Affine3A::from_scale_rotation_translation(
        Vec3::splat(0.5),
        Quat::from_rotation_x(-FRAC_PI_2),
        Vec3::new(0.0, 3.0, 0.0),
    )
}

impl Default for Column {
    fn default() -> Self {
        let of_vertices = |p: &Vec3| {
            let upper = upper_weight(p.y);
            // Not normalized, and in another order than the joints.
            [2.0 * upper, 0.0, 2.0 * (1.0 - upper), 0.0]
        };
        Self {
            upper_times: vec![0.0, 2.0],
            upper_values: [0.0, FRAC_PI_2].map(|angle| Quat::from_rotation_x(angle).to_array()).to_vec(),
            interpolation: "LINEAR",
            joints: positions().iter().flat_map(|_| [1, 0, 0, 0]).collect(),
            weights: positions().iter().flat_map(of_vertices).collect(),
            inverse_binds: vec![Mat4::IDENTITY, Mat4::from_translation(-Vec3::Y)],
            edit: Box::new(|json| json),
        }
    }
}

impl Column {
    fn edited(from: &'static str, to: &'static str) -> Self {
        let edit = move |json: String| {
            assert!(json.contains(from), "{from} is not in {json}");
            json.replace(from, to)
        };
        Self { edit: Box::new(edit), ..Self::default() }
    }

    /// As a GLB.
    fn bytes(&self) -> Vec<u8> {
        let mut data: Vec<u8> = Vec::new();
        let (mut views, mut accessors) = (Vec::new(), Vec::new());
        let mut add = |bytes: Vec<u8>, kind: &str, component: u32, count: usize| {
            views.push(format!(r#"{{"buffer":0,"byteOffset":{},"byteLength":{}}}"#, data.len(), bytes.len()));
            let view = views.len() - 1;
            // glTF wants bounds of positions, which come first.
            let bounds = if view == 0 { r#","min":[0,0,0],"max":[9,9,9]"# } else { "" };
            accessors.push(format!(
                r#"{{"bufferView":{view},"componentType":{component},"count":{count},"type":"{kind}"{bounds}}}"#
            ));
            data.extend(bytes);
            data.resize(data.len().next_multiple_of(4), 0);
        };
        let floats = |list: &[f32]| list.iter().flat_map(|x| x.to_le_bytes()).collect::<Vec<u8>>();
        let shorts = |list: &[u16]| list.iter().flat_map(|x| x.to_le_bytes()).collect::<Vec<u8>>();
        let flat: Vec<f32> = positions().iter().flat_map(|p| p.to_array()).collect();
        add(floats(&flat), "VEC3", 5126, positions().len());
        add(shorts(&triangles()), "SCALAR", 5123, triangles().len());
        add(shorts(&self.joints), "VEC4", 5123, self.joints.len() / 4);
        add(floats(&self.weights), "VEC4", 5126, self.weights.len() / 4);
        let binds: Vec<f32> = self.inverse_binds.iter().flat_map(Mat4::to_cols_array).collect();
        add(floats(&binds), "MAT4", 5126, self.inverse_binds.len());
        add(floats(&self.upper_times), "SCALAR", 5126, self.upper_times.len());
        add(floats(self.upper_values.as_flattened()), "VEC4", 5126, self.upper_values.len());
        add(floats(&[0.5, 1.5]), "SCALAR", 5126, 2);
        add(floats(&[0.0, 0.0, 0.0, 1.0, 0.0, 0.0]), "VEC3", 5126, 2);
        let radial: Vec<f32> =
            positions().iter().flat_map(|p| Vec3::new(p.x, 0.0, p.z).normalize().to_array()).collect();
        add(floats(&radial), "VEC3", 5126, positions().len());
        let json = (self.edit)(format!(
            r#"{{"asset":{{"version":"2.0"}},"scene":0,"scenes":[{{"nodes":[0]}}],
            "nodes":[{{"name":"armature","translation":[0,3,0],"rotation":[-0.70710678,0,0,0.70710678],"scale":[0.5,0.5,0.5],"children":[1,3]}},
            {{"name":"lower","children":[2]}},{{"name":"upper","translation":[0,1,0]}},
            {{"name":"column","mesh":0,"skin":0,"translation":[100,0,0]}}],
            "meshes":[{{"primitives":[{{"attributes":{{"POSITION":0,"JOINTS_0":2,"WEIGHTS_0":3,"NORMAL":9}},"indices":1}}]}}],
            "skins":[{{"joints":[1,2],"inverseBindMatrices":4}}],
            "animations":[{{"name":"bend","samplers":[{{"input":5,"output":6,"interpolation":"{}"}},{{"input":7,"output":8}}],
            "channels":[{{"sampler":0,"target":{{"node":2,"path":"rotation"}}}},{{"sampler":1,"target":{{"node":1,"path":"translation"}}}}]}}],
            "accessors":[{}],"bufferViews":[{}],"buffers":[{{"byteLength":{}}}]}}"#,
            self.interpolation,
            accessors.join(","),
            views.join(","),
            data.len()
        ));
        glb::glb(&json, &data)
    }

    fn written(&self) -> (tempfile::TempDir, PathBuf) {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("column.glb");
        std::fs::write(&path, self.bytes()).unwrap();
        (folder, path)
    }

    fn load(&self) -> Result<(mesh::Mesh, Option<Skin>), SceneError> {
        mesh::load_animated(&self.written().1, &Animation::Number(0))
    }

    fn error(&self) -> String {
        let error = self.load().unwrap_err().to_string();
        assert!(error.contains("column.glb: "), "{error}");
        error
    }

    /// Asserts that at `time` every vertex is where joints bent by `angle` and shifted along x put it.
    fn assert_bent(&self, time: f64, angle: f32, shift: f32, tolerance: f32) {
        let (mesh, skin) = self.load().unwrap();
        let deformed = skin.unwrap().deform(&mesh, time);
        assert_eq!(mesh.positions.len(), 20);
        for (rest, moved) in mesh.positions.iter().zip(&deformed.positions) {
            let p = armature().inverse().transform_point3(*rest);
            assert!(positions().iter().any(|raw| raw.distance(p) < 1e-5), "{p} is no vertex of the file");
            let bent = Vec3::Y + Quat::from_rotation_x(angle) * (p - Vec3::Y);
            let upper = upper_weight(p.y);
            let expected = armature().transform_point3((1.0 - upper) * p + upper * bent + shift * Vec3::X);
            assert!(moved.distance(expected) < tolerance, "at {time} s {rest} goes to {moved}, not {expected}");
        }
    }
}

#[test]
fn a_column_bends_as_its_joints_say() {
    let column = Column::default();
    for (time, angle, shift) in
        [(-1.0, 0.0, 0.0), (0.0, 0.0, 0.0), (0.75, 0.375, 0.25), (1.0, 0.5, 0.5), (1.5, 0.75, 1.0), (7.0, 1.0, 1.0)]
    {
        column.assert_bent(time, angle * FRAC_PI_2, shift, 1e-5);
    }
    let (mesh, skin) = column.load().unwrap();
    assert_eq!(skin.unwrap().last_key_secs(), 2.0);
    // Without an animation the mesh is where its joints are in the document, which is the rest of the animated one.
    let still = mesh::load(&column.written().1).unwrap();
    assert_eq!((still.positions.len(), &still.triangles), (20, &mesh.triangles));
    assert!(still.positions.iter().zip(&mesh.positions).all(|(a, b)| a.distance(*b) < 1e-5));
}

#[test]
fn steps_are_exact_and_splines_follow_their_cubic() {
    let step = Column { interpolation: "STEP", ..Column::default() };
    step.assert_bent(1.0, 0.0, 0.5, 1e-5);
    step.assert_bent(2.0_f64.next_down(), 0.0, 1.0, 1e-5);
    step.assert_bent(2.0, FRAC_PI_2, 1.0, 1e-5);

    // A quarter turn about x, easing in and out: tangents of zero.
    let [a, b] = [0.0, FRAC_PI_2].map(|angle| Quat::from_rotation_x(angle).to_array());
    let upper_values = vec![[0.0; 4], a, [0.0; 4], [0.0; 4], b, [0.0; 4]];
    let spline = Column { interpolation: "CUBICSPLINE", upper_values, ..Column::default() };
    for time in [0.0, 0.31, 1.0, 1.77, 2.0_f32] {
        let x = 0.5 * time;
        let eased = 3.0 * x * x - 2.0 * x * x * x;
        let at = Quat::from_array(std::array::from_fn(|i| (1.0 - eased) * a[i] + eased * b[i])).normalize();
        spline.assert_bent(time.into(), 2.0 * at.x.atan2(at.w), (time - 0.5).clamp(0.0, 1.0), 3e-4);
    }
}

#[test]
fn quaternions_of_either_sign_turn_the_shorter_way() {
    let mut column = Column::default();
    column.upper_values[1] = column.upper_values[1].map(|x| -x);
    column.assert_bent(1.0, 0.5 * FRAC_PI_2, 0.5, 1e-5);
}

#[test]
fn normalized_whole_numbers_are_fractions() {
    // Weights as bytes: both joints alike.
    let edit = r#""count":21,"type":"VEC4"},{"bufferView":3,"componentType":5126"#;
    let mut column = Column::edited(edit, r#""count":21,"type":"VEC4"},{"bufferView":3,"componentType":5121"#);
    column.weights = std::iter::repeat_n(f32::from_le_bytes([200, 0, 200, 0]), 84).collect();
    let (_, skin) = column.load().unwrap();
    for influences in skin.unwrap().influences {
        assert_eq!(influences.map(|(_, weight)| weight), [0.5, 0.5, 0.0, 0.0]);
    }
}

#[test]
fn of_more_than_four_joints_the_heaviest_count() {
    let mut column = Column::edited(r#""WEIGHTS_0":3"#, r#""WEIGHTS_0":3,"JOINTS_1":2,"WEIGHTS_1":3"#);
    column.joints = positions().iter().flat_map(|_| [0, 1, 0, 1]).collect();
    column.weights = positions().iter().flat_map(|_| [0.05, 0.1, 0.3, 0.05]).collect();
    let (_, skin) = column.load().unwrap();
    for influences in skin.unwrap().influences {
        let (joints, weights) = (influences.map(|(joint, _)| joint), influences.map(|(_, weight)| weight));
        assert!(joints[0] == joints[1] && joints[2] == joints[3] && joints[0] != joints[2]);
        for (weight, expected) in weights.iter().zip([0.375, 0.375, 0.125, 0.125]) {
            assert!((weight - expected).abs() < 1e-6, "{weights:?}");
        }
    }
}

#[test]
fn meshes_without_a_skin_follow_their_node() {
    // A second column, twice as high, hangs below `lower` as a whole.
    let child = r#""name":"lower","children":[2,4]"#;
    let node = r#""translation":[100,0,0]},{"name":"rigid","mesh":1,"scale":[1,2,1]}],"#;
    let meshes = r#""meshes":[{"primitives":[{"attributes":{"POSITION":0,"NORMAL":9},"indices":1}]},"#;
    let edit = move |json: String| {
        let json = json.replace(r#""name":"lower","children":[2]"#, child);
        let json = json.replace(r#""translation":[100,0,0]}],"#, node).replace(r#""meshes":["#, meshes);
        // The skinned one is now the second, the rigid one the first.
        json.replace(r#""name":"column","mesh":0"#, r#""name":"column","mesh":1"#)
            .replace(r#""name":"rigid","mesh":1"#, r#""name":"rigid","mesh":0"#)
    };
    let column = Column { edit: Box::new(edit), ..Column::default() };
    let (mesh, skin) = column.load().unwrap();
    assert_eq!(mesh.positions.len(), 40);
    let skin = skin.unwrap();
    let deformed = skin.deform(&mesh, 2.0);
    let mut rigid = 0;
    for ((rest, moved), influences) in mesh.positions.iter().zip(&deformed.positions).zip(&skin.influences) {
        let p = armature().inverse().transform_point3(*rest);
        let shifted = armature().transform_point3(p + Vec3::X);
        if influences[0].1 == 1.0 && moved.distance(shifted) < 1e-5 {
            rigid += 1;
        }
    }
    // All of the rigid column; of the skinned one the two rings that hang on `lower` alone.
    assert_eq!(rigid, 20 + 8);
}

#[test]
fn linear_scales_stay_linear() {
    // `lower` grows from 1 to 4 and doesn't slide.
    let mut column = Column::edited(r#""node":1,"path":"translation""#, r#""node":1,"path":"scale""#);
    column.upper_values[1] = column.upper_values[0];
    let mut bytes = column.bytes();
    let from: Vec<u8> = [0.0_f32, 0.0, 0.0, 1.0, 0.0, 0.0].iter().flat_map(|x| x.to_le_bytes()).collect();
    let to: Vec<u8> = [1.0_f32, 1.0, 1.0, 4.0, 4.0, 4.0].iter().flat_map(|x| x.to_le_bytes()).collect();
    let place = (0..bytes.len()).rfind(|&i| bytes[i..].starts_with(&from)).unwrap();
    bytes[place..place + to.len()].copy_from_slice(&to);
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("column.glb");
    std::fs::write(&path, &bytes).unwrap();
    let (mesh, skin) = mesh::load_animated(&path, &Animation::Name("bend".to_owned())).unwrap();
    let skin = skin.unwrap();
    for (time, scale) in [(0.5, 1.0), (0.75, 1.75), (1.0, 2.5), (1.4, 3.7), (2.0, 4.0)] {
        let deformed = skin.deform(&mesh, time);
        for (rest, moved) in mesh.positions.iter().zip(&deformed.positions) {
            let p = armature().inverse().transform_point3(*rest);
            let expected = armature().transform_point3(scale * p);
            assert!(moved.distance(expected) < 5e-4, "at {time} s {rest} goes to {moved}, not {expected}");
        }
    }
}

#[test]
fn what_stands_still_is_a_pose() {
    let mut column = Column::edited(r#""node":1,"path":"translation""#, r#""node":3,"path":"translation""#);
    column.upper_values[0] = column.upper_values[1];
    let (mesh, skin) = column.load().unwrap();
    assert!(skin.is_none());
    let top = Vec3::Y + Quat::from_rotation_x(FRAC_PI_2) * Vec3::new(0.2, 1.0, 0.2);
    let expected = armature().transform_point3(top);
    assert!(mesh.positions.iter().any(|p| p.distance(expected) < 1e-5));
    assert!(mesh.normals.iter().all(|n| (n.length() - 1.0).abs() < 1e-5));
}

fn scene(column: &Column, animation: &str) -> Result<Scene, SceneError> {
    let (folder, _) = column.written();
    let path = folder.path().join("s.toml");
    std::fs::write(&path, format!("[[object]]\nmesh = \"column.glb\"\nspheres = 4\n{animation}\n")).unwrap();
    file::load(&path)
}

#[test]
fn scene_files_choose_an_animation_by_number_or_name() {
    let column = Column::default();
    let still = scene(&column, "").unwrap();
    assert!(still.objects[0].skin.is_none() && still.frame_count == 1);
    for animation in ["animation = 0", "animation = \"bend\""] {
        let scene = scene(&column, animation).unwrap();
        assert_eq!((scene.frame_count, scene.objects[0].skin.is_some()), (61, true), "{animation}");
        let (start, end) = (scene.frame(0), scene.frame(60));
        assert_eq!(start.positions(0).len(), scene.objects[0].mesh.positions.len());
        // The column lies along -z, and its upper half bends until it hangs.
        let low = |frame: &halfshade_scene::Frame<'_>| frame.positions(0).iter().map(|p| p.y).fold(f32::MAX, f32::min);
        assert!((low(&start) - 2.9).abs() < 1e-5, "{}", low(&start));
        assert!((low(&end) - 3.0).abs() > 0.05, "{}", low(&end));
    }
    let shared = "animation = 0\n[[object]]\nmesh = \"column.glb\"\nanimation = 0\n[[object]]\nmesh = \"column.glb\"";
    let scene = scene(&column, shared).unwrap();
    let [a, b, c] = [0, 1, 2].map(|object| &scene.objects[object]);
    assert!(std::sync::Arc::ptr_eq(&a.mesh, &b.mesh) && !std::sync::Arc::ptr_eq(&a.mesh, &c.mesh));
    assert!(b.skin.is_some() && c.skin.is_none());
}

#[test]
fn what_a_file_lacks_is_named_with_the_line_that_asks() {
    let column = Column::default();
    for (animation, parts) in [
        ("animation = 1", &["s.toml:4:13: ", "column.glb: ", "no animation 1", "0 (`bend`)"][..]),
        ("animation = \"walk\"", &["s.toml:4:13: ", "no animation `walk`", "0 (`bend`)"]),
        ("animation = 0.5", &["s.toml:4:13: ", "must be a whole number or a text in quotes"]),
    ] {
        let error = scene(&column, animation).unwrap_err().to_string();
        assert!(parts.iter().all(|part| error.contains(part)), "{animation}: {error}");
    }
    let bare = scene(&Column::edited(r#""mesh":0,"skin":0"#, r#""mesh":0"#), "animation = 0").unwrap_err().to_string();
    assert!(bare.contains("s.toml:4:13: ") && bare.contains("no skin") && bare.contains("keyframe"), "{bare}");
    let still = Column {
        edit: Box::new(|json| {
            let (start, end) = (json.find(r#""animations""#).unwrap(), json.find(r#""accessors""#).unwrap());
            [&json[..start], &json[end..]].concat()
        }),
        ..Column::default()
    };
    assert!(scene(&still, "animation = 0").unwrap_err().to_string().contains("no animations"));
}

#[test]
fn mistakes_in_documents_are_named() {
    for (from, to, parts) in [
        (r#""scale":[0.5,0.5,0.5]"#, r#""scale":[0.5,1,0.5]"#, &["node `armature`", "not uniform: 0.5000, 1.0000"][..]),
        (r#""scale":[0.5,0.5,0.5]"#, r#""scale":[-0.5,0.5,0.5]"#, &["node `armature`", "mirrors"]),
        (r#""scale":[0.5,0.5,0.5]"#, r#""scale":[0,0,0]"#, &["first joint", "flattens"]),
        (
            r#""node":1,"path":"translation""#,
            r#""node":1,"path":"scale""#,
            &["node `lower`", "at 0.5 s", "scale is zero"],
        ),
        (r#""node":1,"path":"translation""#, r#""node":1,"path":"rotation""#, &["accessor 8", "Vec4"]),
        (r#""node":1,"path":"translation""#, r#""node":3,"path":"weights""#, &["node `column`", "morph targets"]),
        (r#""node":1,"path":"translation""#, r#""node":1,"path":"colour""#, &["glTF doesn't know"]),
        (r#""node":1,"path":"translation""#, r#""node":9,"path":"translation""#, &["node 9", "doesn't exist"]),
        (
            r#""sampler":1,"target":{"node":1,"path":"translation"}"#,
            r#""sampler":0,"target":{"node":2,"path":"rotation"}"#,
            &["two channels", "rotation"],
        ),
        (r#""sampler":1"#, r#""sampler":7"#, &["no valid glTF"]),
        (r#""name":"upper""#, r#""name":"upper","children":[1]"#, &["node `lower`", "two parents"]),
        (r#"{"name":"armature""#, r#"{"children":[4],"name":"armature""#, &["valid glTF"]),
        (r#""nodes":[{"name""#, r#""nodes":[{"name":"root"},{"name""#, &["node `armature`"]),
        (r#""joints":[1,2]"#, r#""joints":[1,9]"#, &["no valid glTF"]),
        (r#""joints":[1,2]"#, r#""joints":[1,2,0]"#, &["skin 0", "2 inverse bind matrices for 3 joints"]),
        (r#""joints":[1,2]"#, r#""joints":[]"#, &["skin 0", "no joints"]),
        (r#""joints":[1,2]"#, r#""joints":[1]"#, &["vertex 0", "joint 1", "only 1"]),
        (r#""inverseBindMatrices":4"#, r#""inverseBindMatrices":3"#, &["accessor 3", "Mat4"]),
        (r#","WEIGHTS_0":3"#, "", &["lacks JOINTS_0 and WEIGHTS_0"]),
        (r#""JOINTS_0":2,"WEIGHTS_0":3"#, r#""JOINTS_0":3,"WEIGHTS_0":3"#, &["accessor 3", "F32"]),
        (r#""JOINTS_0":2,"WEIGHTS_0":3"#, r#""JOINTS_0":2,"WEIGHTS_0":6"#, &["2 weights", "21 positions"]),
        (r#""input":5,"output":6"#, r#""input":7,"output":3"#, &["node `upper`", "21 values for 2 times"]),
        (r#""input":5,"output":6"#, r#""input":8,"output":6"#, &["accessor 8", "Scalar"]),
    ] {
        let error = Column::edited(from, to).error();
        assert!(parts.iter().all(|part| error.contains(part)), "{to}: {error}");
    }
}

#[test]
fn loops_of_nodes_outside_of_the_scene_are_named() {
    // The armature hangs on itself and is in no scene; the mesh is.
    let edit = |json: String| {
        json.replace(r#""scenes":[{"nodes":[0]}]"#, r#""scenes":[{"nodes":[3]}]"#)
            .replace(r#""children":[1,3]"#, r#""children":[1]"#)
            .replace(r#""name":"upper""#, r#""name":"upper","children":[0]"#)
    };
    let error = Column { edit: Box::new(edit), ..Column::default() }.error();
    assert!(error.contains("node `armature`") && error.contains("ancestor"), "{error}");
}

#[test]
fn mistakes_in_numbers_are_named() {
    let error = |change: fn(&mut Column)| {
        let mut column = Column::default();
        change(&mut column);
        column.error()
    };
    for (change, parts) in [
        ((|c| c.weights[8] = f32::NAN) as fn(&mut Column), &["element 2", "accessor 3", "not finite"][..]),
        (|c| c.weights[8] = -0.5, &["vertex 2", "-0.5"]),
        (|c| c.weights[20..24].fill(0.0), &["vertex 5", "all zero"]),
        (|c| c.joints[4] = 2, &["vertex 1", "joint 2", "only 2"]),
        (|c| drop(c.joints.drain(..4)), &["20 joints", "21 positions"]),
        (|c| c.inverse_binds.truncate(1), &["1 inverse bind matrices for 2"]),
        (|c| c.inverse_binds[0] = Mat4::ZERO, &["first joint", "node `lower`"]),
        (|c| c.inverse_binds[1] = Mat4::ZERO, &["node `upper`", "not affine"]),
        (|c| c.inverse_binds[1] = Mat4::from_scale(Vec3::new(-1.0, 1.0, 1.0)), &["node `upper`", "mirrors"]),
        (|c| c.inverse_binds[1].w_axis.x = f32::INFINITY, &["element 1", "not finite"]),
        (|c| c.inverse_binds[1].w_axis.x = 1e30, &["too far out"]),
        (|c| c.upper_times[1] = 0.0, &["key 1", "not later"]),
        (|c| c.upper_times[1] = f32::NAN, &["not finite"]),
        (|c| c.upper_times.clear(), &["no keys"]),
        (|c| c.upper_values[1] = [0.0; 4], &["zero quaternion"]),
        (|c| c.interpolation = "CUBICSPLINE", &["2 values for 2 times", "3 per time"]),
        (|c| c.interpolation = "CUBIC", &["no valid glTF"]),
    ] {
        let error = error(change);
        assert!(parts.iter().all(|part| error.contains(part)), "{parts:?}: {error}");
    }
}

proptest! {
    #![proptest_config(ProptestConfig { cases: 3000, failure_persistence: None, ..ProptestConfig::default() })]

    /// Bytes and digits changed: nothing panics, errors name the file, and what loads moves to finite places.
    #[test]
    fn no_damage_makes_skins_panic(
        edits in prop::collection::vec((any::<prop::sample::Index>(), 0..4_u8, any::<u8>()), 1..5),
        interpolation in prop::sample::select(vec!["LINEAR", "STEP", "CUBICSPLINE"]),
    ) {
        let mut column = Column { interpolation, ..Column::default() };
        if interpolation == "CUBICSPLINE" {
            column.upper_values = column.upper_values.into_iter().flat_map(|value| [[0.5; 4], value, [0.5; 4]]).collect();
        }
        let mut bytes = column.bytes();
        for (place, kind, value) in edits {
            let start = place.index(bytes.len());
            match kind {
                0 => bytes[start] = value,
                1 => bytes[start] ^= 1 << (value % 8),
                // A digit for a digit: plausible numbers that are wrong.
                _ => if let Some(digit) = bytes[start..].iter_mut().find(|byte| byte.is_ascii_digit()) {
                    *digit = b'0' + value % 10;
                },
            }
        }
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("column.glb");
        std::fs::write(&path, &bytes).unwrap();
        match mesh::load_animated(&path, &Animation::Number(0)) {
            Err(error) => prop_assert!(error.to_string().starts_with(&path.display().to_string()), "{error}"),
            Ok((mesh, skin)) => {
                let skin = skin.unwrap_or_default();
                prop_assert!(skin.influences.is_empty() || skin.influences.len() == mesh.positions.len());
                for time in [0.0, 0.7, 1.3] {
                    let deformed = skin.deform(&mesh, time);
                    prop_assert!(deformed.positions.iter().chain(&deformed.normals).all(|p| p.is_finite()));
                }
            }
        }
    }
}
