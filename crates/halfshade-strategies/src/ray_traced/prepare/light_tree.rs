//! Directions of a map drawn by light times cosine.

use glam::{DVec3, Vec3, Vec4};
use halfshade_scene::light::{EnvironmentMap, OctahedralGrid};
use std::f64::consts::{PI, TAU};

/// The texels of a map in cells, each of which is halved both ways until it is a texel.
///
/// A cell knows the vector M = ∫ L ω dω of its light, summed over the channels, so that its irradiance for a receiver that
/// sees all of it is n·M: exact, without a table. Which of the largest cells a direction falls into is drawn from a table over
/// normals, since of those a horizon leaves parts; below that halves are chosen by n·M, and texels by their light alone.
/// Where a horizon may cut a cell, more than is there is taken for it: no light is left out.
///
/// Halves are chosen by what is left of two numbers, so that points that fill a square evenly become directions that do so by
/// light times cosine \[Clarberg2005\].
#[derive(Debug, Clone)]
pub struct LightTree {
    /// Columns and rows of texels.
    pub size: [usize; 2],
    /// Levels of cells, from the largest cells on; none where texels are as few as those may be.
    pub levels: Vec<Level>,
    /// Vector of each cell, and its power, as parts of all power, level by level.
    pub cells: Vec<Vec4>,
    /// Normals of the table.
    pub grid: OctahedralGrid,
    /// Sums of light times cosine over the largest cells up to each, in their order, for each normal.
    pub sums: Vec<f32>,
    /// Numbers of the largest cells, row by row, along a curve that leads from each to its neighbour: equal parts of the sums are
    /// then parts of the sky that hang together.
    pub order: Vec<u32>,
    /// Columns and rows of the largest cells.
    pub largest: [usize; 2],
    /// Light of texels, summed over the channels, likewise, row by row.
    texels: Vec<f32>,
    /// Solid angle of a texel in each row.
    pub solid_angles: Vec<f32>,
}

/// Cells of one size.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Level {
    /// Columns and rows.
    pub size: [usize; 2],
    /// The number of the first cell.
    pub first: usize,
    /// Chord across a cell at the equator: the most by which cosines within a cell differ.
    pub across: f32,
}

/// A direction of a map.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct MapSample {
    /// In the space of the environment.
    pub(crate) direction: Vec3,
    pub(crate) texel: usize,
    /// Steradians per unit of probability.
    pub(crate) inverse_density: f32,
}

/// Most columns and rows of the largest cells.
const LARGEST: [usize; 2] = [16, 8];

/// Columns of the cells that the table is made from, at least, unless texels are fewer.
const SUMMED_COLUMNS: usize = 64;

/// Cells of the grid over normals from its centre to a side.
const NORMAL_CELLS: usize = 12;

/// A normal is at most about so far from its node.
const NORMAL_SPREAD: f32 = 0.09;

/// Light times cosine of a cell, at least: `along` is n·M, `slack` its power times the most by which cosines differ within.
pub(crate) fn cell_weight(along: f32, slack: f32) -> f32 {
    if along >= slack {
        return along;
    }
    let above = (along + slack).max(0.0);
    if above > 0.0 { 0.25 * above * (above / slack) } else { 0.0 }
}

impl LightTree {
    pub(crate) fn new(map: &EnvironmentMap) -> Self {
        let size = [map.width(), map.height()];
        let solid_angles: Vec<f32> = (0..size[1]).map(|row| map.texel_solid_angle(row) as f32).collect();
        let mut vectors = texel_vectors(map);
        // Parts of all the power: of light however strong or faint.
        let power: f64 = vectors.iter().map(|vector| vector.w).sum();
        let part = if power > 0.0 { power.recip() } else { 1.0 };
        vectors.iter_mut().for_each(|vector| *vector *= part);
        let texel = |texel: &Vec3| (part * texel.as_dvec3().element_sum()) as f32;
        let texels: Vec<f32> = map.texels().iter().map(texel).collect();
        let grid = OctahedralGrid::new(NORMAL_CELLS);
        let mut tree = Self {
            size,
            levels: Vec::new(),
            cells: Vec::new(),
            grid,
            sums: Vec::new(),
            order: Vec::new(),
            largest: [0; 2],
            texels,
            solid_angles,
        };
        // From texels to the largest cells.
        let mut stages = vec![(size, vectors)];
        while let Some((size, cells)) = stages.last().filter(|(size, _)| size[0] > LARGEST[0] || size[1] > LARGEST[1]) {
            stages.push(joined(*size, cells));
        }
        tree.largest = stages.last().map_or([0; 2], |(size, _)| *size);
        tree.order = ordered(tree.largest);
        let summed = stages.iter().rposition(|(size, _)| size[0] >= SUMMED_COLUMNS).unwrap_or(0);
        tree.sums = tree.sums_by_normal(&stages[summed], stages.len() - 1 - summed);
        // Texels have no vectors of their own.
        for (stage, (size, cells)) in stages.iter().enumerate().skip(1).rev() {
            let across = across(map, stage);
            tree.levels.push(Level { size: *size, first: tree.cells.len(), across });
            tree.cells.extend(cells.iter().map(|cell| cell.as_vec4()));
        }
        tree
    }

