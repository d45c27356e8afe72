//! Translucent objects: points where light enters, drawn by how much of it leaves at another.
//!
//! A receiver needs `∫ R_d(|x - y|) E_t(y) dA(y)` over the object's surface. Of a tree over the triangles a cut is taken, node by
//! node until each is small beside its distance and the depth over which R_d is flat, triangles being cut further into quarters; a
//! node is drawn by its area times R_d, a point of it uniformly. What R_d varies within a node is weighed exactly, so that the
//! cut decides noise alone.

use crate::dipole::Dipole;
use glam::DVec3;
use halfshade_scene::Subsurface;
use std::ops::Range;

/// Largest radius of a node, as a part of its distance or of the depth.
const REACH: f64 = 0.3;

/// Nodes that give less than this part of all light are not taken apart.
const DIM: f64 = 1e-4;

/// Triangles of a leaf.
const LEAF: usize = 2;

/// Most quarterings of a triangle.
const MOST_QUARTERINGS: u32 = 30;

/// The surface of a translucent object in the world.
#[derive(Debug)]
pub(crate) struct Translucent {
    pub(crate) dipole: Dipole,
    /// As the tree has them.
    triangles: Vec<Triangle>,
    /// Sums of the areas of all triangles before each, and of all.
    areas: Vec<f64>,
    /// Parents before their children; the first is the root.
    nodes: Vec<Node>,
    /// Light that an endless plane would give back, summed over channels.
    most: f64,
}

#[derive(Debug, Clone, Copy)]
pub(crate) struct Triangle {
    pub(crate) corners: [DVec3; 3],
    pub(crate) normals: [DVec3; 3],
}

#[derive(Debug, Clone)]
struct Node {
    center: DVec3,
    radius: f64,
    triangles: Range<usize>,
    /// None of a leaf.
    children: Option<[usize; 2]>,
}

/// Parts of a surface from which light comes to one point of it.
#[derive(Debug)]
pub(crate) struct Cut {
    at: DVec3,
    parts: Vec<Part>,
}

#[derive(Debug)]
struct Part {
    /// Sum of the importance of this part and of those before it.
    until: f64,
    triangles: Range<usize>,
    /// Corners within a single triangle, by weights of its vertices; all of it where there are none.
    corners: Option<[DVec3; 3]>,
    area: f64,
}

/// A point where light enters.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Entry {
    pub(crate) position: DVec3,
    pub(crate) normal: DVec3,
    /// R_d over the density with which the point was drawn.
    pub(crate) weight: DVec3,
}

impl Triangle {
    fn face(&self) -> DVec3 {
        let [a, b, c] = self.corners;
        (b - a).cross(c - a)
    }

    fn area(&self) -> f64 {
        0.5 * self.face().length()
    }

    fn middle(&self) -> DVec3 {
        self.corners.iter().sum::<DVec3>() / 3.0
    }

    fn at(&self, weights: DVec3) -> DVec3 {
        self.corners.iter().zip(weights.to_array()).map(|(corner, weight)| weight * *corner).sum()
    }

    fn normal_at(&self, weights: DVec3) -> DVec3 {
        let normal: DVec3 = self.normals.iter().zip(weights.to_array()).map(|(normal, weight)| weight * *normal).sum();
        normal.normalize_or(self.face().normalize_or(DVec3::Y))
    }
}

impl Translucent {
    pub(crate) fn new(medium: &Subsurface, triangles: impl Iterator<Item = Triangle>) -> Self {
        let has_area = |triangle: &Triangle| triangle.area() > 0.0 && triangle.area().is_finite();
        let mut triangles: Vec<Triangle> = triangles.filter(has_area).collect();
        let mut nodes = Vec::new();
        if !triangles.is_empty() {
            let all = 0..triangles.len();
            build(&mut triangles, all, &mut nodes);
        }
        let mut areas = vec![0.0];
        areas.extend(triangles.iter().scan(0.0, |sum, triangle| {
            *sum += triangle.area();
            Some(*sum)
        }));
        let dipole = Dipole::new(medium);
        Self { dipole, triangles, areas, nodes, most: dipole.total().element_sum() }
    }

    /// Parts of the surface from which light comes to a point.
    pub(crate) fn cut(&self, at: DVec3) -> Cut {
        let mut cut = Cut { at, parts: Vec::new() };
        let mut open: Vec<usize> = (!self.nodes.is_empty()).then_some(0).into_iter().collect();
        while let Some(number) = open.pop() {
            let node = &self.nodes[number];
            let area = self.areas[node.triangles.end] - self.areas[node.triangles.start];
            if let Some(importance) = self.importance(at, node.center, node.radius, area) {
                cut.push(importance, node.triangles.clone(), None, area);
            } else if let Some(children) = node.children {
                open.extend(children);
            } else {
                node.triangles.clone().for_each(|triangle| self.quarter(triangle, DVec3::AXES, 0, &mut cut));
            }
        }
        cut
    }

