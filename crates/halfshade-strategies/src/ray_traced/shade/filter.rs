//! Shares of the light, smoothed over neighbours.

use super::outcome::Outcome;
use crate::ray_traced::prepare::neighbours::{NOBODY, Near, Neighbours};
use glam::{Vec3, Vec4, Vec4Swizzles};
use halfshade_scene::Receivers;
use rayon::prelude::*;

/// Neighbours and what stops at edges.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Filter<'a> {
    pub(crate) neighbours: &'a Neighbours,
    pub(crate) stops: Stops,
}

/// Where neighbours tell each other nothing.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Stops {
    /// 1 less the cosine of the largest angle between normals.
    pub turn: f32,
    /// Square of the most standard deviations between shares.
    pub deviations_squared: f32,
    /// Variance of a share of one half by so many rays, four times.
    pub variance: f32,
}

/// A receiver's place, and its normal.
#[derive(Debug, Clone, Copy)]
struct Place {
    position: Vec3,
    normal: Vec3,
}

/// Weights of neighbours by their places in the list, beside the receiver's own: those of a B-spline of second degree.
pub const WEIGHTS: [f32; 8] = [0.5, 0.5, 0.5, 0.5, 0.25, 0.25, 0.25, 0.25];

/// Rounding of shares, squared: below it they are the same.
pub const LEAST_VARIANCE: f32 = 1e-8;

/// Receivers that a thread takes at once.
const CHUNK: usize = 1024;

impl Stops {
    pub(crate) fn new(angle_degrees: f32, deviations: f32, samples: u32) -> Self {
        Self {
            turn: 2.0 * (0.5 * angle_degrees.to_radians()).sin().powi(2),
            deviations_squared: deviations * deviations,
            variance: 1.0 / samples as f32,
        }
    }

    /// Weight by surface, in [0, 1]: 1 where both lie on one plane, 0 from the largest turn on, or where one is as far above
    /// the other's plane as it would be on a sphere that turns by so much.
    fn along_surface(&self, a: &Place, b: &Place) -> f32 {
        let offset = b.position - a.position;
        let off = offset.dot(a.normal).abs().max(offset.dot(b.normal).abs());
        let square = offset.length_squared();
        let lifted = if off > 0.0 && square > 0.0 { 2.0 * (off * off / square) } else { 0.0 };
        let turned = 1.0 - a.normal.dot(b.normal);
        let near = (1.0 - turned.max(lifted) / self.turn).max(0.0);
        near * near
    }

    /// Weight by shares and the variances behind them, in [0, 1].
    fn along_shares(&self, a: Vec4, b: Vec4) -> f32 {
        let apart = (mean(a) - mean(b)).powi(2);
        let near = (1.0 - apart / (self.deviations_squared * (a.w + b.w) + LEAST_VARIANCE)).max(0.0);
        near * near
    }
}

fn mean(share: Vec4) -> f32 {
    (share.x + share.y + share.z) * (1.0 / 3.0)
}

impl Filter<'_> {
    /// Smooths the shares of all receivers: à trous [Dammertz2010], level by level, each over neighbours twice as far as the one
    /// before. A weight is less the more surfaces turn, and the farther shares are apart in standard deviations: those of as many
    /// rays that each see or don't with the mean of a share around, and then of weighted means of those [Schied2017].
    pub(super) fn smooth(&self, receivers: &Receivers<'_>, outcomes: &mut [Outcome]) {
        let Some(nearest) = self.neighbours.levels.first() else { return };
        let place = |i: usize| Place { position: receivers.position_at(i), normal: receivers.normal_at(i) };
        let places: Vec<Place> = (0..receivers.len()).into_par_iter().with_min_len(CHUNK).map(place).collect();
        let shares: Vec<Vec4> = outcomes.iter().map(|outcome| outcome.share.extend(0.0)).collect();
        let mut now: Vec<Vec4> = (0..places.len())
            .into_par_iter()
            .with_min_len(CHUNK)
            .map(|i| shares[i].xyz().extend(self.variance(&places, &shares, &nearest[i], i)))
            .collect();
        let mut next = shares;
        for near in &self.neighbours.levels {
            (next.par_iter_mut().enumerate())
                .with_min_len(CHUNK)
                .for_each(|(i, share)| *share = self.smoothed(&places, &now, &near[i], i));
            std::mem::swap(&mut now, &mut next);
        }
        outcomes.iter_mut().zip(now).for_each(|(outcome, share)| outcome.share = share.xyz());
    }

    /// Variance of a share by the mean around it.
    fn variance(&self, places: &[Place], shares: &[Vec4], near: &Near, i: usize) -> f32 {
        let (mut sum, mut weights) = (mean(shares[i]), 1.0);
        for (&other, own) in near.iter().zip(WEIGHTS).filter(|(other, _)| **other != NOBODY) {
            let weight = own * self.stops.along_surface(&places[i], &places[other as usize]);
            sum += weight * mean(shares[other as usize]);
            weights += weight;
        }
        let mean = sum / weights;
        (mean * (1.0 - mean)).max(0.0) * self.stops.variance
    }

    fn smoothed(&self, places: &[Place], shares: &[Vec4], near: &Near, i: usize) -> Vec4 {
        let own_share = shares[i];
        let (mut sum, mut weights) = (own_share, 1.0);
        for (&other, own) in near.iter().zip(WEIGHTS).filter(|(other, _)| **other != NOBODY) {
            let share = shares[other as usize];
            let weight = own
                * self.stops.along_surface(&places[i], &places[other as usize])
                * self.stops.along_shares(own_share, share);
            // Variances add by the squares of weights.
            sum += share * Vec4::new(weight, weight, weight, weight * weight);
            weights += weight;
        }
        let (mean, variance) = (sum.xyz() / weights, sum.w / (weights * weights));
        mean.extend(variance)
    }
}
