//! How much of the light that enters around the vertices of an object leaves it at a point: `∫ R_d(|x - y|) b_v(y) dA(y)` for each
//! vertex v, with b the weights of linear interpolation over the triangles around it.
//!
//! Triangles are quartered until they are small beside their distance and the mean free path, over which R_d is flat; then three
//! points are enough, and far away one.

use super::dipole::Dipole;
use glam::DVec3;

/// Largest radius of a piece of a triangle, as a part of its distance or the mean free path: of three points, and of one.
const NEAR: f64 = 0.25;
const FAR: f64 = 0.05;

/// Pieces that give less than this part of all light are quartered no more.
const DIM: f64 = 1e-6;

/// Most quarterings.
const MOST_QUARTERINGS: u32 = 30;

/// Surface of a translucent object.
#[derive(Debug)]
pub(crate) struct Surface {
    pub(crate) dipoles: [Dipole; 3],
    /// Places of its vertices in the world.
    pub(crate) positions: Vec<DVec3>,
    pub(crate) triangles: Vec<[u32; 3]>,
}

/// Part of a triangle.
struct Piece {
    /// Corners by weights of the triangle's vertices.
    corners: [DVec3; 3],
    area: f64,
    quarterings: u32,
}

impl Surface {
    /// Weights of light that enters at each vertex, by channel, for what leaves at a point.
    pub(crate) fn weights(&self, at: DVec3) -> Vec<DVec3> {
        let mut weights = vec![DVec3::ZERO; self.positions.len()];
        let most: f64 = self.dipoles.iter().map(Dipole::total).sum();
        let depth = self.dipoles.iter().map(|dipole| dipole.depth).fold(f64::INFINITY, f64::min);
        let mut open = Vec::new();
        for triangle in &self.triangles {
            let [a, b, c] = triangle.map(|vertex| self.positions[vertex as usize]);
            let area = 0.5 * (b - a).cross(c - a).length();
            if !(area > 0.0 && area.is_finite()) {
                continue;
            }
            let place = |weights: DVec3| weights.x * a + weights.y * b + weights.z * c;
            open.push(Piece { corners: DVec3::AXES, area, quarterings: 0 });
            while let Some(piece) = open.pop() {
                let middle = piece.corners.iter().sum::<DVec3>() / 3.0;
                let center = place(middle);
                let radius = piece.corners.map(|corner| place(corner).distance(center)).into_iter().fold(0.0, f64::max);
                let scale = at.distance(center).hypot(depth);
                let is_dim = || {
                    let near = (at.distance(center) - radius).max(0.0);
                    piece.area * self.reflectance(near * near).element_sum() <= DIM * most
                };
                let mut add = |within: DVec3, share: f64| {
                    let light = piece.area * share * self.reflectance(at.distance_squared(place(within)));
                    for (vertex, weight) in triangle.iter().zip(within.to_array()) {
                        weights[*vertex as usize] += weight * light;
                    }
                };
                if radius <= FAR * scale {
                    add(middle, 1.0);
                } else if radius <= NEAR * scale || piece.quarterings == MOST_QUARTERINGS || is_dim() {
                    // Exact for quadratic functions.
                    piece.edges().into_iter().for_each(|edge| add(edge, 1.0 / 3.0));
                } else {
                    open.extend(piece.quarters());
                }
            }
        }
        weights
    }

    fn reflectance(&self, squared: f64) -> DVec3 {
        DVec3::from(self.dipoles.map(|dipole| dipole.reflectance(squared)))
    }
}

impl Piece {
    /// Middles of its edges.
    fn edges(&self) -> [DVec3; 3] {
        let [a, b, c] = self.corners;
        [0.5 * (a + b), 0.5 * (b + c), 0.5 * (c + a)]
    }

    fn quarters(&self) -> [Self; 4] {
        let ([a, b, c], [ab, bc, ca]) = (self.corners, self.edges());
        [[a, ab, ca], [ab, b, bc], [ca, bc, c], [ab, bc, ca]].map(|corners| Self {
            corners,
            area: 0.25 * self.area,
            quarterings: self.quarterings + 1,
        })
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use glam::Vec3;
    use halfshade_scene::{Subsurface, builtin::shapes};

    fn plane(cells: usize, medium: &Subsurface) -> Surface {
        let mesh = shapes::plane(cells);
        Surface {
            dipoles: Dipole::of(medium),
            positions: mesh.positions.iter().map(|position| position.as_dvec3()).collect(),
            triangles: mesh.triangles.clone(),
        }
    }

    /// A plane in even light gives back what an endless one does, however its triangles compare with the paths of light; a linear
    /// light is given back as at the point.
    #[test]
    fn a_plane_gives_back_the_closed_form() {
        for (cells, path) in [(2, 1e-5_f32), (8, 1e-3), (20, 0.01), (20, 0.05), (64, 0.02)] {
            let medium = Subsurface {
                absorption: Vec3::new(1.0, 2.0, 4.0) / path,
                reduced_scattering: Vec3::new(8.0, 3.0, 1.0) / path,
                refractive_index: 1.4,
            };
            let surface = plane(cells, &medium);
            let at = DVec3::new(0.123, 0.0, -0.045);
            let weights = surface.weights(at);
            let total = DVec3::from(surface.dipoles.map(|dipole| dipole.total()));
            let sum: DVec3 = weights.iter().sum();
            assert!((sum / total - 1.0).abs().max_element() < 2e-3, "{cells} {path}: {sum} {total}");
            let linear = |place: DVec3| 1.0 + 0.7 * place.x - 0.4 * place.z;
            let found: DVec3 = weights.iter().zip(&surface.positions).map(|(w, p)| *w * linear(*p)).sum();
            assert!((found / total - linear(at)).abs().max_element() < 4e-3, "{cells} {path}: {found}");
        }
    }

    #[test]
    fn ends_are_finite() {
        for (absorption, scattering) in [(1e6, 1e6), (0.0, 1e-6), (1e-6, 0.0), (0.0, 1e6)] {
            let medium = Subsurface {
                absorption: Vec3::splat(absorption),
                reduced_scattering: Vec3::splat(scattering),
                refractive_index: 2.5,
            };
            let surface = plane(3, &medium);
            for at in [DVec3::ZERO, DVec3::X, DVec3::splat(1e6)] {
                let weights = surface.weights(at);
                let sum: DVec3 = weights.iter().sum();
                assert!(weights.iter().all(|w| w.is_finite()) && sum.max_element() <= 1.0, "{at} {sum}");
            }
        }
    }
}
