//! pbrt's scenes.

use super::{load, notes, read, write};
use glam::Vec3;
use halfshade_scene::light::DistantLight;
use halfshade_scene::{ExrFacts, Scene, SphereLight, exr_bytes};

/// A scene with a triangle, a camera, and whatever else.
fn scene_with(rest: &str) -> String {
    format!(
        "# a triangle\nLookAt 0 0 4  0 0 0  0 1 0\nCamera \"perspective\" \"float fov\" [60]\n\
         Film \"rgb\" \"integer xresolution\" 32 \"integer yresolution\" [16]\nWorldBegin\n\
         Shape \"trianglemesh\" \"point3 P\" [-1 0 0 1 0 0 0 1 0]\n{rest}\n"
    )
}

fn bounds(scene: &Scene, object: usize) -> (Vec3, Vec3) {
    scene.objects[object].mesh.bounds().unwrap()
}

#[test]
fn shapes_transforms_materials_and_lights_are_what_pbrt_means() {
    let text = scene_with(
        "Material \"diffuse\" \"rgb reflectance\" [0.25 0.5 0.75]\nAttributeBegin\nTranslate 1 2 3\nScale 2 2 2\nShape \"sphere\"\n\
         AreaLightSource \"diffuse\" \"rgb L\" [1 2 3] \"float scale\" 2\nShape \"sphere\" \"float radius\" .25\nAttributeEnd\n\
         ObjectBegin \"o\"\nTranslate 0 0 1\nShape \"sphere\" \"float radius\" 0.5\nObjectEnd\n\
         AttributeBegin Translate 0 7 0 Rotate 90 1 0 0 ObjectInstance \"o\" AttributeEnd ObjectInstance \"o\"\n\
         LightSource \"infinite\" \"rgb L\" [4 5 6]\nIntegrator \"path\" \"integer maxdepth\" 3",
    );
    let scene = read("a.pbrt", &text).unwrap();
    // pbrt's space is left-handed: its picture is ours once x is mirrored.
    let (min, max) = bounds(&scene, 1);
    assert!(
        min.distance(Vec3::new(-3.0, 0.0, 1.0)) < 0.02 && max.distance(Vec3::new(1.0, 4.0, 5.0)) < 0.02,
        "{min} {max}"
    );
    assert_eq!(scene.objects[1].material.albedo, Vec3::new(0.25, 0.5, 0.75));
    let light = SphereLight { center: Vec3::new(-1.0, 2.0, 3.0), radius: 0.5, radiance: Vec3::new(2.0, 4.0, 6.0) };
    let found = scene.frame(0).lights[0];
    assert!(found.center == light.center && (found.radius - 0.5).abs() < 1e-6 && found.radiance == light.radiance);
    for (object, center) in [(2, Vec3::new(0.0, 6.0, 0.0)), (3, Vec3::Z)] {
        let (min, max) = bounds(&scene, object);
        assert!((0.5 * (min + max)).distance(center) < 0.01, "{object}: {min} {max}");
    }
    assert!(matches!(scene.environment.base, DistantLight::Constant(radiance) if radiance == Vec3::new(4.0, 5.0, 6.0)));
    // The angle is that of the shorter side.
    assert_eq!((scene.camera.vertical_fov_degrees, scene.camera.resolution, scene.bounces), (60.0, [32, 16], 2));
    assert_eq!(scene.camera.eye, Vec3::new(0.0, 0.0, 4.0));
    // Without normals triangles are flat, and they face the camera still.
    assert!(scene.objects[0].mesh.normals.iter().all(|normal| normal.abs() == Vec3::Z));
}

#[test]
fn z_may_be_up_and_the_space_right_handed() {
    let text = "Scale -1 1 1 LookAt 5 0 1 0 0 1 0 0 1 Camera \"perspective\" WorldBegin Shape \"sphere\" \
                Translate 0 2 3 Shape \"sphere\"";
    let scene = read("a.pbrt", text).unwrap();
    let (min, max) = bounds(&scene, 1);
    let center = 0.5 * (min + max);
    // z has become y, and what lay to the right of the camera still does.
    assert!((center.y - 3.0).abs() < 0.01, "{center}");
    let right = (scene.camera.target - scene.camera.eye).cross(Vec3::Y);
    assert!(center.dot(right) > 0.0, "{center} {:?}", scene.camera);
}

