//! The inside of a mesh as runs along parallel columns, and volumes outside of it.
//!
//! Space is cut by a square lattice of lines parallel to one axis; along each line the inside of the mesh is a list of
//! disjoint intervals whose ends are exact ray-triangle crossings. A volume is the lattice's cell area times the sum of
//! lengths along its lines: exact along the axis, a midpoint rule across it. Spheres fit the same form (a chord per
//! line), so that unions and differences of spheres and mesh are interval arithmetic.
//!
//! *Inside* is where the winding number along the line is not zero, so that bodies may overlap and whole bodies may be
//! inside out. Lines along which the winding number doesn't return to zero (a mesh that is not closed) are settled by
//! the lines of the two other directions: a point is inside if the sound lines through it say so.

use super::DSphere;
use glam::{DVec2, DVec3};

/// Runs along one line: disjoint, rising.
pub(super) type Run = [f64; 2];

/// A solid as runs along the lines of a square lattice.
#[derive(Debug, Clone)]
pub(super) struct Columns {
    /// The axis along which the lines run.
    axis: usize,
    /// Distance of neighbouring lines.
    step: f64,
    /// Lattice indices of the stored lines' first row and column; others are empty.
    first: [i64; 2],
    size: [usize; 2],
    /// Runs of line (i, j): `runs[starts[k]..starts[k + 1]]` with k = j·size[0] + i.
    starts: Vec<u32>,
    runs: Vec<Run>,
}

/// Columns of a mesh, and how sound they are.
#[derive(Debug, Clone)]
pub(super) struct Solid {
    /// The inside of the mesh.
    pub(super) columns: Columns,
    /// Fraction of the lines that hit the mesh whose winding number does not return to zero.
    pub(super) open_fraction: f64,
}

/// Position of line `index` of a lattice. The irrational shift keeps lines off the vertices of regular meshes.
fn line_position(index: i64, step: f64) -> f64 {
    (index as f64 + 0.381_966_011_250_105) * step
}

fn first_line_at_or_after(position: f64, step: f64) -> i64 {
    (position / step - 0.381_966_011_250_105).ceil() as i64
}

/// The two coordinates across `axis`, then the one along it.
fn split(point: DVec3, axis: usize) -> (DVec2, f64) {
    (DVec2::new(point[(axis + 1) % 3], point[(axis + 2) % 3]), point[axis])
}

impl Columns {
    /// Lines that cover the rectangle of `min` to `max` across the axis, all runs from `runs_of(i, j)`.
    fn from_lines(
        axis: usize,
        step: f64,
        [min, max]: [DVec2; 2],
        mut append: impl FnMut([i64; 2], &mut Vec<Run>),
    ) -> Self {
        let first = [first_line_at_or_after(min.x, step), first_line_at_or_after(min.y, step)];
        let size = [max.x, max.y].map(|m| first_line_at_or_after(m, step));
        let size = [(size[0] - first[0]).max(0) as usize, (size[1] - first[1]).max(0) as usize];
        let (mut starts, mut runs) = (Vec::with_capacity(size[0] * size[1] + 1), Vec::new());
        starts.push(0);
        for j in 0..size[1] as i64 {
            for i in 0..size[0] as i64 {
                append([first[0] + i, first[1] + j], &mut runs);
                starts.push(runs.len() as u32);
            }
        }
        Self { axis, step, first, size, starts, runs }
    }

    /// Runs of the line with lattice index `line`.
    fn line(&self, line: [i64; 2]) -> &[Run] {
        let (i, j) = (line[0] - self.first[0], line[1] - self.first[1]);
        if i < 0 || j < 0 || i >= self.size[0] as i64 || j >= self.size[1] as i64 {
            return &[];
        }
        let k = j as usize * self.size[0] + i as usize;
        &self.runs[self.starts[k] as usize..self.starts[k + 1] as usize]
    }

    /// The volume of the solid.
    pub(super) fn volume(&self) -> f64 {
        self.runs.iter().map(|run| run[1] - run[0]).sum::<f64>() * self.step * self.step
    }

    /// Whether the line nearest to `point` is inside at the point's height.
    pub(super) fn contains(&self, point: DVec3) -> bool {
        let (across, along) = split(point, self.axis);
        let line = [across.x, across.y].map(|x| first_line_at_or_after(x - 0.5 * self.step, self.step));
        self.line(line).iter().any(|run| run[0] <= along && along <= run[1])
    }

