//! Shares smoothed over neighbours, in one pass per stage behind the rays.

use crate::{
    Gpu, GpuError,
    device::DeviceBuffer,
    kernels::RAY_TRACED_FILTER,
    pipeline::Pipeline,
    runner::{Bench, Follower},
};
use bytemuck::{Pod, Zeroable};
use halfshade_scene::{Frame, Receivers};
use halfshade_strategies::ray_traced::arrays::{FilterArrays, NOBODY, Near, Neighbours};
use std::{ops::Range, sync::Arc};

/// Settings of a stage, as `ray_traced/stops.wgsl` reads them.
#[repr(C)]
#[derive(Debug, Clone, Copy, Pod, Zeroable)]
pub(crate) struct DeviceStops {
    pub(crate) turn: f32,
    pub(crate) deviations_squared: f32,
    pub(crate) variance: f32,
    pub(crate) stage: u32,
    pub(crate) is_last: u32,
    pub(crate) padding: [u32; 3],
}

/// The filter's kernel, and neighbours on the device.
pub(super) struct FilterOnGpu {
    pipeline: Arc<Pipeline>,
    filter: FilterArrays,
    buffers: Vec<DeviceBuffer>,
}

impl FilterOnGpu {
    pub(super) fn new(Bench { gpu, pipelines }: &Bench, filter: FilterArrays) -> Result<Self, GpuError> {
        let pipeline = pipelines.get(gpu, &RAY_TRACED_FILTER, None, &[])?;
        Ok(Self { pipeline, filter, buffers: Vec::new() })
    }

    /// Puts neighbours of receivers on the device: passes behind those of each range of receivers. Neighbours beyond a range
    /// aren't known.
    pub(super) fn followers(
        &mut self,
        gpu: &Gpu,
        frame: &Frame<'_>,
        receivers: Receivers<'_>,
        ranges: &[Range<usize>],
    ) -> Result<Vec<Follower>, GpuError> {
        self.buffers.clear();
        let neighbours = Neighbours::new(frame, receivers, self.filter.levels);
        let mut tables = Vec::new();
        for range in ranges {
            let levels = neighbours.levels.iter().map(|level| gpu.filled("neighbours", &within(level, range)));
            tables.push(levels.collect::<Result<Vec<_>, _>>()?);
        }
        let mut followers = Vec::new();
        for stage in 0..=neighbours.levels.len() {
            let stops = gpu.filled("settings of a stage", &[self.stops(stage)])?;
            let bindings =
                tables.iter().map(|levels| self.pipeline.bind(gpu, 1, &[&stops, &levels[stage.saturating_sub(1)]]));
            followers.push(Follower { pipeline: self.pipeline.clone(), bindings: bindings.collect() });
            self.buffers.push(stops);
        }
        self.buffers.extend(tables.into_iter().flatten());
        gpu.check()?;
        Ok(followers)
    }

    fn stops(&self, stage: usize) -> DeviceStops {
        let FilterArrays { stops, levels } = self.filter;
        DeviceStops {
            turn: stops.turn,
            deviations_squared: stops.deviations_squared,
            variance: stops.variance,
            stage: stage as u32,
            is_last: u32::from(stage == levels),
            padding: [0; 3],
        }
    }

    pub(super) fn bytes(&self) -> usize {
        self.buffers.iter().map(DeviceBuffer::bytes).sum()
    }
}

/// Neighbours of a range of receivers, counted from its first.
fn within(level: &[Near], range: &Range<usize>) -> Vec<Near> {
    let counted = |other: u32| {
        let is_known = other != NOBODY && range.contains(&(other as usize));
        if is_known { other - range.start as u32 } else { NOBODY }
    };
    level[range.clone()].iter().map(|near| near.map(counted)).collect()
}
