//! Light that spheres hide from a receiver, and how it changes as they move and grow.
//!
//! Each sphere is first adjusted to the receiver by the continuous rule, as strategies and the sphere reference do (see
//! `adjust.rs`): a receiver on the object's own surface, inside some of its spheres, sees the rest of them. Along a ray d the
//! depth in the cap of an adjusted sphere of radius ρ at offset o is
//!
//! ```text
//! q = (ρ − |o × d|) / |o|  =  sin θ − sin angle(o, d)      for o·d > 0
//! ```
//!
//! and the ray counts as hidden by clamp(1/2 + max q / (2 τ), 0, 1), the maximum over spheres. The ramp makes of many rays
//! what an integral over the silhouette would be, so that it has slopes; on average it hides as much as the step does.

use super::receivers::Receiver;
use super::rows::Rows;
use crate::spheres::DSphere;
use crate::spheres::adjust::{AdjustRule, AdjustedSphere, adjust};
use glam::DVec3;

/// Half the width τ of the ramp at a silhouette.
const RAMP: f64 = 0.04;
/// Step of differences of the adjustment, in radii: the cube root of rounding.
const STEP: f64 = 1e-5;

/// A sphere as a receiver sees it.
struct Cap {
    sphere: usize,
    offset: DVec3,
    /// Slopes of the errors by cell with offset and radius; none until a ray at the silhouette needs them.
    slopes: Vec<[f64; 4]>,
}

/// Spheres as a receiver sees them along each of its rays.
struct Seen {
    caps: Vec<Cap>,
    /// Largest depth in a cap.
    depth: Vec<f32>,
    /// Which cap.
    deepest: Vec<u32>,
}

/// The part of a ray that is hidden at a depth.
pub(super) fn hidden(depth: f64) -> f64 {
    (0.5 + 0.5 * depth / RAMP).clamp(0.0, 1.0)
}

/// Depth of each ray in the cap of a sphere; whether the receiver sees that.
pub(super) fn depths(sphere: &DSphere, receiver: &Receiver, depths: &mut [f32]) -> bool {
    let cap = adjusted(sphere, receiver);
    cap.iter().for_each(|cap| depths_in(cap, receiver, depths));
    cap.is_some()
}

/// Depth of each ray in a cap; -1 behind the receiver. Without branches, so that the loop runs in whole vector registers.
fn depths_in(cap: &AdjustedSphere, receiver: &Receiver, depths: &mut [f32]) {
    let count = depths.len();
    let [x, y, z] = receiver.direction.each_ref().map(|list| &list[..count]);
    let ([ax, ay, az], sine) = (cap.direction().as_vec3().to_array(), cap.sin_angular_radius() as f32);
    for (k, depth) in depths.iter_mut().enumerate() {
        let (cx, cy, cz) = (ay * z[k] - az * y[k], az * x[k] - ax * z[k], ax * y[k] - ay * x[k]);
        let q = sine - (cx * cx + cy * cy + cz * cz).sqrt();
        *depth = if ax * x[k] + ay * y[k] + az * z[k] > 0.0 { q } else { -1.0 };
    }
}

/// The weighted errors of what is hidden from a receiver: of all light, and, around the object, of each cell in terms of a
/// light there, as if one of the cells, drawn by its share in the irradiance, were the only light.
pub(super) fn errors(receiver: &Receiver, spheres: &[DSphere]) -> Rows {
    let mut seen = Seen::new(receiver, spheres);
    let by_cell = seen.errors_by_cell(receiver);
    let slopes: Vec<(usize, Vec<[f64; 4]>)> = seen
        .caps
        .iter()
        .filter(|cap| !cap.slopes.is_empty())
        .map(|cap| {
            let jacobian = jacobian(&spheres[cap.sphere], receiver);
            (cap.sphere, cap.slopes.iter().map(|slope| times(slope, &jacobian)).collect())
        })
        .collect();
    let mut rows = Rows::default();
    let root = receiver.weight.sqrt();
    let sums = slopes.iter().map(|(sphere, cells)| (*sphere, cells.iter().fold([0.0; 4], add)));
    rows.push(root, by_cell.iter().sum(), sums);
    if receiver.is_on_surface {
        return rows;
    }
    for (cell, (error, share)) in by_cell.iter().zip(&receiver.cell_share).enumerate() {
        rows.push(root / share.sqrt(), *error, slopes.iter().map(|(sphere, cells)| (*sphere, cells[cell])));
    }
    rows
}

fn add(mut sum: [f64; 4], slope: &[f64; 4]) -> [f64; 4] {
    sum.iter_mut().zip(slope).for_each(|(sum, slope)| *sum += slope);
    sum
}

fn adjusted(sphere: &DSphere, receiver: &Receiver) -> Option<AdjustedSphere> {
    adjust(AdjustRule::Continuous, sphere.center - receiver.position, sphere.radius, receiver.normal)
}

