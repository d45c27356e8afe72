//! Spheres placed one after another, each where it helps most: the start of a fit, which no set that bounds has to precede.
//!
//! Candidates touch the surface from within, at random places and of random radii; the one that lowers the sum of squares
//! most joins. From time to time all spheres are refitted. A part of the receivers suffices for all that.

use super::coverage::State;
use super::receivers::Receiver;
use super::refit;
use crate::spheres::DSphere;
use crate::spheres::normalized::NormalizedMesh;
use glam::DVec3;
use rand::RngExt;
use rand_pcg::Pcg64Mcg;
use rayon::prelude::*;

/// One of so many receivers is asked.
const STRIDE: usize = 4;
/// Candidates for each sphere.
const CANDIDATES: usize = 128;
/// Growth of the count from one refit to the next, and steps of each.
const GROWTH: f64 = 1.25;
const STEPS: usize = 4;
/// A refit that lowers the sum of squares by less, as a fraction of it, ends.
const WORTHWHILE: f64 = 5e-3;
/// Least radius of a candidate, as a fraction of the largest.
const SMALLEST: f64 = 0.15;
/// Distance of a candidate's centre from the surface, in radii: a little less than what touches, as spheres stick out.
const DEPTH: f64 = 0.9;

/// What the choice of spheres knows.
pub(super) struct Growth {
    receivers: Vec<Receiver>,
    /// Points of the surface with the direction out of the object.
    sites: Vec<(DVec3, DVec3)>,
}

impl Growth {
    pub(super) fn new(mesh: &NormalizedMesh, receivers: &[Receiver]) -> Self {
        let on_surface = receivers.iter().filter(|receiver| receiver.is_on_surface);
        let mut sites: Vec<(DVec3, DVec3)> = on_surface.map(|it| (it.position, it.normal)).collect();
        if sites.is_empty() {
            // A mesh without area has corners alone.
            sites = mesh.vertices().into_iter().map(|vertex| (vertex, DVec3::Y)).collect();
        }
        Self { receivers: receivers.iter().skip(1).step_by(STRIDE).cloned().collect(), sites }
    }

    /// `count` spheres and the sum of squares that they leave.
    pub(super) fn spheres(&self, count: usize, rng: &mut Pcg64Mcg) -> (f64, Vec<DSphere>) {
        let mut spheres = Vec::with_capacity(count);
        let mut next_refit = 1.0f64;
        let mut states = self.states(&spheres);
        while spheres.len() < count {
            let candidates = self.candidates(spheres.len(), rng);
            let best = best(&states, &candidates);
            spheres.push(best);
            if spheres.len() as f64 >= next_refit {
                refit(&self.receivers, &mut spheres, STEPS, WORTHWHILE, &mut || ());
                states = self.states(&spheres);
                next_refit = (next_refit * GROWTH).max(next_refit + 1.0);
            } else {
                states.par_iter_mut().for_each(|state| state.join(&best));
            }
        }
        (refit(&self.receivers, &mut spheres, STEPS, WORTHWHILE, &mut || ()), spheres)
    }

    fn states(&self, spheres: &[DSphere]) -> Vec<State<'_>> {
        self.receivers.par_iter().map(|receiver| State::new(receiver, spheres)).collect()
    }

    /// Spheres that may join so many others; their radii fall as the parts do that are left.
    fn candidates(&self, spheres: usize, rng: &mut Pcg64Mcg) -> Vec<DSphere> {
        let largest = 0.8 / (spheres as f64 + 4.0).cbrt();
        let mut candidate = || {
            let (position, normal) = self.sites[rng.random_range(0..self.sites.len())];
            let radius = largest * SMALLEST.powf(rng.random());
            DSphere { center: position - DEPTH * radius * normal, radius }
        };
        (0..CANDIDATES).map(|_| candidate()).collect()
    }
}

/// The candidate by which the sum of squares falls most.
fn best(states: &[State<'_>], candidates: &[DSphere]) -> DSphere {
    let parts: Vec<Vec<f64>> = states.par_iter().map(|state| state.changes(candidates)).collect();
    let mut changes = vec![0.0; candidates.len()];
    for part in parts {
        changes.iter_mut().zip(part).for_each(|(sum, change)| *sum += change);
    }
    let least = (1..candidates.len()).fold(0, |least, k| if changes[k] < changes[least] { k } else { least });
    candidates[least]
}