    fn sums_by_normal(&self, (size, cells): &([usize; 2], Vec<glam::DVec4>), halvings: usize) -> Vec<f32> {
        let across = (TAU / size[0] as f64).hypot(PI / size[1] as f64).min(2.0) as f32 + NORMAL_SPREAD;
        let count = self.largest[0] * self.largest[1];
        let mut rank = vec![0; count];
        self.order.iter().zip(0..).for_each(|(&cell, place)| rank[cell as usize] = place);
        let mut sums = Vec::with_capacity(self.grid.node_count() * count);
        let cells: Vec<Vec4> = cells.iter().map(|cell| cell.as_vec4()).collect();
        for node in 0..self.grid.node_count() {
            let normal = self.grid.direction(node);
            let first = sums.len();
            sums.resize(first + count, 0.0);
            for (number, cell) in cells.iter().enumerate() {
                let [column, row] = [number % size[0], number / size[0]].map(|place| place >> halvings);
                let weight = cell_weight(normal.dot(cell.truncate()), cell.w * across);
                sums[first + rank[row * self.largest[0] + column]] += weight;
            }
            for place in first + 1..first + count {
                sums[place] += sums[place - 1];
            }
        }
        sums
    }

    /// A direction for a receiver with unit `normal` in the space of the environment, `None` where nothing shines.
    pub(crate) fn sample(&self, normal: Vec3, [mut u, mut v]: [f32; 2]) -> Option<MapSample> {
        let found = self.grid.lookup(normal);
        let nearest = (1..3).fold(0, |best, k| if found.weights[k] > found.weights[best] { k } else { best });
        let count = self.largest[0] * self.largest[1];
        let sums = self.sums.get(found.nodes[nearest] * count..)?.get(..count)?;
        let total = *sums.last()?;
        if !(total > 0.0 && total < f32::INFINITY) {
            return None;
        }
        let target = u * total;
        let part = sums.partition_point(|sum| *sum <= target).min(count - 1);
        let before = if part == 0 { 0.0 } else { sums[part - 1] };
        let own = sums[part] - before;
        let cell = self.order[part] as usize;
        u = ((target - before) / own).clamp(0.0, BELOW_ONE);
        let mut chance = own / total;
        let mut place = [cell % self.largest[0], cell / self.largest[0]];
        for below in 1..=self.levels.len() {
            let weights = self.halves(normal, place, below);
            let [upper, lower] = weights.map(|[left, right]| left + right);
            if upper + lower <= 0.0 {
                return None;
            }
            let (row, share) = halved(&mut v, upper, lower);
            let (column, of_row) = halved(&mut u, weights[row][0], weights[row][1]);
            chance *= share * of_row;
            place = [2 * place[0] + column, 2 * place[1] + row];
        }
        let solid_angle = self.solid_angles[place[1]];
        let texel = place[1] * self.size[0] + place[0];
        let direction = self.within(place, [u, v]);
        (chance > 0.0).then(|| MapSample { direction, texel, inverse_density: solid_angle / chance })
    }

