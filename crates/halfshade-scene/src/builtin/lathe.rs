//! Surfaces of revolution around +Y.

use crate::Mesh;
use glam::{Vec2, Vec3};
use std::f64::consts::TAU;

/// A point of a lathe's profile.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct ProfilePoint {
    /// Distance from the axis, not negative.
    pub radius: f32,
    /// Height along +Y.
    pub height: f32,
    /// Whether the surface has an edge here: its vertices are then doubled, one normal for each side.
    pub crease: bool,
}

impl ProfilePoint {
    /// A point in whose neighbourhood the surface is smooth.
    pub const fn smooth(radius: f32, height: f32) -> Self {
        Self { radius, height, crease: false }
    }

    /// A point on an edge of the surface.
    pub const fn crease(radius: f32, height: f32) -> Self {
        Self { radius, height, crease: true }
    }

    fn at(&self) -> Vec2 {
        Vec2::new(self.radius, self.height)
    }
}

/// Turns `profile` around +Y in `segments` steps (at least 3).
///
/// The profile runs with the solid on its left: outward along the bottom, up the outside, inward over the top. The
/// surface is closed if the profile starts and ends on the axis (radius 0), or ends where it starts. Consecutive points
/// must differ. A smooth point's normal is that of the circle through it and its neighbours; on the axis it is ±Y, and
/// a crease on the axis is the tip of a cone, with one vertex per step.
///
/// An empty profile or fewer than three steps give an empty mesh.
pub fn lathe(profile: &[ProfilePoint], segments: usize) -> Mesh {
    let mut mesh = Mesh::default();
    if profile.len() < 2 || segments < 3 {
        return mesh;
    }
    let last = profile.len() - 1;
    let ring_closed = profile[0].radius > 0.0 && profile[0].at() == profile[last].at();
    let mut rings: Vec<(Ring, Ring)> = Vec::with_capacity(profile.len());
    for (i, point) in profile.iter().enumerate() {
        if i == last && ring_closed {
            rings.push(rings[0]);
            break;
        }
        let before = match i {
            0 if ring_closed => Some(profile[last - 1]),
            0 => None,
            _ => Some(profile[i - 1]),
        };
        let edge_before = before.map(|before| point.at() - before.at());
        let edge_after = profile.get(i + 1).map(|after| after.at() - point.at());
        let on_axis = point.radius == 0.0;
        rings.push(match (edge_before, edge_after) {
            (Some(a), Some(b)) if point.crease => (
                push_ring(&mut mesh, point, outward(a), segments, false),
                push_ring(&mut mesh, point, outward(b), segments, false),
            ),
            (Some(a), Some(b)) => {
                let ring = push_ring(&mut mesh, point, outward(tangent(a, b)), segments, false);
                (ring, ring)
            }
            (Some(edge), None) | (None, Some(edge)) => {
                let normal = outward(edge);
                let smooth_pole = on_axis && !point.crease;
                let normal = if smooth_pole { Vec2::new(0.0, normal.y.signum()) } else { normal };
                let ring = push_ring(&mut mesh, point, normal, segments, smooth_pole);
                (ring, ring)
            }
            (None, None) => return mesh,
        });
    }
    for pair in rings.windows(2) {
        let ((_, lower), (upper, _)) = (pair[0], pair[1]);
        for segment in 0..segments {
            let next = (segment + 1) % segments;
            let ([a, b], [c, d]) = ([lower.at(segment), lower.at(next)], [upper.at(segment), upper.at(next)]);
            if !lower.on_axis {
                mesh.triangles.push([a, d, b]);
            }
            if !upper.on_axis {
                mesh.triangles.push([a, c, d]);
            }
        }
    }
    mesh
}

/// The vertices of one profile point.
#[derive(Debug, Clone, Copy)]
struct Ring {
    first: u32,
    single: bool,
    on_axis: bool,
}

impl Ring {
    fn at(&self, segment: usize) -> u32 {
        if self.single { self.first } else { self.first + segment as u32 }
    }
}

fn push_ring(mesh: &mut Mesh, point: &ProfilePoint, normal: Vec2, segments: usize, single: bool) -> Ring {
    let on_axis = point.radius == 0.0;
    let ring = Ring { first: mesh.positions.len() as u32, single, on_axis };
    for segment in 0..if single { 1 } else { segments } {
        // The tip of a cone belongs to one triangle per step, whose normal stands in the middle of the step.
        let step = if on_axis { segment as f64 + 0.5 } else { segment as f64 };
        let (sin, cos) = (TAU * step / segments as f64).sin_cos();
        let turned = |p: Vec2| Vec3::new(p.x * cos as f32, p.y, p.x * sin as f32);
        mesh.positions.push(turned(point.at()));
        mesh.normals.push(turned(normal).normalize());
    }
    ring
}

/// The unit normal on the right of a profile's edge, as (radial, axial).
fn outward(edge: Vec2) -> Vec2 {
    Vec2::new(edge.y, -edge.x).normalize()
}

/// Tangent of the circle through three points, at the middle one; `a` and `b` lead to and from it.
fn tangent(a: Vec2, b: Vec2) -> Vec2 {
    a * (b.length() / a.length()) + b * (a.length() / b.length())
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::builtin::shapes::tests::check_solid;
    use std::f64::consts::PI;

    #[test]
    fn a_half_circle_turns_into_a_sphere() {
        let steps = 96;
        let profile: Vec<_> = (0..=steps)
            .map(|i| {
                let (sin, cos) = (PI * f64::from(i) / f64::from(steps)).sin_cos();
                ProfilePoint::smooth(if i == 0 || i == steps { 0.0 } else { sin as f32 }, -cos as f32)
            })
            .collect();
        let mesh = lathe(&profile, 128);
        for (position, normal) in mesh.positions.iter().zip(&mesh.normals) {
            assert!(position.distance(*normal) < 1e-5, "{position} {normal}");
        }
        let volume = check_solid(&mesh);
        assert!((volume / (4.0 / 3.0 * PI) - 1.0).abs() < 2e-3, "{volume}");
    }

    #[test]
    fn a_closed_ring_turns_into_a_tube() {
        let profile = [(1.0, 0.0), (2.0, 0.0), (2.0, 1.0), (1.0, 1.0), (1.0, 0.0)];
        let mesh = lathe(&profile.map(|(r, h)| ProfilePoint::crease(r, h)), 256);
        let volume = check_solid(&mesh);
        assert!((volume / (3.0 * PI) - 1.0).abs() < 1e-3, "{volume}");
    }

    #[test]
    fn nothing_comes_from_nothing() {
        assert_eq!(lathe(&[], 8), Mesh::default());
        assert_eq!(lathe(&[ProfilePoint::smooth(0.0, 0.0)], 8), Mesh::default());
        let profile = [ProfilePoint::smooth(0.0, 0.0), ProfilePoint::smooth(1.0, 1.0)];
        assert_eq!(lathe(&profile, 2), Mesh::default());
    }
}
