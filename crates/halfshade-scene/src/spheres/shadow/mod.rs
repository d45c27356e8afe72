//! Spheres fitted to what their mesh hides, instead of bounding it.
//!
//! A set that bounds its mesh brings a margin along with every sphere, and hides too much. Here centres and radii are
//! chosen so that receivers around and on the object ([`receivers`]) see as much light as the mesh leaves them: by least
//! squares over the irradiance under constant light, and under lights of 30 degrees one by one ([`coverage`]). Spheres may
//! stick out, and may leave parts bare.
//!
//! Spheres are placed one after another where they help most ([`growth`]), several times over. The best of these starts is
//! refined by Levenberg and Marquardt's method \[Marquardt1963\] ([`damped_step`]).

mod coverage;
mod damped_step;
mod growth;
mod receivers;
mod rows;

use super::DSphere;
use super::normalized::NormalizedMesh;
use crate::Progress;
use damped_step::damped_step;
use glam::DVec3;
use growth::Growth;
use rand::SeedableRng;
use rand_pcg::Pcg64Mcg;
use rayon::prelude::*;
use receivers::Receiver;
use rows::Rows;

/// Steps at most.
const STEPS: usize = 24;
/// A step that lowers the sum of squares by less, as a fraction of it, is the last.
const WORTHWHILE: f64 = 5e-4;
/// Damping of the first step, and the least and the largest there is.
const DAMPING: [f64; 3] = [0.1, 1e-3, 1e3];
/// How far a sphere may move and grow in a step, in radii.
const LARGEST_MOVE: f64 = 0.3;

/// `count` spheres for `mesh`, the best of `starts`. The same seed gives the same bits on one thread or many.
pub(super) fn fit(
    mesh: &NormalizedMesh,
    count: usize,
    starts: usize,
    seed: u64,
    progress: &dyn Progress,
) -> Vec<DSphere> {
    progress.start("fitting shadows", (1 + starts + STEPS) as u64);
    let receivers = receivers::receivers(mesh, seed);
    progress.advance(1);
    let growth = Growth::new(mesh, &receivers);
    let start = |start: usize| {
        let mut rng = Pcg64Mcg::seed_from_u64(seed.wrapping_mul(0x9e37_79b9).wrapping_add(start as u64));
        let grown = growth.spheres(count, &mut rng);
        progress.advance(1);
        grown
    };
    let best = (0..starts).map(start).min_by(|a, b| a.0.total_cmp(&b.0));
    let mut spheres = best.map(|(_, spheres)| spheres).unwrap_or_default();
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
