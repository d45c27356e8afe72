//! glTF files as scenes by themselves: cameras, lights, and parts that move.

use super::glb::Builder;
use glam::Vec3;
use halfshade_scene::light::{DistantLight, KILOCANDELAS_PER_UNIT};
use halfshade_scene::{Environment, Motion, Scene, SceneError, file};
use std::f32::consts::{FRAC_1_SQRT_2, FRAC_PI_2, PI};

/// Two squares, of which the animation moves the second, whose node hangs in a parent; `nodes` and `rest` are further JSON.
fn document(nodes: &str, rest: &str) -> Vec<u8> {
    let mut builder = Builder::default();
    builder.floats("VEC3", &[0.0, 0.0, 0.0, 1.0, 0.0, 0.0, 1.0, 1.0, 0.0, 0.0, 1.0, 0.0]);
    builder.indices(&[0, 1, 2, 0, 2, 3]);
    builder.floats("SCALAR", &[0.0, 2.0]);
    builder.floats("VEC3", &[0.0, 0.0, 0.0, 0.0, 4.0, 0.0]);
    builder.floats("VEC4", &[0.0, 0.0, 0.0, 1.0, 0.0, 0.0, FRAC_1_SQRT_2, FRAC_1_SQRT_2]);
    let count = 4 + nodes.matches("\"name\"").count();
    let roots: Vec<String> = (0..count).filter(|node| *node != 2 && *node != 3).map(|node| node.to_string()).collect();
    builder.glb(&format!(
        r#""scene":0,"scenes":[{{"nodes":[{}]}}],"nodes":[{{"mesh":0,"name":"still"}},{{"name":"parent","children":[2],"translation":[10,0,0],"scale":[2,2,2]}},
        {{"mesh":0,"name":"mover","children":[3]}},{{"mesh":0,"name":"rider","translation":[0,0,1]}}{nodes}],
        "meshes":[{{"primitives":[{{"attributes":{{"POSITION":0}},"indices":1}}]}}]{rest}"#,
        roots.join(",")
    ))
}

const MOVES: &str = r#","animations":[{"samplers":[{"input":2,"output":3}],"channels":[{"sampler":0,"target":{"node":2,"path":"translation"}}]}]"#;

fn read(bytes: &[u8], environment: Option<Environment>) -> Result<Scene, SceneError> {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("x.glb");
    std::fs::write(&path, bytes).unwrap();
    file::from_mesh(&path, environment)
}

#[test]
fn what_the_first_animation_moves_as_a_whole_is_an_object_that_moves() {
    let scene = read(&document("", MOVES), None).unwrap();
    let names: Vec<&str> = scene.objects.iter().map(|object| object.name.as_str()).collect();
    assert_eq!((names, scene.frame_count), (vec!["x", "mover", "ground"], 61));
    // The rider rides along.
    assert_eq!(scene.objects[1].mesh.triangles.len(), 4);
    let corner = |frame: usize| scene.frame(frame).world_from_object[1].transform_point(Vec3::new(0.0, 0.0, 1.0));
    assert!(corner(0).distance(Vec3::new(10.0, 0.0, 2.0)) < 1e-5);
    assert!(corner(30).distance(Vec3::new(10.0, 4.0, 2.0)) < 1e-5);
    assert!(corner(60).distance(Vec3::new(10.0, 8.0, 2.0)) < 1e-5);
    assert!(matches!(scene.objects[0].motion, Motion::Still(_)));
    // Without movement all is one mesh.
    let still = read(&document("", ""), None).unwrap();
    assert_eq!((still.objects.len(), still.objects[0].mesh.triangles.len(), still.frame_count), (2, 6, 1));
}

#[test]
fn movements_within_movements_are_followed_and_what_cannot_be_is_told() {
    let both = r#","animations":[{"samplers":[{"input":2,"output":3},{"input":2,"output":4}],"channels":[
        {"sampler":0,"target":{"node":2,"path":"translation"}},{"sampler":1,"target":{"node":1,"path":"rotation"}}]},{"samplers":[],"channels":[]}]"#;
    let scene = read(&document("", both), None).unwrap();
    assert!(scene.notes.iter().any(|note| note.contains("of 2 animations the first")), "{:?}", scene.notes);
    // Half way: the parent has turned by 45 degrees around z, the node has risen by 2 in it.
    let half = scene.frame(30).world_from_object[1].transform_point(Vec3::ZERO);
    let expected = Vec3::new(10.0, 0.0, 0.0) + 2.0 * 2.0 * Vec3::new(-FRAC_1_SQRT_2, FRAC_1_SQRT_2, 0.0);
    assert!(half.distance(expected) < 1e-3, "{half} {expected}");
    // A key in between, where interpolating the ends alone would cut the arc.
    let quarter = scene.frame(15).world_from_object[1].transform_point(Vec3::ZERO);
    let (sin, cos) = (0.25 * FRAC_PI_2).sin_cos();
    assert!(quarter.distance(Vec3::new(10.0 - 2.0 * sin, 2.0 * cos, 0.0)) < 1e-3, "{quarter}");

    // From nothing to a height of 4, which no object can have.
    let bytes = document("", &MOVES.replace("\"path\":\"translation\"", "\"path\":\"scale\""));
    let scene = read(&bytes, None).unwrap();
    assert!(scene.notes.iter().any(|note| note.contains("a movement is left out")), "{:?}", scene.notes);
    assert_eq!(scene.objects.len(), 2);
}