    /// Calls `visit(line, distance², middle)` for each lattice line that meets the sphere's circle.
    fn lines_through(&self, sphere: &DSphere, mut visit: impl FnMut([i64; 2], f64, f64)) {
        let (across, along) = split(sphere.center, self.axis);
        let squared = sphere.radius * sphere.radius;
        let rows = first_line_at_or_after(across.y - sphere.radius, self.step)
            ..first_line_at_or_after(across.y + sphere.radius, self.step);
        for j in rows {
            let dy = line_position(j, self.step) - across.y;
            let half_width = (squared - dy * dy).max(0.0).sqrt();
            let columns = first_line_at_or_after(across.x - half_width, self.step)
                ..first_line_at_or_after(across.x + half_width, self.step);
            for i in columns {
                let dx = line_position(i, self.step) - across.x;
                visit([i, j], dx * dx + dy * dy, along);
            }
        }
    }

    /// The volume of the sphere outside the solid.
    pub(super) fn outside(&self, sphere: &DSphere) -> f64 {
        let squared = sphere.radius * sphere.radius;
        let mut length = 0.0;
        self.lines_through(sphere, |line, distance_squared, middle| {
            let half = (squared - distance_squared).max(0.0).sqrt();
            let (low, high) = (middle - half, middle + half);
            length += high - low;
            for run in self.line(line) {
                length -= (high.min(run[1]) - low.max(run[0])).max(0.0);
            }
        });
        length * self.step * self.step
    }

    /// This solid and `spheres` together, over the window in which spheres inside `region` lie; lines beyond it are
    /// empty.
    pub(super) fn united_with<'a>(&self, spheres: impl Iterator<Item = &'a DSphere>, region: &DSphere) -> Self {
        let (across, _) = split(region.center, self.axis);
        let window = [across - DVec2::splat(region.radius), across + DVec2::splat(region.radius + self.step)];
        let near: Vec<&DSphere> =
            spheres.filter(|b| b.center.distance(region.center) < b.radius + region.radius).collect();
        Self::from_lines(self.axis, self.step, window, |line, runs| {
            let begin = runs.len();
            runs.extend_from_slice(self.line(line));
            let position = DVec2::new(line_position(line[0], self.step), line_position(line[1], self.step));
            for sphere in &near {
                let (center, along) = split(sphere.center, self.axis);
                let half_squared = sphere.radius * sphere.radius - center.distance_squared(position);
                if half_squared > 0.0 {
                    let half = half_squared.sqrt();
                    runs.push([along - half, along + half]);
                }
            }
            merge(runs, begin);
        })
    }

    /// Volume of the union of the spheres outside the solid.
    pub(super) fn union_outside(&self, spheres: &[DSphere]) -> f64 {
        self.union_parts(spheres)[0]
    }

    /// Volumes of the union of the spheres outside and inside the solid.
    pub(super) fn union_parts(&self, spheres: &[DSphere]) -> [f64; 2] {
        let mut chords: Vec<([i64; 2], Run)> = Vec::new();
        for sphere in spheres {
            let squared = sphere.radius * sphere.radius;
            self.lines_through(sphere, |line, distance_squared, middle| {
                let half = (squared - distance_squared).max(0.0).sqrt();
                chords.push((line, [middle - half, middle + half]));
            });
        }
        chords.sort_unstable_by(|a, b| a.0.cmp(&b.0).then(a.1[0].total_cmp(&b.1[0])));
        let (mut whole, mut shared) = (0.0, 0.0);
        let mut merged = Vec::new();
        for group in chords.chunk_by(|a, b| a.0 == b.0) {
            merged.clear();
            merged.extend(group.iter().map(|(_, run)| *run));
            merge(&mut merged, 0);
            let inside = self.line(group[0].0);
            for chord in &merged {
                whole += chord[1] - chord[0];
                for run in inside {
                    shared += (chord[1].min(run[1]) - chord[0].max(run[0])).max(0.0);
                }
            }
        }
        [whole - shared, shared].map(|length| length * self.step * self.step)
    }
}

/// Sorts the runs from `begin` on and joins those that overlap.
fn merge(runs: &mut Vec<Run>, begin: usize) {
    if runs.len() - begin < 2 {
        return;
    }
    runs[begin..].sort_unstable_by(|a, b| a[0].total_cmp(&b[0]));
    let mut last = begin;
    for k in begin + 1..runs.len() {
        if runs[k][0] <= runs[last][1] {
            runs[last][1] = runs[last][1].max(runs[k][1]);
        } else {
            last += 1;
            runs[last] = runs[k];
        }
    }
    runs.truncate(last + 1);
}

