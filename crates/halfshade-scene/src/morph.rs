//! Morph targets: shifts of vertices, times weights that change over time.
//!
//! ```text
//! p(t) = p + Σ_k (w_k(t) - w_k(at rest)) Δp_k        n(t) = (n + Σ_k (w_k(t) - w_k(at rest)) Δn_k) / |..|
//! ```

use crate::{Deformed, Mesh};
use glam::Vec3;

/// A morph target of a mesh.
#[derive(Debug, Clone, PartialEq)]
pub struct MorphTarget {
    /// Weight beyond that at rest: keys `(time_secs, weight)` in rising order of time, at least one, linear in between.
    /// Outside the nearest one holds.
    pub weight: Vec<(f64, f32)>,
    /// Shifts of the vertices that move; each vertex at most once.
    pub shifts: Vec<MorphShift>,
}

/// Shift of a vertex with a weight of 1.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct MorphShift {
    /// The vertex.
    pub vertex: u32,
    /// Shift of its position.
    pub position: Vec3,
    /// Shift of its normal.
    pub normal: Vec3,
}

impl MorphTarget {
    /// The weight beyond that at rest.
    pub fn weight_at(&self, time_secs: f64) -> f32 {
        let after = self.weight.partition_point(|(time, _)| *time <= time_secs);
        let before = after.checked_sub(1).and_then(|place| self.weight.get(place));
        match (before, self.weight.get(after)) {
            (Some((t0, a)), Some((t1, b))) => a + ((time_secs - t0) / (t1 - t0)) as f32 * (b - a),
            (Some((_, weight)), None) | (None, Some((_, weight))) => *weight,
            (None, None) => 0.0,
        }
    }

    /// Whether the weight ever differs from that at rest, or moves anything.
    pub fn moves(&self) -> bool {
        !self.shifts.is_empty() && self.weight.windows(2).any(|pair| pair[0].1 != pair[1].1)
    }

    /// The time of the last key.
    pub fn last_key_secs(&self) -> Option<f64> {
        self.weight.last().map(|(time, _)| *time)
    }

    /// The farthest that it ever shifts a vertex.
    pub(crate) fn reach(&self) -> f64 {
        let most = self.weight.iter().map(|(_, weight)| f64::from(weight.abs())).fold(0.0, f64::max);
        let farthest = self.shifts.iter().map(|shift| shift.position.as_dvec3().length()).fold(0.0, f64::max);
        if most == 0.0 { 0.0 } else { most * farthest }
    }
}

/// The vertices of `mesh` as the targets move them.
pub(crate) fn morphed(targets: &[MorphTarget], mesh: &Mesh, time_secs: f64) -> Deformed {
    let mut result = Deformed { positions: mesh.positions.clone(), normals: mesh.normals.clone() };
    for target in targets {
        let weight = target.weight_at(time_secs);
        for shift in target.shifts.iter().filter(|_| weight != 0.0) {
            result.positions[shift.vertex as usize] += weight * shift.position;
            result.normals[shift.vertex as usize] += weight * shift.normal;
        }
    }
    for (normal, at_rest) in result.normals.iter_mut().zip(&mesh.normals) {
        if normal != at_rest {
            *normal = normal.normalize_or(*at_rest);
        }
    }
    result
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn weights_are_linear_between_keys_and_shifts_add_up() {
        let shift = |position, normal| MorphShift { vertex: 1, position, normal };
        let up = MorphTarget { weight: vec![(1.0, 0.0), (3.0, 2.0)], shifts: vec![shift(Vec3::Y, Vec3::X)] };
        let aside = MorphTarget { weight: vec![(2.0, 0.5)], shifts: vec![shift(2.0 * Vec3::X, Vec3::ZERO)] };
        assert_eq!([0.0, 1.0, 1.5, 3.0, 9.0].map(|time| up.weight_at(time)), [0.0, 0.0, 0.5, 2.0, 2.0]);
        assert!(up.moves() && !aside.moves() && up.reach() == 2.0);
        let mesh = Mesh { positions: vec![Vec3::Z; 2], normals: vec![Vec3::Z; 2], ..Mesh::default() };
        let moved = morphed(&[up, aside], &mesh, 2.0);
        assert_eq!(moved.positions, [Vec3::Z, Vec3::new(1.0, 1.0, 1.0)]);
        assert_eq!(moved.normals[0], Vec3::Z);
        assert!(moved.normals[1].distance(Vec3::new(0.5_f32.sqrt(), 0.0, 0.5_f32.sqrt())) < 1e-6);
    }
}
