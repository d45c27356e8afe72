//! Who is next to whom: pixels of a picture, vertices of a mesh.

use glam::Vec3;
use halfshade_scene::{Frame, Mesh, Receivers, SurfacePoint};
use std::collections::HashMap;

/// Up to eight neighbours of each receiver at distances of 1, 2, 4, .. pixels or edges, the nearer ones first.
///
/// Receivers between vertices are those that the camera sees through its pixels: neighbours are the eight around a pixel, by
/// columns and rows. Those at vertices have the other ends of their edges; twice as far is straight on from each of those.
/// Vertices that stand at one place and face the same way are one.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct Neighbours {
    /// Level by level, receiver by receiver.
    pub levels: Vec<Vec<Near>>,
}

/// Numbers of receivers, [`NOBODY`] where there are no more.
pub type Near = [u32; 8];

/// No receiver.
pub const NOBODY: u32 = u32::MAX;

/// How straight on is: the cosine of the largest turn.
const STRAIGHT: f32 = 0.5;

impl Neighbours {
    /// Those of receivers of a frame, so many times twice as far.
    pub fn new(frame: &Frame<'_>, receivers: Receivers<'_>, levels: usize) -> Self {
        let mut all = vec![vec![[NOBODY; 8]; receivers.len()]; levels];
        add_pixels(&mut all, frame, receivers);
        for object in 0..frame.scene.objects.len() {
            add_vertices(&mut all, &frame.scene.objects[object].mesh, object as u32, receivers);
        }
        Self { levels: all }
    }

    /// Number of receivers.
    pub fn len(&self) -> usize {
        self.levels.first().map_or(0, Vec::len)
    }

    /// Whether there are none.
    pub fn is_empty(&self) -> bool {
        self.len() == 0
    }

    pub(crate) fn bytes(&self) -> usize {
        self.levels.iter().map(|level| size_of_val(level.as_slice())).sum()
    }
}

/// Steps to the eight pixels around one, those that share an edge with it first.
const AROUND: [[i64; 2]; 8] = [[1, 0], [-1, 0], [0, 1], [0, -1], [1, 1], [-1, 1], [1, -1], [-1, -1]];

fn add_pixels(all: &mut [Vec<Near>], frame: &Frame<'_>, receivers: Receivers<'_>) {
    let camera = &frame.scene.camera;
    let [width, height] = camera.resolution.map(i64::from);
    let is_inside = |[column, row]: [i64; 2]| (0..width).contains(&column) && (0..height).contains(&row);
    let pixels: Vec<(usize, [i64; 2])> = (0..receivers.len())
        .filter(|&i| matches!(receivers.surface[i], SurfacePoint::Triangle { .. }))
        .filter_map(|i| Some((i, camera.pixel_at(receivers.position_at(i))?.map(|place| place.floor() as i64))))
        .filter(|(_, pixel)| is_inside(*pixel))
        .collect();
    if pixels.is_empty() {
        return;
    }
    let place = |[column, row]: [i64; 2]| (row * width + column) as usize;
    let mut in_pixel = vec![NOBODY; (width * height) as usize];
    pixels.iter().for_each(|(i, pixel)| in_pixel[place(*pixel)] = *i as u32);
    for (level, near) in all.iter_mut().enumerate() {
        for (i, [column, row]) in &pixels {
            near[*i] = AROUND.map(|[right, down]| {
                let other = [column + (right << level), row + (down << level)];
                if is_inside(other) { in_pixel[place(other)] } else { NOBODY }
            });
        }
    }
}

fn add_vertices(all: &mut [Vec<Near>], mesh: &Mesh, object: u32, receivers: Receivers<'_>) {
    let mut receiver_of = vec![NOBODY; mesh.positions.len()];
    for i in (0..receivers.len()).filter(|&i| receivers.object[i] == object) {
        if let SurfacePoint::Vertex(vertex) = receivers.surface[i]
            && let Some(receiver) = receiver_of.get_mut(vertex as usize)
        {
            *receiver = i as u32;
        }
    }
    if receiver_of.iter().all(|&receiver| receiver == NOBODY) {
        return;
    }
    let first_of = united(mesh);
    let mut near = along_edges(mesh, &first_of);
    for level in all {
        for (vertex, &receiver) in receiver_of.iter().enumerate().filter(|(_, receiver)| **receiver != NOBODY) {
            let own = near[first_of[vertex] as usize];
            let known = own.map(|other| if other == NOBODY { NOBODY } else { receiver_of[other as usize] });
            level[receiver as usize] = known;
        }
        near = (0..near.len()).map(|vertex| farther(&mesh.positions, &near, vertex)).collect();
    }
}

/// The first of the vertices that stand where each does and face the same way.
fn united(mesh: &Mesh) -> Vec<u32> {
    let mut known = HashMap::new();
    let key = |vertex: usize| {
        let normal = mesh.normals.get(vertex).copied().unwrap_or_default();
        // Zeros of either sign are one.
        [mesh.positions[vertex], normal].map(|vector| (vector + Vec3::ZERO).to_array().map(f32::to_bits))
    };
    (0..mesh.positions.len()).map(|vertex| *known.entry(key(vertex)).or_insert(vertex as u32)).collect()
}