impl Solid {
    /// The inside of a triangle mesh, along lines `step` apart parallel to `axis`.
    pub(super) fn new(corners: &[[DVec3; 3]], axis: usize, step: f64) -> Self {
        let main = Traced::new(corners, axis, step);
        let hit = main.crossings.iter().filter(|c| !c.is_empty()).count();
        let open = (0..main.crossings.len()).filter(|&k| main.winding_at_end(k) != 0).count();
        // The other two directions are only traced where this one fails.
        let open_fraction = if hit == 0 { 0.0 } else { open as f64 / hit as f64 };
        let others = (open > 0).then(|| [1, 2].map(|turn| Traced::new(corners, (axis + turn) % 3, step)));
        let columns = Columns::from_lines(axis, step, main.window, |line, runs| {
            let k = main.index(line);
            match &others {
                Some(others) if main.winding_at_end(k) != 0 => main.vote(line, k, others, runs),
                _ => main.append_runs(k, runs),
            }
        });
        Self { columns, open_fraction }
    }
}

/// Signed crossings of the mesh with every line of one direction.
struct Traced {
    axis: usize,
    step: f64,
    window: [DVec2; 2],
    first: [i64; 2],
    width: usize,
    /// Position along the line and change of the winding number, sorted.
    crossings: Vec<Vec<(f64, i32)>>,
}

impl Traced {
    fn new(corners: &[[DVec3; 3]], axis: usize, step: f64) -> Self {
        let (mut min, mut max) = (DVec2::INFINITY, DVec2::NEG_INFINITY);
        for corner in corners.iter().flatten() {
            let (across, _) = split(*corner, axis);
            (min, max) = (min.min(across), max.max(across));
        }
        if corners.is_empty() {
            (min, max) = (DVec2::ZERO, DVec2::ZERO);
        }
        let window = [min, max + DVec2::splat(step)];
        let first = [first_line_at_or_after(min.x, step), first_line_at_or_after(min.y, step)];
        let width = (first_line_at_or_after(window[1].x, step) - first[0]).max(0) as usize;
        let height = (first_line_at_or_after(window[1].y, step) - first[1]).max(0) as usize;
        let mut crossings = vec![Vec::new(); width * height];
        for triangle in corners {
            let [a, b, c] = triangle.map(|corner| split(corner, axis));
            let (low, high) = (a.0.min(b.0).min(c.0), a.0.max(b.0).max(c.0));
            for j in first_line_at_or_after(low.y, step)..first_line_at_or_after(high.y, step) {
                for i in first_line_at_or_after(low.x, step)..first_line_at_or_after(high.x, step) {
                    let line = DVec2::new(line_position(i, step), line_position(j, step));
                    let sides = [side(b.0, c.0, line), side(c.0, a.0, line), side(a.0, b.0, line)];
                    let positive = sides.map(|(_, positive)| positive);
                    if positive != [positive[0]; 3] {
                        continue;
                    }
                    let weights = sides.map(|(weight, _)| weight);
                    let sum: f64 = weights.iter().sum();
                    if sum != 0.0 {
                        let along = (weights[0] * a.1 + weights[1] * b.1 + weights[2] * c.1) / sum;
                        let k = (j - first[1]) as usize * width + (i - first[0]) as usize;
                        // Seen along the axis, a counter-clockwise triangle is a back face: the line leaves.
                        crossings[k].push((along, if positive[0] { -1 } else { 1 }));
                    }
                }
            }
        }
        for line in &mut crossings {
            line.sort_unstable_by(|a, b| a.0.total_cmp(&b.0).then(b.1.cmp(&a.1)));
        }
        Self { axis, step, window, first, width, crossings }
    }

    fn index(&self, line: [i64; 2]) -> usize {
        (line[1] - self.first[1]) as usize * self.width + (line[0] - self.first[0]) as usize
    }

    fn winding_at_end(&self, k: usize) -> i32 {
        self.crossings[k].iter().map(|(_, change)| change).sum()
    }

    fn append_runs(&self, k: usize, runs: &mut Vec<Run>) {
        let mut winding = 0;
        let mut begin = 0.0;
        for &(along, change) in &self.crossings[k] {
            if winding == 0 {
                begin = along;
            }
            winding += change;
            if winding == 0 && along > begin {
                runs.push([begin, along]);
            }
        }
    }

    /// Answer of the line nearest to `point`, if it is sound.
    fn nearest_line_says(&self, point: DVec3) -> Option<bool> {
        let (across, along) = split(point, self.axis);
        let line = [across.x, across.y].map(|x| first_line_at_or_after(x - 0.5 * self.step, self.step));
        let (i, j) = (line[0] - self.first[0], line[1] - self.first[1]);
        if i < 0 || j < 0 || i >= self.width as i64 || j as usize * self.width >= self.crossings.len() {
            return Some(false);
        }
        let k = self.index(line);
        if self.winding_at_end(k) != 0 {
            return None;
        }
        let winding: i32 = self.crossings[k].iter().take_while(|(at, _)| *at <= along).map(|(_, change)| change).sum();
        Some(winding != 0)
    }

