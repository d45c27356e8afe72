//! Mitsuba's scenes.

use super::{load, notes, read, write};
use glam::{Quat, Vec3};
use halfshade_scene::light::{DistantLight, EnvironmentMap, Sky};
use halfshade_scene::{
    Camera, Environment, Gloss, GlossVariation, LafortuneLobe, Material, Motion, Object, Pose, ReceiverBuffer,
    ReceiverPoint, Reflectance, Scene, SphereLight, Texture, builtin::shapes, exchange::mitsuba,
};
use std::sync::Arc;

fn turned(object: Object, x: f32) -> Object {
    let rotation = Quat::from_axis_angle(Vec3::new(0.6, 0.8, 0.0), 0.7);
    object.pose(Pose { scale: 0.8, rotation, translation: Vec3::new(x, 0.5, -x) })
}

/// A scene with one of each thing that is written.
fn every_kind() -> Scene {
    let specular = Vec3::new(0.3, 0.2, 0.1);
    let lobe = LafortuneLobe { scale: specular, axis: Vec3::new(-0.9, -0.8, 0.95), exponent: 12.5 };
    let glossy = |reflectance| Material { reflectance, ..Material::new(Vec3::new(0.5, 0.25, 0.125)) };
    let texels = (0..8).map(|i| Vec3::new(i as f32 / 8.0, 0.5, 1.0)).collect();
    let texture = Arc::new(Texture::new(4, 2, texels).unwrap());
    let mut square = shapes::plane(3);
    square.texture_coordinates = square.positions.iter().map(|p| Vec3::new(p.x, 0.25 * p.z, 0.0)).collect();
    let mut spotted = shapes::sphere(3);
    spotted.colors = spotted.positions.iter().map(|p| 0.5 * p.abs()).collect();
    let map = (0..32).map(|i| Vec3::new(i as f32, (i % 3) as f32, 0.125)).collect();
    let light = SphereLight { center: Vec3::new(0.5, 4.0, 0.1), radius: 0.3, radiance: Vec3::new(30.0, 20.0, 10.0) };
    let mut scene = Scene::at_rest(
        "scene",
        vec![
            turned(Object::new("<ball> & \"box\"", shapes::sphere(4)).albedo(Vec3::new(0.7, 0.1, 0.3)), -2.0),
            turned(Object::new("spotted", spotted), 2.0),
            Object::new("floor", square).material(Material { texture: Some(texture), ..Material::new(Vec3::ONE) }),
            turned(
                Object::new("phong", shapes::box_mesh(2))
                    .material(glossy(Reflectance::Phong { specular, exponent: 30.0 })),
                4.0,
            ),
            turned(
                Object::new("modified", shapes::box_mesh(2))
                    .material(glossy(Reflectance::ModifiedPhong { specular, exponent: 7.0 })),
                6.0,
            ),
            turned(
                Object::new("lafortune", shapes::sphere(3))
                    .material(glossy(Reflectance::Lafortune { lobes: vec![lobe, lobe] })),
                8.0,
            ),
        ],
        Environment::map(EnvironmentMap::new(8, 4, map).unwrap()),
    );
    scene.lights.push((light, Motion::Still(Pose::IDENTITY)));
    scene.bounces = 3;
    scene.camera = Camera {
        eye: Vec3::new(3.0, 4.0, 5.0),
        target: Vec3::new(0.25, 0.5, -1.0),
        vertical_fov_degrees: 35.5,
        resolution: [64, 48],
    };
    scene
}

fn written(scene: &Scene, folder: &std::path::Path) -> Vec<String> {
    let exported = mitsuba::export(&scene.frame(0)).unwrap();
    exported.files.iter().for_each(|(name, bytes)| write(folder, name, bytes));
    exported.notes
}

/// The corners of all triangles in world space.
fn corners(scene: &Scene) -> Vec<ReceiverPoint> {
    let vertices = ReceiverBuffer::vertices(&scene.frame(0));
    let mut first = 0;
    let mut corners = Vec::new();
    for object in &scene.objects {
        let triangles = object.mesh.triangles.iter().flatten();
        corners.extend(triangles.map(|vertex| vertices.view().at(first + *vertex as usize)));
        first += object.mesh.positions.len();
    }
    corners
}

