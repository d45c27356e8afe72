//! Topology of a surface: edges, bodies, volume, area. The report on which a sphere set is built.

use super::orient::{Orientation, orient};
use super::{Mesh, Welded, doubled_area_vector, weld};
use glam::{DVec3, Vec3};

/// A part of a surface that hangs together across edges shared by exactly two triangles.
#[derive(Debug, Clone, PartialEq)]
pub struct Body {
    /// Number of triangles.
    pub triangles: usize,
    /// Whether each of its edges is shared by exactly two triangles of its own.
    pub closed: bool,
    /// Signed volume, as wound: positive if outward. Means something for closed, consistent bodies only.
    pub volume: f64,
    /// Area.
    pub area: f64,
    /// Triangles to turn around so that neighbours agree; 0 for a consistent body.
    pub flipped_triangles: usize,
    /// Whether neighbours can be made to agree at all: false for a Möbius strip.
    pub orientable: bool,
}

/// The topology and measures of a mesh, after welding.
#[derive(Debug, Clone, PartialEq)]
pub struct Topology {
    /// Distinct positions.
    pub vertices: usize,
    /// Triangles with three distinct corners.
    pub triangles: usize,
    /// Triangles that welding collapsed.
    pub collapsed_triangles: usize,
    /// Edges that belong to one triangle only: rims of holes.
    pub boundary_edges: usize,
    /// Edges shared by more than two triangles.
    pub non_manifold_edges: usize,
    /// Edges of two triangles that run through it the same way: their windings disagree.
    pub inconsistent_edges: usize,
    /// The bodies, in the order of their first triangles.
    pub bodies: Vec<Body>,
    /// Signed volume enclosed, sum over the bodies; see [`Body::volume`].
    pub volume: f64,
    /// Area.
    pub area: f64,
    /// Smallest and largest coordinates.
    pub bounds: (Vec3, Vec3),
}

impl Topology {
    /// The topology of `mesh`.
    pub fn of(mesh: &Mesh) -> Self {
        Self::of_welded(&weld(mesh), mesh.triangles.len())
    }

    /// The topology of a mesh welded before, of `source_triangles` triangles.
    pub fn of_welded(welded: &Welded, source_triangles: usize) -> Self {
        let Orientation { body_of, bodies, boundary_edges, non_manifold_edges, inconsistent_edges, .. } =
            orient(welded);
        let mut bodies: Vec<Body> = bodies
            .iter()
            .map(|body| Body {
                triangles: 0,
                closed: body.closed,
                volume: 0.0,
                area: 0.0,
                flipped_triangles: body.flipped_triangles,
                orientable: body.orientable,
            })
            .collect();
        let bounds = Mesh { positions: welded.positions.clone(), ..Mesh::default() }.bounds().unwrap_or_default();
        let center = 0.5 * (bounds.0.as_dvec3() + bounds.1.as_dvec3());
        for (t, &body) in body_of.iter().enumerate() {
            let body = &mut bodies[body as usize];
            body.triangles += 1;
            body.volume += signed_volume(welded.corners(t), center);
            body.area += 0.5 * doubled_area_vector(welded.corners(t)).length();
        }
        Self {
            vertices: welded.positions.len(),
            triangles: welded.triangles.len(),
            collapsed_triangles: source_triangles - welded.triangles.len(),
            boundary_edges,
            non_manifold_edges,
            inconsistent_edges,
            volume: bodies.iter().map(|body| body.volume).sum(),
            area: bodies.iter().map(|body| body.area).sum(),
            bodies,
            bounds,
        }
    }

    /// Whether every edge is shared by exactly two triangles.
    pub fn is_closed(&self) -> bool {
        self.triangles > 0 && self.boundary_edges == 0 && self.non_manifold_edges == 0
    }

    /// Whether the surface separates inside from outside: every body closed and consistent, the whole outward.
    pub fn is_solid(&self) -> bool {
        self.inconsistent_edges == 0
            && !self.bodies.is_empty()
            && self.bodies.iter().all(|body| body.closed && body.orientable)
            && self.volume > 0.0
    }