impl Seen {
    fn new(receiver: &Receiver, spheres: &[DSphere]) -> Self {
        let count = receiver.share.len();
        let (mut depth, mut deepest, mut of_cap) = (vec![-1.0f32; count], vec![u32::MAX; count], vec![0.0f32; count]);
        let mut caps = Vec::new();
        for (number, sphere) in spheres.iter().enumerate() {
            let Some(seen) = adjusted(sphere, receiver) else { continue };
            depths_in(&seen, receiver, &mut of_cap);
            for ((depth, deepest), q) in depth.iter_mut().zip(&mut deepest).zip(&of_cap) {
                let is_deeper = q > depth;
                *depth = if is_deeper { *q } else { *depth };
                *deepest = if is_deeper { caps.len() as u32 } else { *deepest };
            }
            caps.push(Cap { sphere: number, offset: seen.offset, slopes: Vec::new() });
        }
        Self { caps, depth, deepest }
    }

    /// Light that caps hide less that which the mesh hides, by cell. Adds up the slopes of each cap.
    fn errors_by_cell(&mut self, receiver: &Receiver) -> Vec<f64> {
        let mut errors = vec![0.0; receiver.cell_share.len()];
        let [x, y, z] = &receiver.direction;
        for k in 0..receiver.share.len() {
            let (q, share, cell) =
                (f64::from(self.depth[k]), f64::from(receiver.share[k]), usize::from(receiver.cell[k]));
            errors[cell] += share * (hidden(q) - f64::from(receiver.hidden[k]));
            if q.abs() < RAMP {
                let cap = &mut self.caps[self.deepest[k] as usize];
                let direction = DVec3::new(x[k].into(), y[k].into(), z[k].into());
                let distance = cap.offset.length();
                let beside = (cap.offset - cap.offset.dot(direction) * direction).normalize_or_zero();
                let by_offset = -(beside + q / distance * cap.offset) / distance;
                let factor = share * 0.5 / RAMP;
                cap.slopes.resize(errors.len(), [0.0; 4]);
                let slope = [by_offset.x, by_offset.y, by_offset.z, 1.0 / distance].map(|slope| factor * slope);
                cap.slopes[cell] = add(cap.slopes[cell], &slope);
            }
        }
        errors
    }
}

fn times(slope: &[f64; 4], jacobian: &[[f64; 4]; 4]) -> [f64; 4] {
    jacobian.map(|change| change.iter().zip(slope).map(|(a, b)| a * b).sum())
}

/// Changes of the adjusted offset and radius with each of the sphere's centre and radius.
fn jacobian(sphere: &DSphere, receiver: &Receiver) -> [[f64; 4]; 4] {
    let unit = |n: usize| std::array::from_fn(|k| f64::from(u8::from(n == k)));
    if (sphere.center - receiver.position).dot(receiver.normal) >= sphere.radius {
        // Wholly in front, where it isn't adjusted.
        return std::array::from_fn(unit);
    }
    let step = STEP * sphere.radius;
    let moved = |n: usize, step: f64| {
        let [x, y, z, r] = unit(n).map(|along: f64| step * along);
        let moved = DSphere { center: sphere.center + DVec3::new(x, y, z), radius: sphere.radius + r };
        adjusted(&moved, receiver).map_or([0.0; 4], |seen| [seen.offset.x, seen.offset.y, seen.offset.z, seen.radius])
    };
    std::array::from_fn(|n| {
        let (low, high) = (moved(n, -step), moved(n, step));
        std::array::from_fn(|k| (high[k] - low[k]) / (2.0 * step))
    })
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::spheres::normalized::NormalizedMesh;
    use crate::spheres::shadow::receivers::receivers;

    /// The slopes of all receivers together, against differences of the sum of squares.
    #[test]
    fn slopes_agree_with_differences() {
        let mesh = NormalizedMesh::new(&crate::builtin::shapes::torus(1.0, 0.4, 24, 12)).unwrap();
        let receivers = receivers(&mesh, 1);
        let spheres: Vec<DSphere> = (0..6)
            .map(|k| {
                let (sin, cos) = (f64::from(k) * std::f64::consts::TAU / 6.0).sin_cos();
                DSphere { center: DVec3::new(0.35 * cos, 0.01 * f64::from(k), 0.35 * sin), radius: 0.15 }
            })
            .collect();
        let cost = |spheres: &[DSphere]| receivers.iter().map(|it| errors(it, spheres).cost()).sum::<f64>();
        let mut rows = Rows::default();
        receivers.iter().for_each(|it| rows.append(errors(it, &spheres)));
        for n in 0..4 {
            let step = 2e-4;
            let moved = |sign: f64| {
                let mut spheres = spheres.clone();
                match n {
                    3 => spheres[2].radius += sign * step,
                    axis => spheres[2].center[axis] += sign * step,
                }
                cost(&spheres)
            };
            let expected = (moved(1.0) - moved(-1.0)) / (2.0 * step);
            let found = -2.0 * rows.descent(spheres.len())[2][n];
            assert!((found - expected).abs() < 0.03 * expected.abs() + 2e-3, "{n}: {found} not {expected}");
        }
    }
}