    /// Adds part of a triangle, in pieces as small as they must be.
    fn quarter(&self, number: usize, corners: [DVec3; 3], quarterings: u32, cut: &mut Cut) {
        let triangle = &self.triangles[number];
        let area = triangle.area() * 0.25_f64.powi(quarterings as i32);
        let places = corners.map(|weights| triangle.at(weights));
        let center = places.iter().sum::<DVec3>() / 3.0;
        let radius = places.map(|place| place.distance(center)).into_iter().fold(0.0, f64::max);
        let at_last = || area * self.dipole.reflectance(cut.at.distance(center)).element_sum();
        let importance = self.importance(cut.at, center, radius, area);
        if let Some(importance) = importance.or_else(|| (quarterings == MOST_QUARTERINGS).then(at_last)) {
            return cut.push(importance, number..number + 1, Some(corners), area);
        }
        let [a, b, c] = corners;
        let [ab, bc, ca] = [0.5 * (a + b), 0.5 * (b + c), 0.5 * (c + a)];
        for piece in [[a, ab, ca], [ab, b, bc], [ca, bc, c], [ab, bc, ca]] {
            self.quarter(number, piece, quarterings + 1, cut);
        }
    }

    /// About how much light comes from a ball's part of the surface; none if that varies too much within.
    fn importance(&self, at: DVec3, center: DVec3, radius: f64, area: f64) -> Option<f64> {
        let distance = at.distance(center);
        let light = |distance: f64| area * self.dipole.reflectance(distance).element_sum();
        let is_small = radius <= REACH * distance.hypot(self.dipole.shortest_depth());
        if is_small {
            return Some(light(distance));
        }
        Some(light((distance - radius).max(0.0))).filter(|most| *most <= DIM * self.most)
    }

    /// A point drawn by two numbers in (0, 1); none if no light comes from anywhere.
    pub(crate) fn draw(&self, cut: &Cut, [u, v]: [f64; 2]) -> Option<Entry> {
        let total = cut.parts.last()?.until;
        if !(total > 0.0 && total.is_finite()) {
            return None;
        }
        let number = cut.parts.partition_point(|part| part.until <= u * total).min(cut.parts.len() - 1);
        let before = if number == 0 { 0.0 } else { cut.parts[number - 1].until };
        let part = &cut.parts[number];
        let share = (part.until - before) / total;
        let u = ((u * total - before) / (part.until - before)).clamp(0.0, 1.0);
        // The triangle by its area.
        let place =
            self.areas[part.triangles.start] + u * (self.areas[part.triangles.end] - self.areas[part.triangles.start]);
        let Range { start, end } = part.triangles.clone();
        let chosen = start + self.areas[start + 1..end].partition_point(|sum| *sum <= place);
        let (low, high) = (self.areas[chosen], self.areas[chosen + 1]);
        let u = ((place - low) / (high - low)).clamp(0.0, 1.0).sqrt();
        let within = DVec3::new(1.0 - u, u * (1.0 - v), u * v);
        let corners = part.corners.unwrap_or(DVec3::AXES);
        let weights: DVec3 = corners.iter().zip(within.to_array()).map(|(corner, weight)| weight * *corner).sum();
        let triangle = &self.triangles[chosen];
        let position = triangle.at(weights);
        let weight = self.dipole.reflectance(cut.at.distance(position)) * (part.area / share);
        weight.is_finite().then(|| Entry { position, normal: triangle.normal_at(weights), weight })
    }
}

impl Cut {
    fn push(&mut self, importance: f64, triangles: Range<usize>, corners: Option<[DVec3; 3]>, area: f64) {
        if importance > 0.0 {
            let until = self.parts.last().map_or(0.0, |part| part.until) + importance;
            self.parts.push(Part { until, triangles, corners, area });
        }
    }
}

