//! Settings and light as plain arrays, for kernels that run elsewhere than on the processor.

pub use super::{
    prepare::{
        light_sampler::{AliasTable, LightSampler},
        light_tree::{Level, LightTree},
        neighbours::{NOBODY, Near, Neighbours},
    },
    shade::filter::{LEAST_VARIANCE, Stops, WEIGHTS},
};
pub use crate::shared::irradiance::Irradiance;

use super::{
    settings::{Estimator, Filter, Sampling, Settings},
    shade::points::Points,
};
use halfshade_scene::Scene;
use halfshade_strategy::Params;

/// How rays are drawn.
#[derive(Debug, Clone, Copy)]
pub struct SampleArrays {
    /// Rays per receiver.
    pub samples: u32,
    /// Share of directions drawn by cosine, unless light is constant: then all of them are.
    pub cosine_share: f64,
    /// Whether directions of diffuse receivers are drawn by light times cosine.
    pub is_product: bool,
    /// Whether light that is known is multiplied by the share that rays see.
    pub is_ratio: bool,
    /// Smoothing of shares, if there is any.
    pub filter: Option<FilterArrays>,
    /// Steps of the points of directions drawn by cosine alone, in fixed point: 2^64 is 1.
    pub plane_steps: [u64; 2],
    /// Steps of all other points.
    pub space_steps: [u64; 3],
}

/// How shares are smoothed.
#[derive(Debug, Clone, Copy)]
pub struct FilterArrays {
    /// Where neighbours tell each other nothing.
    pub stops: Stops,
    /// Times that it looks twice as far.
    pub levels: usize,
}

/// Cells of the table of irradiance over normals from its centre to a side.
const NORMAL_CELLS: usize = 32;

/// Why a filter is refused where light isn't known.
pub const FILTERS_SHARES: &str =
    "a filter smooths shares of the light, of which estimator=plain knows nothing: filter=none, or preset `plain`";

impl FilterArrays {
    /// `None` without a filter.
    pub(super) fn new(settings: &Settings) -> Option<Self> {
        let Settings { samples, filter_levels, filter_angle, filter_deviations, .. } = *settings;
        let stops = Stops::new(filter_angle, filter_deviations, samples);
        (settings.filter != Filter::None).then_some(Self { stops, levels: filter_levels as usize })
    }
}

impl SampleArrays {
    /// Those of a strategy with `params`.
    pub fn new(params: &Params) -> Self {
        let settings = Settings::read(params);
        let Settings { samples, sampling, estimator, .. } = settings;
        Self {
            samples,
            cosine_share: sampling.cosine_share(),
            is_product: sampling == Sampling::Product,
            is_ratio: estimator == Estimator::Ratio,
            filter: FilterArrays::new(&settings),
            plane_steps: Points::<2>::new(0).step(),
            space_steps: Points::<3>::new(0).step(),
        }
    }

    /// All of the light by normal, if rays tell only the share that is seen, or light is chosen by it.
    pub fn irradiance(&self, scene: &Scene) -> Option<Irradiance> {
        (self.is_ratio || self.is_product).then(|| Irradiance::new(&scene.environment.base, NORMAL_CELLS))
    }
}
