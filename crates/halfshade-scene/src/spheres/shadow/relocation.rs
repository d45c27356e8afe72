//! Ways out of a local minimum: a sphere that is hardly needed goes where one is missing.
//!
//! Removal of a sphere raises the sum of squares; of those whose removal raises it least one is drawn. Candidates for its new
//! place touch the surface from within, at random places and of random radii; the one that lowers the sum most joins. All
//! spheres are then refitted, and stay if the sum fell. A part of the receivers suffices for all that.

use super::exchange::{changes, removals};
use super::receivers::Receiver;
use super::refit::refit;
use crate::spheres::DSphere;
use rand::{RngExt, SeedableRng};
use rand_pcg::Pcg64Mcg;

/// One of so many receivers is asked.
const STRIDE: usize = 4;
/// Attempts.
const ROUNDS: usize = 16;
/// Spheres of whose removal one is drawn.
const DRAWN: usize = 6;
/// Candidates for a new place.
const CANDIDATES: usize = 96;
/// Radii of candidates, as fractions of the mean.
const RADII: [f64; 2] = [0.35, 2.1];
/// Distance of a candidate's centre from the surface, in radii: a little less than what touches, as spheres stick out.
const DEPTH: f64 = 0.9;
/// Steps of the first refit, and of those after a relocation.
const STEPS: [usize; 2] = [12, 4];
/// A refit that lowers the sum of squares by less, as a fraction of it, ends.
const WORTHWHILE: f64 = 2e-3;

/// Moves spheres towards a minimum for a part of the receivers, and relocates some. Calls `after_round` up to
/// [`rounds`] times.
pub(super) fn relocate(receivers: &[Receiver], spheres: &mut Vec<DSphere>, seed: u64, after_round: &mut dyn FnMut()) {
    let sites: Vec<&Receiver> = receivers.iter().filter(|receiver| receiver.is_on_surface).collect();
    let some: Vec<Receiver> = receivers.iter().skip(1).step_by(STRIDE).cloned().collect();
    let mut cost = refit(&some, spheres, STEPS[0], WORTHWHILE, &mut || ());
    let mut rng = Pcg64Mcg::seed_from_u64(seed);
    for _ in 0..rounds(spheres.len()) {
        if let Some(mut next) = relocated(&some, &sites, spheres, &mut rng) {
            let after = refit(&some, &mut next, STEPS[1], WORTHWHILE, &mut || ());
            if after < cost {
                (cost, *spheres) = (after, next);
            }
        }
        after_round();
    }
}

/// Attempts with so many spheres: the work of each grows with the count, and with many one more or less matters little.
pub(super) fn rounds(spheres: usize) -> usize {
    if spheres > 64 { ROUNDS * 64 / spheres } else { ROUNDS }
}

/// The spheres with one of them elsewhere; none without a surface to place it at.
fn relocated(
    receivers: &[Receiver],
    sites: &[&Receiver],
    spheres: &[DSphere],
    rng: &mut Pcg64Mcg,
) -> Option<Vec<DSphere>> {
    if sites.is_empty() {
        return None;
    }
    let raised = removals(receivers, spheres);
    let mut order: Vec<usize> = (0..spheres.len()).collect();
    order.sort_by(|&a, &b| raised[a].total_cmp(&raised[b]));
    let rank = rng.random::<f64>().powi(2) * DRAWN.min(spheres.len()) as f64;
    let mut next = spheres.to_vec();
    next.remove(*order.get(rank as usize)?);
    let mean = spheres.iter().map(|sphere| sphere.radius).sum::<f64>() / spheres.len() as f64;
    let mut candidate = || {
        let site = sites[rng.random_range(0..sites.len())];
        let radius = mean * RADII[0] * (RADII[1] / RADII[0]).powf(rng.random());
        DSphere { center: site.position - DEPTH * radius * site.normal, radius }
    };
    let candidates: Vec<DSphere> = (0..CANDIDATES).map(|_| candidate()).collect();
    let changed = changes(receivers, &next, &candidates);
    let best = (0..CANDIDATES).min_by(|&a, &b| changed[a].total_cmp(&changed[b]))?;
    next.push(candidates[best]);
    Some(next)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::builtin::shapes::torus;
    use crate::spheres::normalized::NormalizedMesh;
    use crate::spheres::shadow::receivers::receivers;
    use glam::DVec3;

    /// Spheres along one half of a ring: no path of falling errors leads around the hole.
    #[test]
    fn a_bare_half_of_a_ring_gets_spheres() {
        let mesh = NormalizedMesh::new(&torus(1.0, 0.2, 24, 12)).unwrap();
        let receivers = receivers(&mesh, 1);
        let start: Vec<DSphere> = (0..12)
            .map(|k| {
                let (sin, cos) = (f64::from(k) * std::f64::consts::PI / 11.0).sin_cos();
                DSphere { center: DVec3::new(0.4 * cos, 0.0, 0.4 * sin), radius: 0.1 }
            })
            .collect();
        let (mut refitted, mut spheres) = (start.clone(), start);
        let without = refit(&receivers, &mut refitted, 24, 5e-4, &mut || ());
        relocate(&receivers, &mut spheres, 1, &mut || ());
        let with = refit(&receivers, &mut spheres, 24, 5e-4, &mut || ());
        let bare = |spheres: &[DSphere]| spheres.iter().filter(|sphere| sphere.center.z < -0.1).count();
        let (before, after) = (bare(&refitted), bare(&spheres));
        assert!(
            spheres.len() == 12 && with < 0.8 * without && after > before + 1,
            "{without} {with}, {before} {after}"
        );
    }
}