    /// Faults of the surface, for people; empty for a closed, consistent, outward one.
    pub fn problems(&self) -> Vec<String> {
        let mut problems = Vec::new();
        let mut say = |count: usize, what: &str| {
            if count > 0 {
                problems.push(format!("{count} {what}"));
            }
        };
        say(self.collapsed_triangles, "triangles without area");
        say(self.boundary_edges, "boundary edges (the surface has holes)");
        say(self.non_manifold_edges, "edges shared by more than two triangles");
        say(self.inconsistent_edges, "edges whose two triangles wind in opposite ways");
        say(self.bodies.iter().filter(|body| !body.orientable).count(), "bodies with only one side");
        if self.is_closed() && self.inconsistent_edges == 0 && self.volume <= 0.0 {
            problems.push("the surface encloses no volume or is turned inside out".to_owned());
        }
        problems
    }
}

/// Signed volume of the tetrahedron from `apex` to a triangle: det(a, b, c) / 6.
pub(super) fn signed_volume([a, b, c]: [Vec3; 3], apex: DVec3) -> f64 {
    let (a, b, c) = (a.as_dvec3() - apex, b.as_dvec3() - apex, c.as_dvec3() - apex);
    a.dot(b.cross(c)) / 6.0
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::builtin::shapes;

    #[test]
    fn a_box_is_closed_and_measures_what_a_box_measures() {
        let topology = Topology::of(&shapes::cuboid(Vec3::new(1.0, 2.0, 3.0), [2, 3, 4]));
        assert!(topology.is_closed() && topology.is_solid() && topology.problems().is_empty());
        assert!((topology.volume - 48.0).abs() < 1e-6 && (topology.area - 88.0).abs() < 1e-5);
        assert_eq!((topology.bodies.len(), topology.bounds.1), (1, Vec3::new(1.0, 2.0, 3.0)));
    }

    #[test]
    fn a_plane_has_a_rim() {
        let topology = Topology::of(&shapes::plane(8));
        assert_eq!((topology.boundary_edges, topology.bodies.len()), (32, 1));
        assert!(!topology.is_closed() && !topology.is_solid());
        assert_eq!(topology.problems(), ["32 boundary edges (the surface has holes)"]);
    }

    #[test]
    fn a_turned_triangle_and_a_fin_are_counted() {
        let mut mesh = shapes::box_mesh(2);
        mesh.triangles[0].swap(0, 1);
        assert_eq!(Topology::of(&mesh).inconsistent_edges, 3);
        let [a, b, _] = mesh.triangles[5];
        mesh.positions.push(Vec3::splat(5.0));
        mesh.triangles.push([a, b, mesh.positions.len() as u32 - 1]);
        let topology = Topology::of(&mesh);
        assert_eq!((topology.non_manifold_edges, topology.boundary_edges), (1, 2));
    }

    #[test]
    fn a_moebius_strip_has_one_side() {
        let n = 12;
        let mut mesh = Mesh::default();
        for i in 0..n {
            let angle = std::f32::consts::TAU * i as f32 / n as f32;
            let across =
                Vec3::new((angle / 2.0).cos() * angle.cos(), (angle / 2.0).sin(), (angle / 2.0).cos() * angle.sin());
            let around = 3.0 * Vec3::new(angle.cos(), 0.0, angle.sin());
            mesh.positions.extend([around - across, around + across]);
        }
        for i in 0..n {
            let [a, b] = [2 * i, 2 * i + 1];
            let [c, d] = if i + 1 < n { [a + 2, b + 2] } else { [1, 0] };
            mesh.triangles.extend([[a, b, c], [c, b, d]]);
        }
        let topology = Topology::of(&mesh);
        assert_eq!((topology.bodies.len(), topology.bodies[0].orientable), (1, false));
    }
}
