//! Directions by normal, drawn from light times cosine.
//!
//! Every node of a grid over normals has directions of its own, each standing for a cell of about the same importance
//!
//! ```text
//! ∫ L(ω) max(n·ω + s, 0) dω
//! ```
//!
//! in which s is the sine of the largest angle between a receiver's normal and the node that is nearest to it: what such a
//! receiver sees above its horizon has directions. Under constant light they lie on a spiral of the golden angle. A map is cut in
//! two parts of equal importance, across where they are longest, and these again \[Debevec2005\]; a part's direction is the
//! mean of its light's. Weights are L times the solid angle, exact for every part, so that what isn't blocked adds up.

use crate::mask::kernel::directions::{BLOCK, DirectionSet, Directions8};
use glam::{DVec3, Vec3};
use halfshade_scene::light::{DirectionalCells, DistantLight, OctahedralGrid};
use halfshade_sh::quadrature::GOLDEN_ANGLE;
use rayon::prelude::*;
use std::f64::consts::{PI, TAU};
use wide::f32x8;

/// Solid angle of a cell of [`DirectionalCells`] over the sine of its polar angle.
const CELL: f64 = (TAU / 128.0) * (PI / 64.0);

/// By how much a later node is to be nearer: normals half-way between nodes are frequent, and rounding is not to tell them apart.
const PREFERENCE: f32 = 1e-3;

/// Normals among which the one that is farthest from its node is looked for.
const SAMPLED_NORMALS: usize = 4096;

/// Numbers that say which directions are drawn.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Drawing {
    /// Directions of a set.
    pub(crate) count: usize,
    /// Cells of the grid over normals from its centre to its side; 0: one set for all.
    pub(crate) normals: usize,
    /// Width of an edge in radii of a direction's cell.
    pub(crate) edge: f32,
}

/// The directions of all receivers, in the environment's space.
#[derive(Debug, Clone)]
pub(crate) struct DirectionSets {
    /// `None`: there is one set.
    grid: Option<OctahedralGrid>,
    pub(crate) sets: Vec<DirectionSet>,
    /// 1 where all channels have the same weights, else 3.
    pub(crate) channels: usize,
}

/// A direction and the cell that it stands for.
#[derive(Debug, Clone, Copy)]
struct Direction {
    direction: DVec3,
    solid_angle: f64,
    weights: DVec3,
}

/// Light from a small solid angle.
#[derive(Debug, Clone, Copy)]
struct Part {
    direction: DVec3,
    solid_angle: f64,
    /// ∫ L dω by channel, relative to the whole map's.
    light: DVec3,
    /// The cosine at the normal and the slack, at least 0.
    above: f64,
    /// Light times that.
    importance: f64,
    /// Place on a disc about the normal, on which equal areas are equal solid angles.
    place: [f64; 2],
}

impl DirectionSets {
    /// Under `light`.
    pub(crate) fn new(light: &DistantLight, drawing: &Drawing) -> Self {
        let grid = (drawing.normals > 0).then(|| OctahedralGrid::new(drawing.normals));
        let (nodes, slack) = match &grid {
            None => (vec![DVec3::Y], f64::INFINITY),
            Some(grid) => {
                let nodes = (0..grid.node_count()).map(|node| grid.direction(node).as_dvec3().normalize());
                (nodes.collect(), slack(grid))
            }
        };
        let (parts, channels) = match light {
            DistantLight::Constant(_) => (Vec::new(), 1),
            DistantLight::Map(map) => parts(&DirectionalCells::new(map)),
        };
        let drawn = |&normal: &DVec3| {
            let directions = match light {
                DistantLight::Constant(_) => spiral(normal, slack, drawing.count),
                DistantLight::Map(_) => cut(&parts, normal, slack, drawing.count),
            };
            packed(&directions, channels, drawing.edge)
        };
        Self { grid, sets: nodes.par_iter().map(drawn).collect(), channels }
    }

    /// The set of receivers with a normal.
    #[inline(always)]
    pub(crate) fn number(&self, normal: Vec3) -> usize {
        self.grid.map_or(0, |grid| nearest(&grid, normal))
    }

    pub(crate) fn bytes(&self) -> usize {
        let of = |set: &DirectionSet| {
            let weights: usize = set.weights.iter().map(|weights| size_of_val(weights.as_slice())).sum();
            size_of_val(set.directions.as_slice()) + weights
        };
        self.sets.iter().map(of).sum()
    }
}

/// The node next to a normal.
#[inline(always)]
fn nearest(grid: &OctahedralGrid, normal: Vec3) -> usize {
    let found = grid.lookup(normal);
    let is_heavier = |k: usize, best: usize| found.weights[k] > found.weights[best] + PREFERENCE;
    let heavier = |best: usize, k: usize| if is_heavier(k, best) { k } else { best };
    found.nodes[(1..3).fold(0, heavier)]
}