    /// Weights of the two by two parts of a cell: rows of columns. Beyond the edge there are none.
    fn halves(&self, normal: Vec3, place: [usize; 2], below: usize) -> [[f32; 2]; 2] {
        let [column, row] = place.map(|place| 2 * place);
        let level = self.levels.get(below);
        let size = level.map_or(self.size, |level| level.size);
        [0, 1].map(|down| {
            [0, 1].map(|right| {
                let (column, row) = (column + right, row + down);
                if column >= size[0] || row >= size[1] {
                    return 0.0;
                }
                match level {
                    None => self.texels[row * size[0] + column] * self.solid_angles[row],
                    Some(level) => {
                        let cell = self.cells[level.first + row * size[0] + column];
                        cell_weight(normal.dot(cell.truncate()), cell.w * level.across)
                    }
                }
            })
        })
    }

    /// A direction within a texel.
    fn within(&self, [column, row]: [usize; 2], [u, v]: [f32; 2]) -> Vec3 {
        let [width, height] = self.size.map(|size| size as f32);
        let edge = |row: usize| (std::f32::consts::PI * row as f32 / height).cos();
        let up = edge(row) + v * (edge(row + 1) - edge(row));
        let (sin, cos) = (((column as f32 + u) / width - 0.5) * std::f32::consts::TAU).sin_cos();
        let across = ((1.0 - up) * (1.0 + up)).max(0.0).sqrt();
        Vec3::new(across * sin, up, -across * cos)
    }

    pub(crate) fn bytes(&self) -> usize {
        let numbers = self.sums.len() + self.order.len() + self.texels.len() + self.solid_angles.len();
        size_of_val(self.cells.as_slice()) + 4 * numbers
    }
}

/// Cells along Hilbert's curve over a square of twice as many rows, of which it fills the first half first.
fn ordered([columns, rows]: [usize; 2]) -> Vec<u32> {
    let mut cells: Vec<u32> = (0..(columns * rows) as u32).collect();
    cells.sort_by_key(|&cell| along_curve([cell / columns as u32, cell % columns as u32]));
    cells
}

/// The place of a cell along Hilbert's curve over a square of [`LARGEST`] cells in a row.
fn along_curve([mut x, mut y]: [u32; 2]) -> u32 {
    let mut place = 0;
    let mut half = LARGEST[0] as u32 / 2;
    while half > 0 {
        let is_far = [x & half, y & half].map(|bit| u32::from(bit > 0));
        place += half * half * ((3 * is_far[0]) ^ is_far[1]);
        if is_far[1] == 0 {
            if is_far[0] == 1 {
                [x, y] = [x, y].map(|place| (2 * half - 1).wrapping_sub(place) & (2 * half - 1));
            }
            (x, y) = (y, x);
        }
        half /= 2;
    }
    place
}

/// The largest number below 1.
const BELOW_ONE: f32 = 1.0 - f32::EPSILON / 2.0;

/// Which of two halves a number falls into, and with which probability; of the number its place there is left.
fn halved(number: &mut f32, first: f32, second: f32) -> (usize, f32) {
    let share = first / (first + second);
    let (half, place, own) =
        if *number < share { (0, *number / share, share) } else { (1, (*number - share) / (1.0 - share), 1.0 - share) };
    *number = place.clamp(0.0, BELOW_ONE);
    (half, own)
}

/// The chord across a cell of `2^stage` texels either way.
fn across(map: &EnvironmentMap, stage: usize) -> f32 {
    let texels = (1u64 << stage) as f64;
    (texels * TAU / map.width() as f64).hypot(texels * PI / map.height() as f64).min(2.0) as f32
}

/// ∫ L ω dω of each texel, and ∫ L dω.
fn texel_vectors(map: &EnvironmentMap) -> Vec<glam::DVec4> {
    let (width, height) = (map.width(), map.height());
    // Over columns ∫ (sin φ, -cos φ) dφ, with φ = 0 the middle of the map.
    let turn = |column: usize| (column as f64 / width as f64 - 0.5) * TAU;
    let around: Vec<[f64; 2]> = (0..width)
        .map(|column| {
            let (low, high) = (turn(column), turn(column + 1));
            [low.cos() - high.cos(), low.sin() - high.sin()]
        })
        .collect();
    let step = TAU / width as f64;
    let mut vectors = Vec::with_capacity(width * height);
    for (row, texels) in map.texels().chunks_exact(width).enumerate() {
        let [top, bottom] = [row, row + 1].map(|row| PI * row as f64 / height as f64);
        // ∫ sin²θ dθ and ∫ cos θ sin θ dθ.
        let across = 0.5 * (bottom - top) - 0.25 * ((2.0 * bottom).sin() - (2.0 * top).sin());
        let up = 0.5 * (bottom.sin().powi(2) - top.sin().powi(2));
        let solid_angle = step * (top.cos() - bottom.cos());
        for (texel, [x, z]) in texels.iter().zip(&around) {
            let vector = DVec3::new(across * x, up * step, across * z).extend(solid_angle);
            vectors.push(vector * texel.as_dvec3().element_sum());
        }
    }
    vectors
}

