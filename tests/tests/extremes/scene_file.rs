//! A drawn scene as files that the program can open: its frame as it stands, without movement.
//!
//! Spheres are built anew from the meshes when the program opens it. A sun, and an environment that is turned, become a map.

use crate::scene::Drawn;
use exr::prelude::write_rgb_file;
use glam::{Quat, Vec3};
use halfshade_scene::{
    Frame, LafortuneLobe, Material, Pose, Reflectance,
    light::{DistantLight, EnvironmentMap},
};
use std::{fmt::Write, fs, io, path::Path};

/// Rows of a map that is written: a multiple of those of all drawn maps.
const ROWS: usize = 64;

/// Writes `scene.toml` and what it names into `folder`; `notes` become comments.
pub(crate) fn write(drawn: &Drawn, folder: &Path, notes: &str) -> io::Result<()> {
    fs::create_dir_all(folder)?;
    let frame = drawn.frame(Quat::IDENTITY);
    let mut text: String = notes.lines().map(|line| format!("# {line}\n")).collect();
    text += &format!("name = \"extreme-{}\"\nbounces = {}\n", drawn.seed, drawn.scene.bounces);
    for (number, object) in drawn.scene.objects.iter().enumerate() {
        if object.mesh.triangles.is_empty() {
            text += &format!("# Object {number} has no triangle and is left out.\n");
            continue;
        }
        let name = format!("object-{number}.obj");
        fs::write(folder.join(&name), obj(&frame, number))?;
        text += &format!(
            "[[object]]\nmesh = \"{name}\"\nname = \"{}\"\nspheres = {}\nclusters = {}\n",
            object.name, object.sphere_count, object.cluster_count
        );
        text += &material(&object.material);
        text += &pose(&frame.world_from_object[number]);
    }
    for light in &frame.lights {
        text += &format!(
            "[[light]]\nsphere = {{ center = {}, radius = {:?} }}\nradiance = {}\n",
            list(light.center),
            light.radius,
            list(light.radiance)
        );
    }
    text += "[environment]\n";
    match (&drawn.scene.environment.base, drawn.scene.environment.sun) {
        (DistantLight::Constant(radiance), None) => text += &format!("constant = {}\n", list(*radiance)),
        _ => {
            let map = environment(&frame);
            let texel = |x: usize, y: usize| map[y * 2 * ROWS + x].into();
            write_rgb_file(folder.join("environment.exr"), 2 * ROWS, ROWS, texel)
                .map_err(|error| io::Error::other(error.to_string()))?;
            text += "image = \"environment.exr\"\n";
        }
    }
    let camera = &drawn.scene.camera;
    let [width, height] = camera.resolution;
    text += &format!(
        "[camera]\neye = {}\ntarget = {}\nvertical_fov_degrees = {:?}\nresolution = [{width}, {height}]\n",
        list(camera.eye),
        list(camera.target),
        camera.vertical_fov_degrees
    );
    fs::write(folder.join("scene.toml"), text)
}

fn list(v: Vec3) -> String {
    format!("[{:?}, {:?}, {:?}]", v.x, v.y, v.z)
}

/// The mesh of an object as it is deformed in the frame.
fn obj(frame: &Frame<'_>, number: usize) -> String {
    let mut text = String::new();
    let mut lines = |kind: &str, vectors: &[Vec3]| {
        for v in vectors {
            let _ = writeln!(text, "{kind} {:?} {:?} {:?}", v.x, v.y, v.z);
        }
    };
    lines("v", frame.positions(number));
    lines("vn", frame.normals(number));
    for triangle in &frame.scene.objects[number].mesh.triangles {
        let [a, b, c] = triangle.map(|vertex| vertex + 1);
        let _ = writeln!(text, "f {a}//{a} {b}//{b} {c}//{c}");
    }
    text
}

fn material(material: &Material) -> String {
    let reflectance = match &material.reflectance {
        Reflectance::Lambert => None,
        Reflectance::Phong { specular, exponent } => {
            Some(format!("model = \"phong\", specular = {}, exponent = {exponent:?}", list(*specular)))
        }
        Reflectance::ModifiedPhong { specular, exponent } => {
            Some(format!("model = \"modified-phong\", specular = {}, exponent = {exponent:?}", list(*specular)))
        }
        Reflectance::Lafortune { lobes } => {
            let lobe = |lobe: &LafortuneLobe| {
                format!(
                    "{{ scale = {}, axis = {}, exponent = {:?} }}",
                    list(lobe.scale),
                    list(lobe.axis),
                    lobe.exponent
                )
            };
            Some(format!("model = \"lafortune\", lobes = [{}]", lobes.iter().map(lobe).collect::<Vec<_>>().join(", ")))
        }
    };
    let reflectance = reflectance.map(|table| format!("reflectance = {{ {table} }}\n"));
    format!("albedo = {}\n{}", list(material.albedo), reflectance.unwrap_or_default())
}

fn pose(pose: &Pose) -> String {
    let (axis, angle) = pose.rotation.to_axis_angle();
    format!(
        "translate = {}\nrotate = [{:?}, {:?}, {:?}, {:?}]\nscale = {:?}\n",
        list(pose.translation),
        axis.x,
        axis.y,
        axis.z,
        angle.to_degrees(),
        pose.scale
    )
}

/// The environment as it stands, a sun too small for a texel spread over one.
fn environment(frame: &Frame<'_>) -> Vec<Vec3> {
    let grid = EnvironmentMap::new(2 * ROWS, ROWS, vec![Vec3::ZERO; 2 * ROWS * ROWS]).expect("as many texels");
    let at = |i: usize| {
        let (column, row) = (i % (2 * ROWS), i / (2 * ROWS));
        grid.direction_at((column as f32 + 0.5) / (2 * ROWS) as f32, (row as f32 + 0.5) / ROWS as f32)
    };
    let mut texels: Vec<Vec3> = (0..2 * ROWS * ROWS).map(|i| frame.environment_radiance(at(i))).collect();
    if let Some(sun) = frame.scene.environment.sun {
        let direction = frame.world_from_environment * sun.direction;
        let height = std::f32::consts::PI / ROWS as f32;
        if sun.angular_radius < height {
            let (column, row) = grid.texel_at(direction);
            let share = std::f64::consts::PI * f64::from(sun.angular_radius).powi(2) / grid.texel_solid_angle(row);
            texels[row * 2 * ROWS + column] += sun.radiance * share as f32;
        }
    }
    texels
}