/// Sine of the largest angle between a normal and its node.
fn slack(grid: &OctahedralGrid) -> f64 {
    let cosine = |normal: DVec3| grid.direction(nearest(grid, normal.as_vec3())).as_dvec3().normalize().dot(normal);
    let least =
        spiral(DVec3::Y, f64::INFINITY, SAMPLED_NORMALS).iter().map(|d| cosine(d.direction)).fold(1.0, f64::min);
    (1.0 - least * least).max(0.0).sqrt()
}

/// Directions with density `max(normal·ω + slack, 0)`; evenly over all directions if `slack` is infinite.
fn spiral(normal: DVec3, slack: f64, count: usize) -> Vec<Direction> {
    let (a, b) = normal.any_orthonormal_pair();
    let direction = |i: usize| {
        let within = (i as f64 + 0.5) / count as f64;
        let (cosine, density) = if slack.is_finite() {
            let above = within.sqrt() * (1.0 + slack);
            (above - slack, above / (PI * (1.0 + slack).powi(2)))
        } else {
            (1.0 - 2.0 * within, 1.0 / (4.0 * PI))
        };
        let across = (1.0 - cosine * cosine).max(0.0).sqrt();
        let (sin, cos) = (GOLDEN_ANGLE * i as f64).sin_cos();
        let solid_angle = 1.0 / (density * count as f64);
        Direction {
            direction: (across * (cos * a + sin * b) + cosine * normal).normalize(),
            solid_angle,
            weights: DVec3::splat(solid_angle),
        }
    };
    (0..count).map(direction).collect()
}

/// The cells of a map's light, and how many channels differ.
fn parts(cells: &DirectionalCells) -> (Vec<Part>, usize) {
    let lights = || cells.vector_irradiance.iter().map(|v| DVec3::from(v.map(|v| v.as_dvec3().length())));
    let whole: DVec3 = lights().sum();
    let relative = |light: DVec3| light / whole.max(DVec3::splat(f64::MIN_POSITIVE));
    let parts: Vec<Part> = (cells.direction.iter().zip(lights()))
        .map(|(direction, light)| {
            let direction = direction.as_dvec3().normalize();
            let solid_angle = CELL * (1.0 - direction.y * direction.y).max(0.0).sqrt();
            Part { direction, solid_angle, light: relative(light), above: 0.0, importance: 0.0, place: [0.0; 2] }
        })
        .collect();
    let is_grey = cells.vector_irradiance.iter().all(|[r, g, b]| r == g && g == b);
    (parts, if is_grey { 1 } else { 3 })
}

/// The light of `parts` in so many pieces of equal importance for receivers whose normal is about `normal`.
fn cut(parts: &[Part], normal: DVec3, slack: f64, count: usize) -> Vec<Direction> {
    let (a, b) = normal.any_orthonormal_pair();
    let seen = |part: &Part| {
        let cosine = part.direction.dot(normal);
        let above = if slack.is_finite() { (cosine + slack).max(0.0) } else { 1.0 };
        let across = (2.0 / (1.0 + cosine).max(1e-9)).sqrt();
        let place = [part.direction.dot(a) * across, part.direction.dot(b) * across];
        Part { above, importance: above * part.light.element_sum(), place, ..*part }
    };
    let mut seen: Vec<Part> = parts.iter().map(seen).filter(|part| part.importance > 0.0).collect();
    let mut directions = Vec::with_capacity(count);
    halve(&mut seen, count, &mut directions);
    directions
}

/// Adds `count` directions of parts of a map; fewer if there are fewer parts.
fn halve(parts: &mut [Part], count: usize, directions: &mut Vec<Direction>) {
    if count <= 1 || parts.len() <= 1 {
        directions.extend(merged(parts));
        return;
    }
    let whole: f64 = parts.iter().map(|part| part.importance).sum();
    let spread = |axis: usize| {
        let mean = parts.iter().map(|part| part.importance * part.place[axis]).sum::<f64>() / whole;
        parts.iter().map(|part| part.importance * (part.place[axis] - mean).powi(2)).sum::<f64>()
    };
    let axis = if spread(0) > spread(1) { 0 } else { 1 };
    parts.sort_unstable_by(|x, y| x.place[axis].total_cmp(&y.place[axis]));
    let first = count / 2;
    let goal = whole * first as f64 / count as f64;
    let mut sum = 0.0;
    let at = parts.iter().position(|part| {
        sum += part.importance;
        sum - 0.5 * part.importance >= goal
    });
    let at = at.unwrap_or(parts.len()).clamp(1, parts.len() - 1);
    let (low, high) = parts.split_at_mut(at);
    halve(low, first, directions);
    halve(high, count - first, directions);
}

