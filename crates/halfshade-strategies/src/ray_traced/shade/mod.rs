//! Rays of each receiver.

pub(super) mod filter;
mod mixture;
mod outcome;
pub(super) mod points;
mod product;
mod reflector;
pub(super) mod sequence;

use super::prepare::light_sampler::LightSampler;
use crate::shared::{irradiance::FrameIrradiance, scene_occlusion::Occlusion};
use filter::Filter;
use halfshade_scene::{EyeLobes, Lobes, RadianceMut, Receivers};
use halfshade_strategy::{Batching, Prepared};
use outcome::Outcome;
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