/// Builds the tree over a range of triangles, which it sorts; the number of its root.
fn build(triangles: &mut [Triangle], range: Range<usize>, nodes: &mut Vec<Node>) -> usize {
    let part = &mut triangles[range.clone()];
    let corners = || part.iter().flat_map(|triangle| triangle.corners);
    let low = corners().fold(DVec3::INFINITY, DVec3::min);
    let high = corners().fold(DVec3::NEG_INFINITY, DVec3::max);
    let center = 0.5 * (low + high);
    let radius = corners().map(|corner| corner.distance(center)).fold(0.0, f64::max);
    let number = nodes.len();
    nodes.push(Node { center, radius, triangles: range.clone(), children: None });
    if range.len() > LEAF {
        let axis = (high - low).max_position();
        let half = range.len() / 2;
        part.select_nth_unstable_by(half, |a, b| a.middle()[axis].total_cmp(&b.middle()[axis]));
        let middle = range.start + half;
        let children = [build(triangles, range.start..middle, nodes), build(triangles, middle..range.end, nodes)];
        nodes[number].children = Some(children);
    }
    number
}

#[cfg(test)]
mod tests {
    use super::*;
    use glam::Vec3;
    use halfshade_scene::builtin::shapes;

    fn sphere(medium: &Subsurface) -> Translucent {
        let mesh = shapes::sphere(12);
        let triangles = mesh.triangles.iter().map(|corners| {
            let at = |list: &[Vec3]| corners.map(|vertex| list[vertex as usize].as_dvec3());
            Triangle { corners: at(&mesh.positions), normals: at(&mesh.normals) }
        });
        Translucent::new(medium, triangles)
    }

    /// The sum of weights over points is R_d summed over all triangles, each in many pieces; whatever the path of light, few points do.
    #[test]
    fn points_add_up_to_the_integral() {
        for (scattering, absorption) in [(2.0, 0.5), (30.0, 0.1), (3000.0, 5.0), (1e-3, 1e-3)] {
            let medium = Subsurface {
                absorption: Vec3::splat(absorption),
                reduced_scattering: scattering * Vec3::new(1.0, 0.5, 2.0),
                refractive_index: 1.4,
            };
            let translucent = sphere(&medium);
            let at = translucent.triangles[17].at(DVec3::new(0.2, 0.5, 0.3));
            // Exact by quarters of quarters about the point.
            let mut exact = DVec3::ZERO;
            let mut open: Vec<([DVec3; 3], u32)> =
                translucent.triangles.iter().map(|triangle| (triangle.corners, 0)).collect();
            while let Some((corners, depth)) = open.pop() {
                let center = corners.iter().sum::<DVec3>() / 3.0;
                let reach = corners.map(|corner| corner.distance(center)).into_iter().fold(0.0, f64::max);
                if depth < 24 && reach > 0.05 * at.distance(center).hypot(translucent.dipole.shortest_depth()) {
                    let [a, b, c] = corners;
                    let [ab, bc, ca] = [0.5 * (a + b), 0.5 * (b + c), 0.5 * (c + a)];
                    let pieces = [[a, ab, ca], [ab, b, bc], [ca, bc, c], [ab, bc, ca]];
                    open.extend(pieces.map(|piece| (piece, depth + 1)));
                } else {
                    let area = 0.5 * (corners[1] - corners[0]).cross(corners[2] - corners[0]).length();
                    exact += area * translucent.dipole.reflectance(at.distance(center));
                }
            }
            let cut = translucent.cut(at);
            let side = 256;
            let middle = |k: i32| (f64::from(k) + 0.5) / f64::from(side);
            let points =
                (0..side * side).map(|k| translucent.draw(&cut, [middle(k / side), middle(k % side)]).unwrap());
            let (mut sum, mut squares) = (DVec3::ZERO, DVec3::ZERO);
            for Entry { position, normal, weight } in points {
                assert!((position.length() - 1.0).abs() < 0.05 && normal.dot(position) > 0.95);
                sum += weight / f64::from(side * side);
                squares += weight * weight / f64::from(side * side);
            }
            assert!((sum / exact - 1.0).abs().max_element() < 0.02, "{scattering}: {sum} {exact}");
            let spread = (squares / (sum * sum) - 1.0).max(DVec3::ZERO).map(f64::sqrt);
            assert!(spread.max_element() < 1.5, "{scattering}: {spread}");
        }
    }

    #[test]
    fn nothing_comes_from_nowhere() {
        let black = Subsurface { absorption: Vec3::ONE, reduced_scattering: Vec3::ZERO, refractive_index: 1.3 };
        let translucent = sphere(&black);
        assert!(translucent.draw(&translucent.cut(DVec3::X), [0.5; 2]).is_none());
        let empty = Translucent::new(&black, std::iter::empty());
        assert!(empty.draw(&empty.cut(DVec3::X), [0.5; 2]).is_none());
    }
}