#[test]
fn what_is_written_is_read_again() {
    let (scene, folder) = (every_kind(), tempfile::tempdir().unwrap());
    written(&scene, folder.path());
    let read = load(&folder.path().join("scene.xml")).unwrap();
    // Vertices come in another order; triangles don't.
    let (before, after) = (corners(&scene), corners(&read));
    assert_eq!(before.len(), after.len());
    for (a, b) in before.iter().zip(&after) {
        assert_eq!(a.position, b.position);
        // Normals are made unit vectors once more.
        assert!(a.normal.distance(b.normal) < 1e-6 && a.albedo.distance(b.albedo) < 1e-6, "{a:?} {b:?}");
    }
    for (a, b) in scene.objects.iter().zip(&read.objects) {
        assert_eq!(a.material.reflectance, b.material.reflectance, "{}", a.name);
    }
    assert_eq!(scene.objects.len(), read.objects.len());
    assert_eq!(scene.frame(0).lights, read.frame(0).lights);
    assert_eq!((scene.camera, scene.bounces, read.environment_turn), (read.camera, read.bounces, 0.0));
    assert!(scene.environment.is_same_as(&read.environment));
    assert!(read.notes.is_empty(), "{:?}", read.notes);
}

#[test]
fn turned_light_comes_back_turned_and_what_is_approximated_is_told() {
    let mut scene = every_kind();
    scene.environment_turn = 0.75;
    let folder = tempfile::tempdir().unwrap();
    written(&scene, folder.path());
    let read = load(&folder.path().join("scene.xml")).unwrap();
    assert!((read.environment_turn - 0.75).abs() < 1e-5, "{}", read.environment_turn);

    let vertices = vec![Gloss { specular: Vec3::splat(0.5), exponent: 0.25 }; scene.objects[3].mesh.positions.len()];
    let variation = GlossVariation { vertices, ..GlossVariation::default() };
    scene.objects[3].material.gloss_variation = Some(Arc::new(variation));
    scene.environment = Sky { resolution: 8, ..Sky::default() }.environment().unwrap();
    let folder = tempfile::tempdir().unwrap();
    let told = written(&scene, folder.path());
    assert!(told.len() == 2 && told[1].contains("the sun is a sphere"), "{told:?}");
    let read = load(&folder.path().join("scene.xml")).unwrap();
    assert!(matches!(&read.environment.base, DistantLight::Map(map) if map.width() == 16));
    // The sun came back as a lamp, from the same direction and as large.
    let (sun, lamp) = (scene.environment.sun.unwrap(), read.frame(0).lights[0]);
    let toward = (lamp.center - Vec3::new(3.0, 0.5, -3.0)).normalize();
    let turned = Quat::from_rotation_y(0.75) * sun.direction;
    assert!(toward.angle_between(turned) < 1e-3 && lamp.radiance == sun.radiance);
    assert!((lamp.radius / lamp.center.length() / sun.angular_radius - 1.0).abs() < 1e-2);
    let gloss = ["specular_r", "mesh_attribute"].map(|part| read.notes.iter().any(|note| note.contains(part)));
    assert_eq!(gloss, [true; 2], "{:?}", read.notes);
}

/// A scene with a rectangle, a camera along -Z, and whatever else.
fn scene_with(rest: &str) -> String {
    format!(
        "<scene version=\"3.0.0\">\n<default name=\"size\" value=\"32\"/>\n<sensor type=\"perspective\"><float name=\"fov\" value=\"90\"/>\
         <transform name=\"to_world\"><lookat origin=\"0, 0, 4\" target=\"0, 0, 0\" up=\"0, 1, 0\"/></transform>\
         <film type=\"hdrfilm\"><integer name=\"width\" value=\"$size\"/><integer name=\"height\" value=\"16\"/></film></sensor>\n\
         <shape type=\"rectangle\"/>\n{rest}\n</scene>"
    )
}