/// All parts as one direction; `None` if they have no light. The light of each counts by how much of it is above, so that
/// a part that the horizon cuts neither vanishes below it nor stands above as a whole.
fn merged(parts: &[Part]) -> Option<Direction> {
    let middle: DVec3 = parts.iter().map(|part| part.importance * part.direction).sum();
    let importance: f64 = parts.iter().map(|part| part.importance).sum();
    // That of the middle's direction: it is affine in the direction, less what is clamped.
    let above = parts.iter().map(|part| part.importance * part.above).sum::<f64>() / importance;
    Some(Direction {
        direction: middle.try_normalize()?,
        solid_angle: parts.iter().map(|part| part.solid_angle).sum(),
        weights: parts.iter().map(|part| part.above * part.light).sum::<DVec3>() / above,
    })
}

/// Directions eight by eight, in whole blocks.
fn packed(directions: &[Direction], channels: usize, edge: f32) -> DirectionSet {
    let sharpness = |d: &Direction| 1.0 / (f64::from(edge) * (d.solid_angle / PI).sqrt().max(1e-6));
    let groups = || (0..directions.len().next_multiple_of(8 * BLOCK).max(8 * BLOCK)).step_by(8);
    let lanes = |first: usize, of: &dyn Fn(&Direction) -> f64| {
        let value = |lane: usize| directions.get(first + lane).map_or(0.0, |direction| of(direction) as f32);
        f32x8::from(std::array::from_fn::<f32, 8, _>(value))
    };
    let eight = |first: usize| Directions8 {
        direction: std::array::from_fn(|axis| lanes(first, &|d| d.direction[axis])),
        sharpness: lanes(first, &sharpness),
    };
    let weights = |channel: usize| groups().map(|first| lanes(first, &|d| d.weights[channel])).collect();
    let mean = directions.iter().map(sharpness).sum::<f64>() / directions.len().max(1) as f64;
    DirectionSet {
        directions: groups().map(eight).collect(),
        weights: std::array::from_fn(|channel| if channel < channels { weights(channel) } else { Vec::new() }),
        mean_sharpness: mean as f32,
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use halfshade_scene::light::EnvironmentMap;
    use std::sync::Arc;

    fn map() -> DistantLight {
        let texels = (0..64 * 32)
            .map(|i| Vec3::new(if i % 97 == 0 { 30.0 } else { 0.1 }, 1.0 + (i / 640) as f32, (i % 64) as f32 / 64.0));
        DistantLight::Map(Arc::new(EnvironmentMap::new(64, 32, texels.collect()).unwrap()))
    }

    /// Irradiance that the directions add up to, by channel.
    fn irradiance(set: &DirectionSet, channels: usize, normal: Vec3) -> DVec3 {
        let mut sum = DVec3::ZERO;
        for (group, eight) in set.directions.iter().enumerate() {
            let [x, y, z] = eight.direction.map(f32x8::to_array);
            for (lane, direction) in x.into_iter().zip(y).zip(z).map(|((x, y), z)| Vec3::new(x, y, z)).enumerate() {
                let cosine = direction.dot(normal).max(0.0);
                for channel in 0..3 {
                    let weights = &set.weights[channel.min(channels - 1)];
                    sum[channel] += f64::from(cosine * weights[group].to_array()[lane]);
                }
            }
        }
        sum
    }

    /// However much light comes from where, directions add up to the irradiance; more of them more nearly.
    #[test]
    fn directions_carry_the_light_of_their_cells() {
        let light = map();
        let DistantLight::Map(texels) = &light else { panic!() };
        let cells = DirectionalCells::new(texels);
        let whole: DVec3 = cells.vector_irradiance.iter().map(|v| DVec3::from(v.map(|v| v.as_dvec3().length()))).sum();
        for (count, allowed) in [(64, 0.2), (256, 0.08)] {
            let sets = DirectionSets::new(&light, &Drawing { count, normals: 3, edge: 1.2 });
            for i in 0..200 {
                let normal = spiral(DVec3::Y, f64::INFINITY, 200)[i].direction.as_vec3();
                let found = irradiance(&sets.sets[sets.number(normal)], sets.channels, normal) * whole;
                let exact = cells.irradiance(normal).as_dvec3();
                let error = ((found - exact) / exact).abs().max_element();
                assert!(error < allowed, "{count} {normal}: {found} {exact}");
            }
        }
    }

    #[test]
    fn a_constant_sky_gives_pi_and_a_black_one_nothing() {
        let drawing = Drawing { count: 128, normals: 3, edge: 1.2 };
        let sets = DirectionSets::new(&DistantLight::Constant(Vec3::ONE), &drawing);
        for normal in [Vec3::Y, Vec3::new(0.6, -0.64, 0.48)] {
            let found = irradiance(&sets.sets[sets.number(normal)], 1, normal);
            assert!((found.x / PI - 1.0).abs() < 0.01, "{found}");
        }
        let black = EnvironmentMap::new(8, 4, vec![Vec3::ZERO; 32]).unwrap();
        let sets = DirectionSets::new(&DistantLight::Map(Arc::new(black)), &drawing);
        assert_eq!(irradiance(&sets.sets[0], 1, Vec3::Y), DVec3::ZERO);
    }
}
