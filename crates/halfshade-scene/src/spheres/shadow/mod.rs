//! Spheres fitted to what their mesh hides, instead of bounding it.
//!
//! A set that bounds its mesh brings a margin along with every sphere, and hides too much. Here centres and radii are
//! chosen so that receivers around and on the object ([`receivers`]) see as much light as the mesh leaves them: by least
//! squares over the irradiance under constant light, and under lights of 30 degrees one by one ([`coverage`]). Spheres may
//! stick out, and may leave parts bare.
//!
//! The search is Levenberg and Marquardt's \[Marquardt1963\] ([`refit`]) from a set that bounds, its radii reduced. Out of
//! local minima it is led by spheres that are put elsewhere ([`relocation`]).

mod coverage;
mod damped_step;
mod exchange;
mod receivers;
mod refit;
mod relocation;
mod rows;

use super::DSphere;
use super::normalized::NormalizedMesh;
use crate::Progress;
use refit::refit;

/// Factor of the radii of a bounding set with which the fit begins: those of a bunny hide right on average by about as much.
const SHRINK: f64 = 0.88;
/// Steps at most.
const STEPS: usize = 24;
/// A step that lowers the sum of squares by less, as a fraction of it, is the last.
const WORTHWHILE: f64 = 5e-4;

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