/// Cells of two by two.
fn joined(size: [usize; 2], cells: &[glam::DVec4]) -> ([usize; 2], Vec<glam::DVec4>) {
    let half = size.map(|size| size.div_ceil(2));
    let mut sums = vec![glam::DVec4::ZERO; half[0] * half[1]];
    for (number, cell) in cells.iter().enumerate() {
        let (column, row) = (number % size[0], number / size[0]);
        sums[row / 2 * half[0] + column / 2] += *cell;
    }
    (half, sums)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::ray_traced::shade::sequence::Sequence;
    use halfshade_scene::light::DirectionalCells;

    fn map(width: usize, height: usize, bright: usize) -> EnvironmentMap {
        let texel = |i: usize| if i == bright { Vec3::splat(2000.0) } else { Vec3::splat(0.2 + (i * 7 % 5) as f32) };
        EnvironmentMap::new(width, height, (0..width * height).map(texel).collect()).unwrap()
    }

    /// The mean of light times cosine over the density is the irradiance, and each sample is near it where no horizon cuts
    /// a cell: that is what drawing by it means.
    #[test]
    fn means_over_drawn_directions_are_irradiances() {
        for (width, height, bright) in [(64, 32, 700), (1, 1, 9), (16, 8, 20), (37, 21, 100), (129, 70, 2000)] {
            let map = map(width, height, bright);
            let tree = LightTree::new(&map);
            let exact = DirectionalCells::new(&map);
            for normal in [Vec3::Y, Vec3::new(0.6, 0.0, -0.8), Vec3::new(0.48, 0.6, 0.64), Vec3::NEG_Y] {
                let sequence = Sequence::new(3, 4096);
                let value = |i: u32| {
                    // A cell that the horizon leaves nothing of may be drawn, too.
                    let Some(found) = tree.sample(normal, sequence.at(i)) else { return 0.0 };
                    let light = map.texels()[found.texel].x * found.inverse_density;
                    assert!((found.direction.length() - 1.0).abs() < 1e-5);
                    let [column, row] = <[usize; 2]>::from(map.texel_at(found.direction));
                    assert!(row.abs_diff(found.texel / width) <= 1 && (column == found.texel % width || height > 1));
                    f64::from(light * normal.dot(found.direction).max(0.0))
                };
                let values: Vec<f64> = (0..4096).map(value).collect();
                let mean = values.iter().sum::<f64>() / 4096.0;
                let exact = f64::from(exact.irradiance(normal).x);
                assert!((mean / exact - 1.0).abs() < 0.02, "{width} {normal}: {mean} {exact}");
                let variance = values.iter().map(|value| (value / mean - 1.0).powi(2)).sum::<f64>() / 4096.0;
                assert!(width < 32 || variance < 0.15, "{width} {normal}: {variance}");
            }
        }
    }

    /// Each cell once, and neighbours follow each other.
    #[test]
    fn the_curve_leads_from_neighbour_to_neighbour() {
        let order = ordered(LARGEST);
        let mut sorted = order.clone();
        sorted.sort_unstable();
        assert_eq!(sorted, (0..128).collect::<Vec<u32>>());
        let place = |cell: u32| [cell % 16, cell / 16];
        for pair in order.windows(2) {
            let ([a, b], [c, d]) = (place(pair[0]), place(pair[1]));
            assert_eq!(a.abs_diff(c) + b.abs_diff(d), 1, "{order:?}");
        }
    }

    #[test]
    fn a_black_map_draws_nothing() {
        let map = EnvironmentMap::new(40, 20, vec![Vec3::ZERO; 800]).unwrap();
        assert_eq!(LightTree::new(&map).sample(Vec3::Y, [0.3, 0.6]), None);
    }
}
