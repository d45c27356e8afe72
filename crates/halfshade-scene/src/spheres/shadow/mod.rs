//! Spheres fitted to what their mesh hides, instead of bounding it.
//!
//! A set that bounds its mesh brings a margin along with every sphere, and hides too much. Here centres and radii are
//! chosen so that receivers around and on the object ([`receivers`]) see as much light as the mesh leaves them: by least
//! squares over the irradiance under constant light, and under lights of 30 degrees one by one ([`coverage`]). Spheres may
//! stick out, and may leave parts bare.
//!
//! The search is Levenberg and Marquardt's \[Marquardt1963\] ([`damped_step`]) from a set that bounds, its radii reduced. Out of
//! local minima it is led by spheres that are put elsewhere ([`relocation`]).

mod coverage;
mod damped_step;
mod exchange;
mod receivers;
mod relocation;
mod rows;

use super::DSphere;
use super::normalized::NormalizedMesh;
use crate::Progress;
use damped_step::damped_step;
use glam::DVec3;
use rayon::prelude::*;
use receivers::Receiver;
use rows::Rows;

/// Factor of the radii of a bounding set with which the fit begins: those of a bunny hide right on average by about as much.
const SHRINK: f64 = 0.88;
/// Steps at most.
const STEPS: usize = 24;
/// A step that lowers the sum of squares by less, as a fraction of it, is the last.
const WORTHWHILE: f64 = 5e-4;
/// Damping of the first step, and the least and the largest there is.
const DAMPING: [f64; 3] = [0.1, 1e-3, 1e3];
/// How far a sphere may move and grow in a step, in radii.
const LARGEST_MOVE: f64 = 0.3;

/// The fit to `mesh` that begins at a set of spheres that bound it. The same seed gives the same bits on one thread or
/// many.
pub(super) fn fit(mesh: &NormalizedMesh, bounding: &[DSphere], seed: u64, progress: &dyn Progress) -> Vec<DSphere> {
    progress.start("fitting shadows", (1 + relocation::rounds(bounding.len()) + STEPS) as u64);
    let receivers = receivers::receivers(mesh, seed);
    progress.advance(1);
    let mut spheres: Vec<DSphere> = bounding.iter().map(|s| DSphere { radius: SHRINK * s.radius, ..*s }).collect();
    relocation::relocate(&receivers, &mut spheres, seed, &mut || progress.advance(1));
    refit(&receivers, &mut spheres, STEPS, WORTHWHILE, &mut || progress.advance(1));
    spheres
}

/// Moves spheres to a local minimum of the sum of squares, or `steps` towards it, and ends before where a step lowers it by
/// less than the `worthwhile` part. Returns the sum.
fn refit(
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
fn all_errors(receivers: &[Receiver], spheres: &[DSphere]) -> Rows {
    let parts: Vec<Rows> = receivers.par_iter().map(|receiver| coverage::errors(receiver, spheres)).collect();
    let mut rows = Rows::default();
    parts.into_iter().for_each(|part| rows.append(part));
    rows
}

fn moved(spheres: &[DSphere], step: &[rows::PerSphere]) -> Vec<DSphere> {
    let moved = |(sphere, &[x, y, z, r]): (&DSphere, &rows::PerSphere)| {
        let limit = LARGEST_MOVE * sphere.radius;
        DSphere {
            center: sphere.center + DVec3::new(x, y, z).clamp_length_max(limit),
            radius: sphere.radius + r.clamp(-limit, limit),
        }
    };
    spheres.iter().zip(step).map(moved).collect()
}
