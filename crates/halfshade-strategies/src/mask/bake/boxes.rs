//! Objects without spheres that are boxes: the ground that scenes stand on, walls.

use glam::Vec3;
use halfshade_scene::{Mesh, Object};

/// A box in the space of its object.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct SolidBox {
    pub(crate) center: Vec3,
    pub(crate) half: Vec3,
}

/// The box that an object is, if it has no spheres and doesn't deform.
pub(crate) fn solid_box(object: &Object) -> Option<SolidBox> {
    if object.sphere_count > 0 || object.skin.is_some() || object.mesh.has_cutouts() {
        return None;
    }
    box_of(&object.mesh)
}

/// The box whose faces a mesh covers, and nothing else; one of its sizes may be 0.
fn box_of(mesh: &Mesh) -> Option<SolidBox> {
    let (low, high) = mesh.bounds()?;
    let size = high - low;
    let slack = 1e-5 * size.max_element();
    if !(slack > 0.0 && slack.is_finite()) {
        return None;
    }
    let mut covered = [[0.0f32; 2]; 3];
    for corners in &mesh.triangles {
        let [a, b, c] = corners.map(|corner| mesh.positions[corner as usize]);
        let area = 0.5 * (b - a).cross(c - a).length();
        let lies_on = |axis: usize, level: Vec3| [a, b, c].iter().all(|p| (p[axis] - level[axis]).abs() <= slack);
        let face =
            (0..3).find_map(|axis| [low, high].iter().position(|&level| lies_on(axis, level)).map(|end| (axis, end)));
        match face {
            Some((axis, end)) => covered[axis][end] += area,
            None if area <= slack * slack => {}
            None => return None,
        }
    }
    let is_covered = |axis: usize| {
        let whole = size[(axis + 1) % 3] * size[(axis + 2) % 3];
        let is_flat = size[axis] <= slack;
        let least = if is_flat { covered[axis][0] + covered[axis][1] } else { covered[axis][0].min(covered[axis][1]) };
        least >= 0.999 * whole || whole <= slack * size.max_element()
    };
    (0..3).all(is_covered).then(|| SolidBox { center: 0.5 * (low + high), half: 0.5 * size })
}

#[cfg(test)]
mod tests {
    use super::*;
    use halfshade_scene::builtin::shapes;

    #[test]
    fn boxes_and_rectangles_are_found_and_nothing_else() {
        let slab = box_of(&shapes::slab(Vec3::new(2.0, 0.1, 1.0), [5, 4])).unwrap();
        assert!(slab.half.distance(Vec3::new(2.0, 0.1, 1.0)) < 1e-6 && slab.center.length() < 1e-6);
        let plane = box_of(&shapes::plane(3)).unwrap();
        assert!(plane.half.distance(Vec3::new(1.0, 0.0, 1.0)) < 1e-6);
        let mut holed = shapes::slab(Vec3::ONE, [3, 3]);
        holed.triangles.pop();
        for mesh in [shapes::sphere(6), holed, Mesh::default()] {
            assert_eq!(box_of(&mesh), None);
        }
    }
}