    /// Runs of a line that is not sound, between its crossings, as the other directions see it.
    fn vote(&self, line: [i64; 2], k: usize, others: &[Self; 2], runs: &mut Vec<Run>) {
        let begin = runs.len();
        let across = DVec2::new(line_position(line[0], self.step), line_position(line[1], self.step));
        let mut point = DVec3::ZERO;
        (point[(self.axis + 1) % 3], point[(self.axis + 2) % 3]) = (across.x, across.y);
        // Cells along the line between the bounds of the mesh, which the other directions know.
        let low = others[0].window[0][1].min(others[1].window[0][0]);
        let high = others[0].window[1][1].max(others[1].window[1][0]);
        let cells = ((high - low) / self.step).ceil().max(0.0) as usize;
        for cell in 0..cells {
            let start = low + cell as f64 * self.step;
            point[self.axis] = start + 0.5 * self.step;
            let votes = others.each_ref().map(|other| other.nearest_line_says(point));
            let inside = match votes {
                [Some(a), Some(b)] => a && b,
                [Some(vote), None] | [None, Some(vote)] => vote,
                // No sound line at all: inside if this line has entered more often than left, or the reverse.
                [None, None] => {
                    let entered = self.crossings[k].iter().take_while(|(at, _)| *at <= point[self.axis]).count();
                    entered % 2 == 1 && entered < self.crossings[k].len()
                }
            };
            if inside {
                runs.push([start, start + self.step]);
            }
        }
        merge(runs, begin);
    }
}

/// Twice the signed area of (a, b, point), and its sign with ties broken so that two triangles that share the edge
/// never both claim or both refuse a line.
fn side(a: DVec2, b: DVec2, point: DVec2) -> (f64, bool) {
    let swapped = (b.x, b.y) < (a.x, a.y);
    let (low, high) = if swapped { (b, a) } else { (a, b) };
    let area = (high - low).perp_dot(point - low);
    if swapped { (-area, area < 0.0) } else { (area, area >= 0.0) }
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::f64::consts::PI;

    /// The box from -1/2 to 1/2.
    fn unit_box() -> Vec<[DVec3; 3]> {
        let mesh = crate::builtin::shapes::box_mesh(1);
        mesh.triangles.iter().map(|t| t.map(|k| 0.5 * mesh.positions[k as usize].as_dvec3())).collect()
    }

    fn sphere(x: f64, radius: f64) -> DSphere {
        DSphere { center: DVec3::new(x, 0.0, 0.0), radius }
    }

    #[test]
    fn volumes_against_closed_forms() {
        for axis in 0..3 {
            let solid = Solid::new(&unit_box(), axis, 0.005);
            assert_eq!(solid.open_fraction, 0.0);
            let close = |a: f64, b: f64| assert!((a - b).abs() < 2e-3 * (1.0 + b), "axis {axis}: {a} {b}");
            close(solid.columns.volume(), 1.0);
            assert!(solid.columns.outside(&sphere(0.0, 0.49)).abs() < 1e-12);
            close(solid.columns.outside(&sphere(0.5, 0.4)), 2.0 / 3.0 * PI * 0.064);
            close(solid.columns.outside(&sphere(3.0, 0.7)), 4.0 / 3.0 * PI * 0.343);
            // Two unit spheres a radius apart share a lens of 5π/12.
            let two = [sphere(4.0, 1.0), sphere(5.0, 1.0)];
            close(solid.columns.union_outside(&two), (8.0 / 3.0 - 5.0 / 12.0) * PI);
            let [outside, inside] = solid.columns.union_parts(&[sphere(0.5, 0.4)]);
            close(outside, 2.0 / 3.0 * PI * 0.064);
            close(inside, 2.0 / 3.0 * PI * 0.064);
            let rest = solid.columns.united_with(two[..1].iter(), &two[1]);
            close(rest.outside(&two[1]), (4.0 / 3.0 - 5.0 / 12.0) * PI);
        }
    }

    #[test]
    fn a_hole_in_one_face_is_seen_through_by_the_other_directions() {
        let mut open = unit_box();
        open.retain(|t| !t.iter().all(|corner| corner.z > 0.49));
        let solid = Solid::new(&open, 2, 0.02);
        assert!(solid.open_fraction > 0.9);
        assert!((solid.columns.volume() - 1.0).abs() < 0.05, "{}", solid.columns.volume());
    }
}
