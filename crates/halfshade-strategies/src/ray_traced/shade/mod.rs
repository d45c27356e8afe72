//! Rays of each receiver.

pub(super) mod filter;
mod mixture;
pub(super) mod points;
mod product;
mod reflector;
pub(super) mod sequence;

use super::prepare::{light_sampler::LightSampler, occlusion::Occlusion};
use crate::shared::irradiance::FrameIrradiance;
use filter::Filter;
use glam::{DVec3, Vec3};
use halfshade_scene::{EyeLobes, Lobes, RadianceMut, Receivers};
use halfshade_strategy::{Batching, Prepared};
use rayon::prelude::*;

/// A frame ready to be shaded.
pub(super) struct FrameRays<'a> {
    pub(super) samples: u32,
    /// Share of directions drawn by cosine, or by the lobes of a glossy receiver.
    pub(super) cosine_share: f64,
    /// Whether directions of diffuse receivers are drawn by light times cosine.
    pub(super) is_product: bool,
    /// Whether rays tell only the share of the light that is seen.
    pub(super) is_ratio: bool,
    pub(super) occlusion: Occlusion<'a>,
    pub(super) light: &'a LightSampler,
    /// All of the light, if that is to be known.
    pub(super) irradiance: Option<FrameIrradiance<'a>>,
    /// Lobes by which receivers reflect towards the eye, if anything is glossy.
    pub(super) eye_lobes: Option<EyeLobes>,
    pub(super) filter: Option<Filter<'a>>,
}

/// Light that a receiver sends out: `apart + known · share`.
#[derive(Debug, Clone, Copy)]
struct Outcome {
    /// All that isn't told by a share.
    apart: Vec3,
    /// Light that would be sent out if nothing were hidden.
    known: Vec3,
    /// The part of it that is seen.
    share: Vec3,
}

impl Outcome {
    const BLACK: Self = Self { apart: Vec3::ZERO, known: Vec3::ZERO, share: Vec3::ONE };

    fn radiance(&self) -> Vec3 {
        self.apart + self.known * self.share
    }
}

impl FrameRays<'_> {
    fn outcome(&self, receivers: &Receivers<'_>, i: usize) -> Outcome {
        let lobes = self.eye_lobes.as_ref().map_or(Lobes::NONE, |lobes| lobes.at(receivers, i));
        match &self.irradiance {
            _ if !lobes.is_empty() => self.glossy(receivers, i, lobes),
            Some(irradiance) if self.is_product => self.by_product(irradiance, receivers, i),
            _ => self.by_mixture(receivers, i),
        }
    }
}

/// Light of the samples of a receiver.
#[derive(Debug, Clone, Copy, Default)]
struct Sums {
    /// Blocked where it is, and as if nothing were.
    seen: DVec3,
    open: DVec3,
}

impl Sums {
    fn add(&mut self, seen: DVec3, open: DVec3) {
        self.seen += seen;
        self.open += open;
    }

    /// The share that is seen, by channel; all of it where no sample carries light.
    fn share(&self) -> DVec3 {
        let share =
            |channel: usize| if self.open[channel] > 0.0 { self.seen[channel] / self.open[channel] } else { 1.0 };
        DVec3::new(share(0), share(1), share(2)).min(DVec3::ONE)
    }
}

impl Prepared for FrameRays<'_> {
    fn batching(&self) -> Batching {
        if self.filter.is_some() { Batching::WholeFrame } else { Batching::AnySplit }
    }

    fn shade(&self, receivers: Receivers<'_>, mut out: RadianceMut<'_>) {
        let Some(filter) = &self.filter else {
            (0..receivers.len()).for_each(|i| out.set(i, self.outcome(&receivers, i).radiance()));
            return;
        };
        let all = (0..receivers.len()).into_par_iter().with_min_len(RECEIVERS_AT_ONCE);
        let mut outcomes: Vec<Outcome> = all.map(|i| self.outcome(&receivers, i)).collect();
        // Who wasn't told its receivers knows no neighbours.
        if filter.neighbours.len() == receivers.len() {
            filter.smooth(&receivers, &mut outcomes);
        }
        outcomes.iter().enumerate().for_each(|(i, outcome)| out.set(i, outcome.radiance()));
    }
}

/// Receivers that a thread takes at once, where the whole frame is shaded in one call.
const RECEIVERS_AT_ONCE: usize = 64;
