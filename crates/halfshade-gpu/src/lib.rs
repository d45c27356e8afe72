//! Strategies on graphics hardware: runners that keep data on the device and dispatch WGSL twins of the CPU kernels.
//!
//! A GPU is a *device* of a run, not another strategy: [`strategies`] gives those that have twins, under their own names and
//! with their own parameters. `bake` and the CPU's part of `prepare` are the strategies' own; what they end in goes up, and
//! `shade` is kernels. The kernels are WGSL files in `shaders/`, with functions of the stem of the Rust file that they are
//! the twin of; [`kernels::KERNELS`] lists the pairs.
//!
//! ```no_run
//! use halfshade_gpu::{Choice, Gpu, strategies};
//! use halfshade_scene::Cache;
//!
//! // `None` only if it is switched off; where there is no device, an error says what to install.
//! let Some(gpu) = Gpu::open(&Choice::default())? else { return Ok(()) };
//! let names: Vec<&str> = strategies(&gpu, &Cache::disabled()).iter().map(|strategy| strategy.info().name).collect();
//! println!("{} shades by {}", gpu.facts().name, names.join(", "));
//! # Ok::<(), halfshade_gpu::GpuError>(())
//! ```

mod analytic;
mod choice;
mod device;
mod error;
mod hierarchy;
pub mod kernels;
mod mask;
mod pipeline;
mod placed;
pub mod probe;
mod prt;
mod ray_traced;
mod receivers;
mod reflectance;
mod rows;
mod runner;
mod sh_exp;
mod shader;
mod shadow_field;
mod unshadowed;
#[cfg(test)]
mod validation;

pub use analytic::AnalyticOnGpu;
pub use choice::Choice;
pub use device::{AdapterFacts, Gpu, devices};
pub use error::GpuError;
pub use mask::MaskOnGpu;
pub use prt::PrtOnGpu;
pub use ray_traced::RayTracedOnGpu;
pub use sh_exp::ShExpOnGpu;
pub use shadow_field::ShadowFieldOnGpu;
pub use unshadowed::UnshadowedOnGpu;

use halfshade_scene::Cache;
use halfshade_strategy::Strategy;
use std::sync::Arc;

/// The strategies that have kernels for graphics hardware, to run on `gpu`; what they bake is kept in `cache`.
pub fn strategies(gpu: &Arc<Gpu>, cache: &Cache) -> Vec<Box<dyn Strategy>> {
    let bench = runner::Bench { gpu: gpu.clone(), pipelines: Arc::default() };
    vec![
        Box::new(UnshadowedOnGpu::new(bench.clone())),
        Box::new(RayTracedOnGpu::new(bench.clone())),
        Box::new(ShExpOnGpu::new(bench.clone())),
        Box::new(MaskOnGpu::new(bench.clone())),
        Box::new(AnalyticOnGpu::new(bench.clone())),
        Box::new(ShadowFieldOnGpu::new(bench.clone(), cache.clone())),
        Box::new(PrtOnGpu::new(bench, cache.clone())),
    ]
}
