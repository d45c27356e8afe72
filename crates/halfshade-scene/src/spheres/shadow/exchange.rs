//! Sums of squares after a sphere joined or left, without a fit.

use super::coverage::{depths, hidden};
use super::receivers::Receiver;
use crate::spheres::DSphere;
use rayon::prelude::*;

/// Changes of the sum of squares by each of some candidates, if it alone joined the spheres.
pub(super) fn changes(receivers: &[Receiver], spheres: &[DSphere], candidates: &[DSphere]) -> Vec<f64> {
    summed(receivers, candidates.len(), |receiver| View::new(receiver, spheres).changes(candidates))
}

/// Changes of the sum of squares by each of the spheres, if it alone left.
pub(super) fn removals(receivers: &[Receiver], spheres: &[DSphere]) -> Vec<f64> {
    summed(receivers, spheres.len(), |receiver| View::new(receiver, spheres).removals(spheres.len()))
}

/// Sums over receivers, in their order.
fn summed(receivers: &[Receiver], count: usize, of_receiver: impl Fn(&Receiver) -> Vec<f64> + Sync + Send) -> Vec<f64> {
    let parts: Vec<Vec<f64>> = receivers.par_iter().map(of_receiver).collect();
    let mut sums = vec![0.0; count];
    for part in parts {
        sums.iter_mut().zip(part).for_each(|(sum, x)| *sum += x);
    }
    sums
}

/// Spheres along the rays of a receiver.
struct View<'a> {
    receiver: &'a Receiver,
    /// Largest depth in a sphere, which that is, and the largest in any other.
    deepest: Vec<(f32, usize, f32)>,
    /// Errors by cell.
    errors: Vec<f64>,
}

impl<'a> View<'a> {
    fn new(receiver: &'a Receiver, spheres: &[DSphere]) -> Self {
        let rays = receiver.share.len();
        let (mut deepest, mut depth) = (vec![(-1.0f32, usize::MAX, -1.0f32); rays], vec![0.0; rays]);
        for (number, sphere) in spheres.iter().enumerate() {
            if !depths(sphere, receiver, &mut depth) {
                continue;
            }
            for ((first, which, second), &q) in deepest.iter_mut().zip(&depth) {
                if q > *first {
                    (*first, *which, *second) = (q, number, *first);
                } else if q > *second {
                    *second = q;
                }
            }
        }
        let mut errors = vec![0.0; receiver.cell_share.len()];
        for (k, (first, ..)) in deepest.iter().enumerate() {
            let error = hidden((*first).into()) - f64::from(receiver.hidden[k]);
            errors[usize::from(receiver.cell[k])] += f64::from(receiver.share[k]) * error;
        }
        Self { receiver, deepest, errors }
    }

    fn changes(&self, candidates: &[DSphere]) -> Vec<f64> {
        let (mut depth, mut more) = (vec![0.0; self.deepest.len()], vec![0.0; self.errors.len()]);
        let mut change = |candidate: &DSphere| {
            if !depths(candidate, self.receiver, &mut depth) {
                return 0.0;
            }
            more.fill(0.0);
            for (k, (&q, &(first, ..))) in depth.iter().zip(&self.deepest).enumerate() {
                if q > first {
                    more[usize::from(self.receiver.cell[k])] += self.gain(k, first, q);
                }
            }
            self.change(&more)
        };
        candidates.iter().map(&mut change).collect()
    }

    fn removals(&self, spheres: usize) -> Vec<f64> {
        let cells = self.errors.len();
        let mut more = vec![0.0; spheres * cells];
        for (k, &(first, which, second)) in self.deepest.iter().enumerate() {
            if which < spheres {
                more[which * cells + usize::from(self.receiver.cell[k])] += self.gain(k, first, second);
            }
        }
        (0..spheres).map(|sphere| self.change(&more[sphere * cells..][..cells])).collect()
    }

    /// Light that ray `k` brings less once its depth is another.
    fn gain(&self, k: usize, before: f32, after: f32) -> f64 {
        f64::from(self.receiver.share[k]) * (hidden(after.into()) - hidden(before.into()))
    }

    /// Change of the sum of squares where `more` is hidden of each cell.
    fn change(&self, more: &[f64]) -> f64 {
        let Receiver { weight, is_on_surface, cell_share, .. } = self.receiver;
        let (mut error, mut sum, mut squares) = (0.0, 0.0, 0.0);
        for ((before, more), share) in self.errors.iter().zip(more).zip(cell_share) {
            error += before;
            sum += more;
            squares += more * (2.0 * before + more) / share;
        }
        weight * (sum * (2.0 * error + sum) + if *is_on_surface { 0.0 } else { squares })
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::builtin::shapes::torus;
    use crate::spheres::normalized::NormalizedMesh;
    use crate::spheres::shadow::{receivers::receivers, refit::all_errors};
    use glam::DVec3;

    /// Against the residuals of the fit, with the sphere and without.
    #[test]
    fn changes_are_differences_of_sums() {
        let mesh = NormalizedMesh::new(&torus(1.0, 0.4, 24, 12)).unwrap();
        let receivers = receivers(&mesh, 1);
        let spheres: Vec<DSphere> = (0..6)
            .map(|k| {
                let (sin, cos) = (f64::from(k) * 0.9).sin_cos();
                DSphere { center: DVec3::new(0.35 * cos, 0.01 * f64::from(k), 0.35 * sin), radius: 0.15 }
            })
            .collect();
        let cost = |spheres: &[DSphere]| all_errors(&receivers, spheres).cost();
        for (k, left) in removals(&receivers, &spheres).into_iter().enumerate() {
            let mut others = spheres.clone();
            let one = others.remove(k);
            let expected = cost(&others) - cost(&spheres);
            let joined = -changes(&receivers, &others, &[one])[0];
            for found in [left, joined] {
                assert!(
                    expected.abs() > 1e-5 && (found - expected).abs() < 1e-6 * expected.abs() + 1e-9,
                    "{found} {expected}"
                );
            }
        }
    }
}