#[test]
fn shapes_transforms_and_materials_are_what_mitsuba_means() {
    let text = scene_with(
        "<bsdf type=\"phong\" id=\"p\"><rgb name=\"diffuseReflectance\" value=\"#ff0000\"/><rgb name=\"specularReflectance\" value=\"0\"/>\
         <float name=\"exponent\" value=\"9\"/></bsdf>\n<shape type=\"cube\"><transform name=\"toWorld\"><scale x=\"2\"/>\
         <rotate z=\"1\" angle=\"90\"/><translate y=\"5\"/></transform><ref id=\"p\"/></shape>\n\
         <shape type=\"sphere\"><point name=\"center\" x=\"1\"/><float name=\"radius\" value=\"0.5\"/>\
         <transform name=\"to_world\"><scale value=\"2\"/></transform><emitter type=\"area\"><rgb name=\"radiance\" value=\"1 2 3\"/></emitter></shape>\n\
         <integrator type=\"path\"><integer name=\"max_depth\" value=\"4\"/></integrator>",
    );
    let scene = read("a.xml", &text).unwrap();
    let (min, max) = scene.objects[1].mesh.bounds().unwrap();
    assert!(min.distance(Vec3::new(-1.0, 3.0, -1.0)) < 1e-6 && max.distance(Vec3::new(1.0, 7.0, 1.0)) < 1e-6);
    assert_eq!(scene.objects[1].material.albedo, Vec3::X);
    let phong = Reflectance::ModifiedPhong { specular: Vec3::ZERO, exponent: 9.0 };
    assert_eq!((&scene.objects[1].material.reflectance, scene.bounces), (&phong, 2));
    // A rectangle faces +Z, and shines back half of what it gets.
    assert!(scene.objects[0].mesh.normals.iter().all(|normal| *normal == Vec3::Z));
    assert_eq!((scene.objects[0].material.albedo, scene.objects[0].sphere_count), (Vec3::splat(0.5), 0));
    let light = SphereLight { center: Vec3::new(2.0, 0.0, 0.0), radius: 1.0, radiance: Vec3::new(1.0, 2.0, 3.0) };
    assert_eq!(scene.frame(0).lights, [light]);
    // 90 degrees span the width.
    assert!((scene.camera.vertical_fov_degrees - 53.1301).abs() < 1e-3);
    assert_eq!((scene.camera.resolution, scene.camera.target), ([32, 16], Vec3::ZERO));
}

#[test]
fn what_is_left_out_is_told_with_its_line() {
    let scene = read(
        "a.xml",
        &scene_with(
            "<shape type=\"disk\"/>\n<shape type=\"serialized\"/>\n<shape type=\"disk\"/>\n<emitter type=\"point\"/>\n\
             <shape type=\"cube\"><bsdf type=\"roughconductor\"/><emitter type=\"area\"/></shape>\n<medium type=\"homogeneous\"/>\n\
             <include filename=\"b.xml\"/>\n<integrator type=\"path\"/>",
        ),
    )
    .unwrap();
    for (line, part) in [
        (5, "shape `disk` left out (and 1 times after that)"),
        (6, "`serialized`"),
        (8, "emitter `point`"),
        (9, "`roughconductor` left out: diffuse"),
        (9, "its light is left out"),
        (10, "medium `homogeneous`"),
        (11, "element `include`"),
    ] {
        assert!(notes(&scene, line, part), "{line} {part}: {:?}", scene.notes);
    }
    assert_eq!((scene.objects.len(), scene.bounces), (2, 16));
}

#[test]
fn mistakes_are_named_with_their_line() {
    for (rest, line, part) in [
        ("<shape type=\"ply\"/>", 5, "names no file"),
        ("\n<shape type=\"ply\"><string name=\"filename\" value=\"no.ply\"/></shape>", 6, "no.ply"),
        ("<emitter type=\"constant\"><rgb name=\"radiance\" value=\"-1\"/></emitter>", 5, "not negative"),
        ("<emitter type=\"constant\"><rgb name=\"radiance\" value=\"red\"/></emitter>", 5, "no colour"),
        ("<shape type=\"cube\"><transform name=\"to_world\"><scale x=\"0\"/></transform></shape>", 5, "flattens"),
        ("<shape type=\"cube\"><transform name=\"to_world\"><matrix value=\"1 2\"/></transform></shape>", 5, "9 or 16"),
        (
            "<shape type=\"cube\"><transform name=\"to_world\"><translate x=\"1e30\"/></transform></shape>",
            5,
            "farther out",
        ),
        ("<shape type=\"cube\"><transform name=\"to_world\"><rotate angle=\"3\"/></transform></shape>", 5, "axis"),
        (
            "<shape type=\"cube\"><bsdf type=\"diffuse\"><rgb name=\"reflectance\" value=\"2\"/></bsdf></shape>",
            5,
            "[0, 1]",
        ),
        ("<integrator type=\"path\"><integer name=\"max_depth\" value=\"x\"/></integrator>", 5, "no finite number"),
        ("<shape>", 6, "no sound XML"),
    ] {
        let error = read("a.xml", &scene_with(rest)).unwrap_err();
        assert!(error.line == Some(line) && error.to_string().contains(part), "{rest}: {error}");
        assert!(error.to_string().contains("a.xml"), "{error}");
    }
    for (text, part) in
        [("<a/>", "not `scene`"), ("<scene/>", "no meshes"), ("", "no sound XML"), ("\u{1}", "no sound XML")]
    {
        let error = read("a.xml", text).unwrap_err().to_string();
        assert!(error.contains(part), "{text}: {error}");
    }
}
