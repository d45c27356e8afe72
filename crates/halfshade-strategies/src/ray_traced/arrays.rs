//! Settings and light as plain arrays, for kernels that run elsewhere than on the processor.

pub use super::prepare::light_sampler::{AliasTable, LightSampler};
use super::{
    settings::{Estimator, Settings},
    shade::points::Points,
};
use halfshade_strategy::Params;

/// How rays are drawn.
#[derive(Debug, Clone, Copy)]
pub struct SampleArrays {
    /// Rays per receiver.
    pub samples: u32,
    /// Share of directions drawn by cosine, unless light is constant: then all of them are.
    pub cosine_share: f64,
    /// Whether light that is known is multiplied by the share that rays see.
    pub is_ratio: bool,
    /// Steps of the points of directions drawn by cosine alone, in fixed point: 2^64 is 1.
    pub plane_steps: [u64; 2],
    /// Steps of all other points.
    pub space_steps: [u64; 3],
}

impl SampleArrays {
    /// Those of a strategy with `params`.
    pub fn new(params: &Params) -> Self {
        let Settings { samples, sampling, estimator } = Settings::read(params);
        Self {
            samples,
            cosine_share: sampling.cosine_share(),
            is_ratio: estimator == Estimator::Ratio,
            plane_steps: Points::<2>::new(0).step(),
            space_steps: Points::<3>::new(0).step(),
        }
    }
}
