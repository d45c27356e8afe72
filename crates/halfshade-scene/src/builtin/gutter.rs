//! A block with a round groove along z: what runs beside a bowling lane.

use crate::Mesh;
use glam::{Vec2, Vec3};
use std::f32::consts::PI;

/// Half of its width.
pub(super) const HALF_WIDTH: f32 = 0.13;
const HEIGHT: f32 = 0.058;
const GROOVE_HALF_WIDTH: f32 = 0.11;
const GROOVE_DEPTH: f32 = 0.045;
/// Steps across the groove, even.
const STEPS: usize = 12;

/// The block's bottom edges.
const RIGHT: Vec2 = Vec2::new(HALF_WIDTH, 0.0);
const LEFT: Vec2 = Vec2::new(-HALF_WIDTH, 0.0);

/// Across the groove, from +x to -x.
fn groove() -> Vec<Vec2> {
    let at = |i| {
        let (sin, cos) = (PI * i as f32 / STEPS as f32).sin_cos();
        Vec2::new(GROOVE_HALF_WIDTH * cos, HEIGHT - GROOVE_DEPTH * sin)
    };
    (0..=STEPS).map(at).collect()
}

/// Across the top, from +x to -x: lip, groove, lip.
fn top() -> Vec<Vec2> {
    let mut top = vec![RIGHT.with_y(HEIGHT)];
    top.extend(groove());
    top.push(LEFT.with_y(HEIGHT));
    top
}

/// The block from `-half_length` to `half_length`, its bottom at y = 0, in `rows` rows along z; closed.
pub(super) fn gutter(half_length: f32, rows: usize) -> Mesh {
    let (top, groove) = (top(), groove());
    let mut mesh = Mesh::default();
    let flat =
        [[RIGHT, top[0]], [top[0], groove[0]], [groove[STEPS], top[STEPS + 2]], [top[STEPS + 2], LEFT], [LEFT, RIGHT]];
    flat.iter().for_each(|side| push_side(&mut mesh, side, half_length, rows));
    push_side(&mut mesh, &groove, half_length, rows);
    push_end(&mut mesh, &top, half_length);
    push_end(&mut mesh, &top, -half_length);
    mesh
}

/// The block in convex parts: the corners of one slice per step across.
pub(super) fn convex_parts(half_length: f32) -> Vec<Vec<Vec3>> {
    let slice = |pair: &[Vec2]| {
        let section = [pair[0], pair[1], pair[0].with_y(0.0), pair[1].with_y(0.0)];
        section.iter().flat_map(|p| [p.extend(-half_length), p.extend(half_length)]).collect()
    };
    top().windows(2).map(slice).collect()
}

/// A strip along z that is smooth across; its section runs counter-clockwise around the block as seen from +z.
fn push_side(mesh: &mut Mesh, section: &[Vec2], half_length: f32, rows: usize) {
    let first = mesh.positions.len() as u32;
    let columns = section.len() as u32;
    for row in 0..=rows {
        let z = half_length * (2.0 * row as f32 / rows as f32 - 1.0);
        for (i, point) in section.iter().enumerate() {
            let along = section[(i + 1).min(section.len() - 1)] - section[i.saturating_sub(1)];
            mesh.positions.push(point.extend(z));
            mesh.normals.push(Vec3::new(along.y, -along.x, 0.0).normalize());
        }
    }
    for row in 0..rows as u32 {
        for column in 0..columns - 1 {
            let a = first + row * columns + column;
            let (b, c, d) = (a + 1, a + columns, a + columns + 1);
            mesh.triangles.extend([[a, b, d], [a, d, c]]);
        }
    }
}

/// The section at z, facing away from the middle: one half of the top seen from one bottom corner, one from the other.
fn push_end(mesh: &mut Mesh, top: &[Vec2], z: f32) {
    let first = mesh.positions.len() as u32;
    mesh.positions.extend(top.iter().chain([&RIGHT, &LEFT]).map(|p| p.extend(z)));
    mesh.normals.resize(mesh.positions.len(), Vec3::Z * z.signum());
    let (count, middle) = (top.len() as u32, top.len() as u32 / 2);
    let (right, left) = (count, count + 1);
    let mut triangles = vec![[left, right, middle]];
    triangles.extend((0..middle).map(|i| [right, i, i + 1]));
    triangles.extend((middle..count - 1).map(|i| [left, i, i + 1]));
    let outward = |[a, b, c]: [u32; 3]| if z > 0.0 { [a, b, c] } else { [a, c, b] };
    mesh.triangles.extend(triangles.iter().map(|t| outward(t.map(|i| first + i))));
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::builtin::shapes::tests::check_solid;

    #[test]
    fn a_gutter_is_a_solid_block_without_its_groove() {
        let volume = check_solid(&gutter(1.5, 20));
        let groove = 0.5 * PI * GROOVE_HALF_WIDTH * GROOVE_DEPTH;
        let expected = 3.0 * f64::from(2.0 * HALF_WIDTH * HEIGHT - groove);
        assert!((volume / expected - 1.0).abs() < 0.02, "{volume} instead of {expected}");
    }
}
