//! Rows of the table of transfer vectors: vertex after vertex, object after object; then the backs of those surfaces whose backs
//! light can reach.

use glam::{DVec3, Vec3};
use halfshade_scene::{Frame, Mesh, ReceiverBuffer, mesh::Topology};
use std::sync::Arc;

/// The rows of an object.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) struct ObjectRows {
    /// Row of its first vertex, seen from the side of its normal.
    pub(crate) first: usize,
    /// Its vertices seen from the other side.
    pub(crate) back: Back,
}

/// The other side of a surface.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum Back {
    /// Row of the first vertex.
    Rows(usize),
    /// The inside of a solid: no light reaches it.
    Dark,
    /// As if nothing hid any light.
    Open,
}

/// Places for which transfer is baked, in the world.
#[derive(Debug)]
pub(crate) struct Rows {
    /// Position and normal of each row.
    pub(crate) points: Vec<(Vec3, Vec3)>,
    pub(crate) objects: Vec<ObjectRows>,
}

impl Rows {
    /// The vertices of a frame, with backs or without.
    pub(crate) fn new(frame: &Frame<'_>, with_backs: bool) -> Self {
        let receivers = ReceiverBuffer::vertices(frame);
        let view = receivers.view();
        let mut points: Vec<(Vec3, Vec3)> =
            (0..receivers.len()).map(|i| (view.position_at(i), view.normal_at(i))).collect();
        let mut objects = Vec::new();
        let is_translucent = |number: usize| frame.scene.objects[number].material.subsurface.is_some();
        let mut first = 0;
        for number in 0..frame.scene.objects.len() {
            // Within translucent objects it is dark.
            let is_dark = with_backs || is_translucent(number);
            objects.push(ObjectRows { first, back: if is_dark { Back::Dark } else { Back::Open } });
            first += frame.positions(number).len();
        }
        let mut known: Vec<(Arc<Mesh>, bool)> = Vec::new();
        for (number, rows) in
            objects.iter_mut().enumerate().filter(|(number, _)| with_backs && !is_translucent(*number))
        {
            let mesh = frame.object(number).mesh;
            let same = known.iter().find(|(other, _)| Arc::ptr_eq(other, &mesh)).map(|(_, is_dark)| *is_dark);
            let is_dark = same.unwrap_or_else(|| is_dark_behind(&mesh));
            if same.is_none() {
                known.push((mesh.clone(), is_dark));
            }
            if !is_dark {
                rows.back = Back::Rows(points.len());
                let backs: Vec<_> = points[rows.first..rows.first + mesh.positions.len()].to_vec();
                points.extend(backs.into_iter().map(|(position, normal)| (position, -normal)));
            }
        }
        Self { points, objects }
    }
}

/// Whether the backs of all triangles lie within solids that the mesh encloses, so that no light from infinitely far reaches
/// them: bodies that are closed, wound outward, with normals on the outside, and without holes.
fn is_dark_behind(mesh: &Mesh) -> bool {
    let is_outside = |&[a, b, c]: &[u32; 3]| {
        let corner = |vertex: u32| mesh.positions[vertex as usize].as_dvec3();
        let face = (corner(b) - corner(a)).cross(corner(c) - corner(a));
        let normal: DVec3 =
            [a, b, c].map(|v| mesh.normals.get(v as usize).map_or(Vec3::ZERO, |n| *n).as_dvec3()).into_iter().sum();
        face.dot(normal) > 0.0 || face == DVec3::ZERO
    };
    let topology = Topology::of(mesh);
    !mesh.has_cutouts()
        && topology.is_solid()
        && topology.is_closed()
        && topology.bodies.iter().all(|body| body.volume > 0.0)
        && mesh.triangles.iter().all(is_outside)
}

#[cfg(test)]
mod tests {
    use super::*;
    use halfshade_scene::{Environment, Object, Scene, builtin::shapes};

    #[test]
    fn solids_are_dark_within() {
        assert!(is_dark_behind(&shapes::sphere(8)) && is_dark_behind(&shapes::torus(1.0, 0.3, 12, 8)));
        assert!(!is_dark_behind(&shapes::plane(2)) && !is_dark_behind(&Mesh::default()));
        let mut inside_out = shapes::sphere(8);
        inside_out.normals.iter_mut().for_each(|normal| *normal = -*normal);
        assert!(!is_dark_behind(&inside_out));
        inside_out.triangles.iter_mut().for_each(|triangle| triangle.swap(0, 1));
        assert!(!is_dark_behind(&inside_out));
        let mut holed = shapes::sphere(8);
        holed.triangles.pop();
        assert!(!is_dark_behind(&holed));
    }

    #[test]
    fn backs_follow_fronts() {
        let objects = vec![Object::new("plane", shapes::plane(1)), Object::new("ball", shapes::sphere(4))];
        let scene = Scene::at_rest("rows", objects, Environment::constant(Vec3::ONE));
        let rows = Rows::new(&scene.frame(0), true);
        let (plane, all) = (scene.objects[0].mesh.positions.len(), scene.vertex_count());
        assert_eq!(rows.objects[0], ObjectRows { first: 0, back: Back::Rows(all) });
        assert_eq!(rows.objects[1], ObjectRows { first: plane, back: Back::Dark });
        assert_eq!(rows.points.len(), all + plane);
        assert_eq!((rows.points[0].0, rows.points[0].1), (rows.points[all].0, -rows.points[all].1));
        assert_eq!(Rows::new(&scene.frame(0), false).points.len(), all);
    }
}