/// Other ends of the shortest edges.
fn along_edges(mesh: &Mesh, first_of: &[u32]) -> Vec<Near> {
    let mut edges: Vec<[u32; 2]> = (mesh.triangles.iter())
        .flat_map(|triangle| {
            let [a, b, c] = triangle.map(|vertex| first_of[vertex as usize]);
            [[a, b], [b, a], [b, c], [c, b], [c, a], [a, c]]
        })
        .filter(|[a, b]| a != b)
        .collect();
    edges.sort_unstable();
    edges.dedup();
    let mut near = vec![[NOBODY; 8]; mesh.positions.len()];
    for edges in edges.chunk_by(|a, b| a[0] == b[0]) {
        let vertex = edges[0][0] as usize;
        let mut others: Vec<u32> = edges.iter().map(|edge| edge[1]).collect();
        let square = |other: &u32| mesh.positions[*other as usize].distance_squared(mesh.positions[vertex]);
        others.sort_by(|a, b| square(a).total_cmp(&square(b)));
        near[vertex].iter_mut().zip(others).for_each(|(slot, other)| *slot = other);
    }
    near
}

/// For each neighbour the one that lies straight on from there.
fn farther(positions: &[Vec3], near: &[Near], vertex: usize) -> Near {
    near[vertex].map(|middle| {
        if middle == NOBODY {
            return NOBODY;
        }
        let here = positions[middle as usize];
        let ahead = (here - positions[vertex]).normalize_or_zero();
        let candidates = near[middle as usize].into_iter().filter(|&other| other != NOBODY);
        let straightness = |other: u32| ahead.dot((positions[other as usize] - here).normalize_or_zero());
        let best = candidates.map(|other| (straightness(other), other)).max_by(|a, b| a.0.total_cmp(&b.0));
        best.filter(|(straightness, _)| *straightness > STRAIGHT).map_or(NOBODY, |(_, other)| other)
    })
}

#[cfg(test)]
mod tests {
    use super::*;
    use halfshade_scene::{Camera, Environment, Gloss, Object, ReceiverBuffer, ReceiverPoint, Scene, builtin::shapes};

    /// On a grid, all levels go as many columns and rows as they say.
    #[test]
    fn vertices_of_a_grid_step_twice_as_far() {
        let cells = 16;
        let scene =
            Scene::at_rest("grid", vec![Object::new("plane", shapes::plane(cells))], Environment::constant(Vec3::ONE));
        let receivers = ReceiverBuffer::vertices(&scene.frame(0));
        let neighbours = Neighbours::new(&scene.frame(0), receivers.view(), 3);
        let view = receivers.view();
        let middle = (0..receivers.len()).find(|&i| view.position_at(i).length() < 1e-6).unwrap();
        for (level, near) in neighbours.levels.iter().enumerate() {
            let steps: Vec<Vec3> = (near[middle].iter().filter(|other| **other != NOBODY))
                .map(|other| view.position_at(*other as usize) * (cells as f32 / 2.0) / (1 << level) as f32)
                .collect();
            assert!(steps.len() >= 6, "{steps:?}");
            // Along an edge of the grid, or across a cell.
            assert!(steps.iter().all(|step| step.abs().max_element() == 1.0), "{steps:?}");
        }
    }

    #[test]
    fn pixels_know_those_around_them() {
        let mut scene = Scene::at_rest("empty", Vec::new(), Environment::constant(Vec3::ONE));
        scene.camera = Camera {
            eye: Vec3::new(0.0, 1.0, 4.0),
            target: Vec3::new(0.3, 0.5, 0.0),
            vertical_fov_degrees: 40.0,
            resolution: [20, 10],
        };
        let mut receivers = ReceiverBuffer::default();
        let mut pixels = Vec::new();
        // Column by column, some missing.
        for column in 0..20i64 {
            for row in (0..10i64).filter(|row| (column * row) % 7 != 3) {
                let toward = scene.camera.ray_direction(column as f32 + 0.5, row as f32 + 0.5);
                pixels.push([column, row]);
                receivers.add(&ReceiverPoint {
                    position: scene.camera.eye + toward * (2.0 + 0.1 * row as f32),
                    normal: -toward,
                    albedo: Vec3::ONE,
                    gloss: Gloss::NEUTRAL,
                    object: 0,
                    surface: SurfacePoint::Triangle { triangle: 0, barycentric: [1.0, 0.0, 0.0], from_behind: false },
                });
            }
        }
        let neighbours = Neighbours::new(&scene.frame(0), receivers.view(), 2);
        for (level, near) in neighbours.levels.iter().enumerate() {
            for (i, near) in near.iter().enumerate() {
                let expected = AROUND.map(|[right, down]| {
                    let other = [pixels[i][0] + (right << level), pixels[i][1] + (down << level)];
                    pixels.iter().position(|pixel| *pixel == other).map_or(NOBODY, |place| place as u32)
                });
                assert_eq!(*near, expected, "{level} {i}");
            }
        }
    }
}
