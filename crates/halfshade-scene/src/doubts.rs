//! Doubts about a scene: what is allowed but hardly meant, told as notes.

use crate::mesh::winding;
use crate::{Object, Scene};
use glam::DVec3;

/// Ratio of sizes that suggests another unit of length, such as millimetres.
const ODD_RATIO: f64 = 100.0;

/// Notes on objects that are far larger or far smaller than all others: `sizes` are of all objects, and those `from_file` may have
/// been made in another unit of length.
pub(crate) fn odd_sizes(objects: &[Object], sizes: &[f64], from_file: &[bool]) -> Vec<String> {
    let note = |i: usize| {
        let others = || (0..sizes.len()).filter(|&other| other != i).map(|other| sizes[other]);
        let (smallest, largest) = (others().reduce(f64::min)?, others().reduce(f64::max)?);
        let (ratio, word) = match sizes[i] {
            size if size > ODD_RATIO * largest => (size / largest, "larger"),
            size if ODD_RATIO * size < smallest => (smallest / size, "smaller"),
            _ => return None,
        };
        let name = &objects[i].name;
        Some(format!(
            "`{name}` is {:.3} in size, {ratio:.0} times {word} than all others; if that isn't meant, give it `scale`, or \
             `unit_size = true`",
            sizes[i]
        ))
    };
    (0..sizes.len()).filter(|&i| from_file[i]).filter_map(note).collect()
}

/// A note where the camera is inside of an object, from which it sees nothing else.
pub fn camera_inside(scene: &Scene) -> Option<String> {
    let frame = scene.frame(0);
    let holds_eye = |number: usize| {
        let (object, positions) = (&scene.objects[number], frame.positions(number));
        let eye = frame.world_from_object[number].inverse().transform_point(scene.camera.eye);
        let is_near =
            crate::mesh::bounds(positions).is_some_and(|(min, max)| eye.cmpge(min).all() && eye.cmple(max).all());
        let corners = object.mesh.triangles.iter().map(|triangle| triangle.map(|v| positions[v as usize]));
        is_near && winding(corners, DVec3::from(eye)).abs() > 0.5
    };
    let around = (0..scene.objects.len()).find(|&number| holds_eye(number))?;
    let name = &scene.objects[around].name;
    Some(format!("the camera's eye is inside `{name}`; if that isn't meant, move it out"))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::{Environment, Pose, builtin::shapes};
    use glam::Vec3;

    fn scene() -> Scene {
        let ball = Object::new("ball", shapes::sphere(4)).pose(Pose::from_translation(Vec3::Y));
        let ground = Object::new("ground", shapes::plane(2));
        Scene::at_rest("s", vec![ground, ball], Environment::constant(Vec3::ONE))
    }

    #[test]
    fn eyes_inside_of_objects_are_noted() {
        let at = |eye: Vec3| {
            let mut scene = scene();
            scene.camera.eye = eye;
            camera_inside(&scene)
        };
        assert!(at(Vec3::new(0.2, 1.5, 0.0)).is_some_and(|note| note.contains("inside `ball`")));
        // Beside it, within its box; on the ground; far away.
        for eye in [Vec3::new(0.8, 1.8, 0.8), Vec3::new(0.5, 0.0, 0.5), 9.0 * Vec3::Y] {
            assert_eq!(at(eye), None, "{eye}");
        }
    }

    #[test]
    fn only_meshes_of_files_are_odd_and_only_beside_others() {
        let objects = scene().objects;
        let notes = |sizes: [f64; 2], from_file: [bool; 2]| odd_sizes(&objects, &sizes, &from_file);
        let note = notes([2.0, 250.0], [false, true]).remove(0);
        assert!(note.starts_with("`ball` is 250.000 in size, 125 times larger than all others; "), "{note}");
        assert!(notes([2.0, 0.01], [false, true])[0].contains("200 times smaller"));
        for (sizes, from_file) in [([2.0, 190.0], [true; 2]), ([2.0, 250.0], [false; 2]), ([2.0, 0.03], [true; 2])] {
            assert_eq!(notes(sizes, from_file), [""; 0]);
        }
        assert_eq!(odd_sizes(&objects[..1], &[1e9], &[true]), [""; 0]);
    }
}