#[test]
fn the_camera_is_the_files() {
    let nodes = format!(
        r#",{{"name":"eye","camera":0,"translation":[1,2,3],"rotation":[0,{FRAC_1_SQRT_2},0,{FRAC_1_SQRT_2}]}},{{"name":"other","camera":0}}"#
    );
    let cameras = r#","cameras":[{"type":"perspective","perspective":{"yfov":0.5,"aspectRatio":2,"znear":0.1}}]"#;
    let scene = read(&document(&nodes, cameras), None).unwrap();
    let camera = scene.camera;
    // It looks along its own -z, which is -x here.
    assert_eq!((camera.eye, camera.resolution), (Vec3::new(1.0, 2.0, 3.0), [1200, 600]));
    assert!((camera.target - camera.eye).normalize().distance(Vec3::NEG_X) < 1e-6);
    assert!((camera.vertical_fov_degrees.to_radians() - 0.5).abs() < 1e-6);
    assert!(scene.notes.iter().any(|note| note.contains("`other`: a further camera left out")), "{:?}", scene.notes);
    let rolled = format!(r#",{{"name":"eye","camera":0,"rotation":[0,0,{FRAC_1_SQRT_2},{FRAC_1_SQRT_2}]}}"#);
    let scene = read(&document(&rolled, cameras), None).unwrap();
    assert!(scene.notes.iter().any(|note| note.contains("roll is left out")), "{:?}", scene.notes);
    let flat = cameras.replace(
        r#""type":"perspective","perspective":{"yfov":0.5,"aspectRatio":2,"znear":0.1}"#,
        r#""type":"orthographic","orthographic":{"xmag":1,"ymag":1,"znear":0.1,"zfar":9}"#,
    );
    let scene = read(&document(r#",{"name":"eye","camera":0}"#, &flat), None).unwrap();
    assert!(scene.notes.iter().any(|note| note.contains("orthographic camera left out")), "{:?}", scene.notes);
}

#[test]
fn punctual_lights_get_a_size_and_keep_their_light() {
    let nodes = r#",{"name":"a","translation":[0,5,0],"extensions":{"KHR_lights_punctual":{"light":0}}},{"name":"b","rotation":[-0.6,0,0,0.8],"extensions":{"KHR_lights_punctual":{"light":1}}},{"name":"c","extensions":{"KHR_lights_punctual":{"light":2}}}"#;
    let lights = r#","extensionsUsed":["KHR_lights_punctual"],"extensions":{"KHR_lights_punctual":{"lights":[{"type":"point","intensity":100,"color":[1,0.5,0]},
        {"type":"directional","intensity":50000,"range":3},{"type":"spot","spot":{}}]}}"#;
    let scene = read(&document(nodes, lights), None).unwrap();
    let light = scene.lights[0].0;
    let candela = 1000.0 * KILOCANDELAS_PER_UNIT as f32 * PI * light.radius.powi(2) * light.radiance;
    assert!(
        candela.distance(Vec3::new(100.0, 50.0, 0.0)) < 1e-2 && light.center == Vec3::new(0.0, 5.0, 0.0),
        "{candela}"
    );
    // Rays go along the node's -z, so that the sun stands towards its z.
    let sun = scene.environment.sun.unwrap();
    assert!(sun.direction.distance(Vec3::new(0.0, 0.96, 0.28)) < 1e-5, "{}", sun.direction);
    // Their light is all there is, unless an environment is given.
    assert!(matches!(scene.environment.base, DistantLight::Constant(Vec3::ZERO)));
    for part in ["`c`: a light of type `spot` left out", "`range`", "spheres of radius"] {
        assert!(scene.notes.iter().any(|note| note.contains(part)), "{part}: {:?}", scene.notes);
    }
    assert!(!scene.notes.iter().any(|note| note.contains("extensions")), "{:?}", scene.notes);
    let given = read(&document(nodes, lights), Some(Environment::constant(Vec3::ONE))).unwrap();
    assert!(matches!(given.environment.base, DistantLight::Constant(Vec3::ONE)) && given.environment.sun.is_some());
    for (from, to, part) in [
        ("\"light\":0", "\"light\":7", "doesn't exist"),
        ("\"light\":0", "\"light\":-1", "doesn't exist"),
        ("[0,5,0]", "[0,1e30,0]", "too far out"),
    ] {
        let error = read(&document(&nodes.replace(from, to), lights), None).unwrap_err().to_string();
        assert!(error.contains(part) && error.contains("`a`"), "{error}");
    }
    let error = read(&document(nodes, &lights.replace("100,", "-1,")), None).unwrap_err().to_string();
    assert!(error.contains("intensity"), "{error}");
}