#[test]
fn files_beside_the_scene_are_read() {
    let folder = tempfile::tempdir().unwrap();
    let ply = "ply\nformat ascii 1.0\nelement vertex 4\nproperty float x\nproperty float y\nproperty float z\nelement face 2\n\
               property list uchar int vertex_indices\nend_header\n0 0 0\n1 0 0\n1 1 0.5\n0 1 0\n3 0 1 2\n3 0 2 3\n";
    write(folder.path(), "meshes/m.ply", ply);
    let pixels: Vec<Vec3> = (0..256).map(|i| if i == 8 * 16 + 15 { Vec3::splat(9.0) } else { Vec3::ZERO }).collect();
    write(folder.path(), "sky.exr", exr_bytes([16, 16], &[("", &pixels)], ExrFacts::default()).unwrap());
    write(folder.path(), "more.pbrt", "Shape \"plymesh\" \"string filename\" \"meshes/m.ply\"\nShape \"cone\"");
    write(
        folder.path(),
        "a.pbrt",
        "WorldBegin\nLightSource \"infinite\" \"string filename\" \"sky.exr\" \"float scale\" 2\nInclude \"more.pbrt\"\n",
    );
    let scene = load(&folder.path().join("a.pbrt")).unwrap();
    // Faceted: each triangle has its own vertices.
    assert_eq!((scene.objects[0].mesh.positions.len(), scene.objects[0].name.as_str()), (6, "m"));
    let DistantLight::Map(map) = &scene.environment.base else { panic!("no map") };
    // The middle of the right edge is +x.
    assert_eq!(map.radiance(Vec3::new(1.0, 0.02, 0.02).normalize()), Vec3::splat(18.0));
    assert_eq!(map.radiance(Vec3::NEG_X), Vec3::ZERO);
    assert!(scene.notes.iter().any(|note| note.contains("more.pbrt:2: shape `cone` left out")), "{:?}", scene.notes);
    write(folder.path(), "more.pbrt", "Include \"a.pbrt\"");
    let error = load(&folder.path().join("a.pbrt")).unwrap_err().to_string();
    assert!(error.contains("circle"), "{error}");
}

#[test]
fn what_is_left_out_is_told_with_its_line() {
    let scene = read(
        "a.pbrt",
        &scene_with(
            "Shape \"disk\"\nLightSource \"distant\"\nMaterial \"conductor\" \"spectrum eta\" \"metal-Cu-eta\"\n\
             AreaLightSource \"diffuse\" \"blackbody L\" 6500\nShape \"trianglemesh\" \"point3 P\" [0 0 0 1 0 0 0 1 0]\n\
             MediumInterface \"fog\" \"\"\nMaterial \"interface\"\nShape \"sphere\"\nSampler \"halton\" \"integer pixelsamples\" 64",
        ),
    )
    .unwrap();
    for (line, part) in [
        (7, "shape `disk` left out"),
        (8, "light source `distant` left out"),
        (9, "material `conductor` left out"),
        (10, "spectrum left out"),
        (11, "its light is left out"),
        (12, "media"),
    ] {
        assert!(notes(&scene, line, part), "{line} {part}: {:?}", scene.notes);
    }
    assert_eq!((scene.objects.len(), scene.bounces), (2, 4));
}

#[test]
fn mistakes_are_named_with_their_line() {
    for (rest, line, part) in [
        ("Shape", 8, "the kind of Shape"),
        ("\nNonsense \"a\"", 8, "no directive"),
        ("AttributeEnd", 7, "hasn't begun"),
        ("ObjectInstance \"x\"", 7, "no object `x`"),
        ("NamedMaterial \"x\"", 7, "no material `x`"),
        ("CoordSysTransform \"x\"", 8, "no space `x`"),
        ("Include \"no.pbrt\"", 7, "no.pbrt"),
        ("Shape \"trianglemesh\"", 7, "no points"),
        ("Shape \"trianglemesh\" \"point3 P\" [0 0 0 1 0 0]\n\"integer indices\" [0 1 2]", 8, "index 2"),
        ("Shape \"trianglemesh\" \"point3 P\" [0 0]", 7, "aren't three"),
        ("Shape \"plymesh\" \"string filename\" \"no.ply\"", 7, "no.ply"),
        ("Shape \"sphere\" \"float radius\" -1", 7, "not positive"),
        ("Scale 0 1 1 Shape \"sphere\"", 7, "flattens"),
        ("Material \"diffuse\" \"rgb reflectance\" [2 0 0]", 7, "[0, 1]"),
        ("LightSource \"infinite\" \"rgb L\" [1 1]", 7, "red, green and blue"),
        ("Rotate 1 0 0 0", 8, "axis"),
        ("Translate 1 2", 8, "needs 3"),
    ] {
        let error = read("a.pbrt", &scene_with(rest)).unwrap_err();
        assert!(error.line == Some(line) && error.to_string().contains(part), "{rest}: {error}");
        assert!(error.to_string().contains("a.pbrt"), "{error}");
    }
    let deep = "AttributeBegin ".repeat(100);
    assert!(read("a.pbrt", &deep).unwrap_err().to_string().contains("deep"));
}
