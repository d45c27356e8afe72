//! Levenberg and Marquardt's way to a local minimum, of a set of spheres.

use super::coverage;
use super::damped_step::damped_step;
use super::receivers::Receiver;
use super::rows::{PerSphere, Rows};
use crate::spheres::DSphere;
use glam::DVec3;
use rayon::prelude::*;

/// Damping of the first step, and the least and the largest there is.
const DAMPING: [f64; 3] = [0.1, 1e-3, 1e3];
/// How far a sphere may move and grow in a step, in radii.
const LARGEST_MOVE: f64 = 0.3;

/// Moves spheres to a local minimum of the sum of squares, or `steps` towards it, and ends before where a step lowers it by
/// less than the `worthwhile` part. Returns the sum.
pub(super) fn refit(
    receivers: &[Receiver],
    spheres: &mut Vec<DSphere>,
    steps: usize,
    worthwhile: f64,
    after_step: &mut dyn FnMut(),
) -> f64 {
    let mut rows = all_errors(receivers, spheres);
    let [mut damping, least, largest] = DAMPING;
    for _ in 0..steps {
        let moved = moved(spheres, &damped_step(&rows, spheres.len(), damping));
        let next = all_errors(receivers, &moved);
        let (before, after) = (rows.cost(), next.cost());
        after_step();
        if after < before {
            (rows, *spheres) = (next, moved);
            damping = (0.4 * damping).max(least);
        } else {
            damping *= 4.0;
        }
        if damping > largest || (after < before && after > before * (1.0 - worthwhile)) {
            break;
        }
    }
    rows.cost()
}

/// The errors of all receivers, in their order.
pub(super) fn all_errors(receivers: &[Receiver], spheres: &[DSphere]) -> Rows {
    let parts: Vec<Rows> = receivers.par_iter().map(|receiver| coverage::errors(receiver, spheres)).collect();
    let mut rows = Rows::default();
    parts.into_iter().for_each(|part| rows.append(part));
    rows
}

fn moved(spheres: &[DSphere], step: &[PerSphere]) -> Vec<DSphere> {
    let moved = |(sphere, &[x, y, z, r]): (&DSphere, &PerSphere)| {
        let limit = LARGEST_MOVE * sphere.radius;
        DSphere {
            center: sphere.center + DVec3::new(x, y, z).clamp_length_max(limit),
            radius: sphere.radius + r.clamp(-limit, limit),
        }
    };
    spheres.iter().zip(step).map(moved).collect()
}
