//! Kernels as pipelines, and their dispatches, with the device's clock at the boundaries of each pass.

use crate::{Gpu, GpuError, device::DeviceBuffer, kernels::Kernel, shader};
use std::{
    collections::BTreeMap,
    sync::{Arc, Mutex, PoisonError},
};

/// Invocations per workgroup, as the shaders say.
pub(crate) const WORKGROUP: u32 = 64;

/// Most receivers of one dispatch: as many as fit the workgroups of one dimension.
pub(crate) const MOST_RECEIVERS: usize = 65_535 * WORKGROUP as usize;

/// Most passes of a submission whose time is taken.
const MOST_PASSES: u32 = 64;

/// Yes or no as the value of an `override`.
pub(crate) fn flag(is_set: bool) -> f64 {
    f64::from(u8::from(is_set))
}

/// A kernel that is ready to run.
#[derive(Debug)]
pub(crate) struct Pipeline {
    pipeline: wgpu::ComputePipeline,
    name: &'static str,
}

/// All kernels that were made ready, so that none is compiled twice: in software that takes seconds.
#[derive(Debug, Default)]
pub(crate) struct Pipelines(Mutex<BTreeMap<String, Arc<Pipeline>>>);

impl Pipelines {
    /// The kernel with these values of its `override`s; `bands` for kernels of SH vectors.
    pub(crate) fn get(
        &self,
        gpu: &Gpu,
        kernel: &Kernel,
        bands: Option<usize>,
        constants: &[(&str, f64)],
    ) -> Result<Arc<Pipeline>, GpuError> {
        let key = format!("{} {bands:?} {constants:?}", kernel.name);
        let mut known = self.0.lock().unwrap_or_else(PoisonError::into_inner);
        if let Some(pipeline) = known.get(&key) {
            return Ok(pipeline.clone());
        }
        let pipeline = Arc::new(Pipeline::new(gpu, kernel.name, shader::module(kernel.shader, bands), constants)?);
        known.insert(key, pipeline.clone());
        Ok(pipeline)
    }
}

/// A shader without counters in its loops, which the device's compiler can't look through. Debug builds keep every check.
fn trusted_module(gpu: &Gpu, descriptor: wgpu::ShaderModuleDescriptor<'_>) -> wgpu::ShaderModule {
    if cfg!(debug_assertions) {
        return gpu.device.create_shader_module(descriptor);
    }
    let checks = wgpu::ShaderRuntimeChecks { force_loop_bounding: false, ..wgpu::ShaderRuntimeChecks::checked() };
    #[expect(
        unsafe_code,
        reason = "every loop of `shaders/` counts up to a bound or goes down a tree; access stays checked"
    )]
    // SAFETY: the one promise is that no loop is endless; all that naga validates it still validates.
    unsafe {
        gpu.device.create_shader_module_trusted(descriptor, checks)
    }
}

/// One dispatch.
#[derive(Debug, Clone)]
pub(crate) struct Pass {
    pub(crate) pipeline: Arc<Pipeline>,
    pub(crate) bind_groups: Vec<wgpu::BindGroup>,
    /// Receivers, or whatever there is an invocation for each.
    pub(crate) count: usize,
}

/// The device's clock at the passes of the last submission.
#[derive(Debug)]
pub(crate) struct PassClock {
    queries: Option<Queries>,
    /// Passes of the last submission.
    passes: Mutex<u32>,
}

#[derive(Debug)]
struct Queries {
    set: wgpu::QuerySet,
    resolved: DeviceBuffer,
    staging: DeviceBuffer,
    tick_secs: f64,
}

impl Pipeline {
    /// The entry point `main` of some WGSL.
    pub(crate) fn new(
        gpu: &Gpu,
        name: &'static str,
        code: String,
        constants: &[(&str, f64)],
    ) -> Result<Self, GpuError> {
        let descriptor =
            wgpu::ShaderModuleDescriptor { label: Some(name), source: wgpu::ShaderSource::Wgsl(code.into()) };
        let module = trusted_module(gpu, descriptor);
        let pipeline = gpu.device.create_compute_pipeline(&wgpu::ComputePipelineDescriptor {
            label: Some(name),
            layout: None,
            module: &module,
            entry_point: Some("main"),
            compilation_options: wgpu::PipelineCompilationOptions { constants, ..Default::default() },
            cache: None,
        });
        gpu.check()?;
        Ok(Self { pipeline, name })
    }

    /// The buffers of a group of bindings, from binding 0 on.
    pub(crate) fn bind(&self, gpu: &Gpu, group: u32, buffers: &[&DeviceBuffer]) -> wgpu::BindGroup {
        self.bind_at(gpu, group, buffers.iter().copied().zip(0..))
    }

    /// Buffers and their places in a group of bindings.
    pub(crate) fn bind_at<'a>(
        &self,
        gpu: &Gpu,
        group: u32,
        buffers: impl IntoIterator<Item = (&'a DeviceBuffer, u32)>,
    ) -> wgpu::BindGroup {
        let entry =
            |(buffer, binding): (&'a DeviceBuffer, u32)| wgpu::BindGroupEntry { binding, resource: buffer.binding() };
        let entries: Vec<_> = buffers.into_iter().map(entry).collect();
        gpu.device.create_bind_group(&wgpu::BindGroupDescriptor {
            label: Some(self.name),
            layout: &self.pipeline.get_bind_group_layout(group),
            entries: &entries,
        })
    }
}

/// Sends passes on their way.
pub(crate) fn start(gpu: &Gpu, passes: &[Pass]) -> wgpu::SubmissionIndex {
    submit(gpu, passes, None)
}

fn submit(gpu: &Gpu, passes: &[Pass], queries: Option<&Queries>) -> wgpu::SubmissionIndex {
    let mut encoder = gpu.device.create_command_encoder(&wgpu::CommandEncoderDescriptor::default());
    for (pass, number) in passes.iter().zip(0u32..) {
        // One pass per kernel: within a pass, times may lie on the wrong side of its barriers.
        let mut compute = encoder.begin_compute_pass(&wgpu::ComputePassDescriptor {
            label: Some(pass.pipeline.name),
            timestamp_writes: queries.map(|queries| wgpu::ComputePassTimestampWrites {
                query_set: &queries.set,
                beginning_of_pass_write_index: Some(2 * number),
                end_of_pass_write_index: Some(2 * number + 1),
            }),
        });
        compute.set_pipeline(&pass.pipeline.pipeline);
        for (bindings, group) in pass.bind_groups.iter().zip(0..) {
            compute.set_bind_group(group, bindings, &[]);
        }
        compute.dispatch_workgroups((pass.count as u32).div_ceil(WORKGROUP), 1, 1);
    }
    gpu.queue.submit([encoder.finish()])
}

impl PassClock {
    pub(crate) fn new(gpu: &Gpu) -> Result<Self, GpuError> {
        let Some(tick_secs) = gpu.tick_secs else { return Ok(Self { queries: None, passes: Mutex::default() }) };
        let count = 2 * MOST_PASSES;
        let descriptor = wgpu::QuerySetDescriptor { label: Some("passes"), ty: wgpu::QueryType::Timestamp, count };
        let bytes = u64::from(count) * 8;
        let queries = Queries {
            set: gpu.device.create_query_set(&descriptor),
            resolved: gpu.query_results("times of passes", bytes)?,
            staging: gpu.staging("times of passes", bytes)?,
            tick_secs,
        };
        Ok(Self { queries: Some(queries), passes: Mutex::default() })
    }

    /// Runs the passes one after another and waits for them.
    pub(crate) fn run(&self, gpu: &Gpu, passes: &[Pass]) -> Result<(), GpuError> {
        // The time of some alone would say nothing about all.
        let queries = self.queries.as_ref().filter(|_| passes.len() <= MOST_PASSES as usize);
        *self.passes.lock().unwrap_or_else(PoisonError::into_inner) = queries.map_or(0, |_| passes.len() as u32);
        let last = submit(gpu, passes, queries);
        gpu.wait_for(last)
    }

    /// Seconds of the last submission's passes by the device's clock, one after another; `None` without a clock.
    ///
    /// In a submission of its own: times that are copied where they are taken have been read as 0.
    pub(crate) fn secs(&self, gpu: &Gpu) -> Result<Option<f64>, GpuError> {
        let passes = *self.passes.lock().unwrap_or_else(PoisonError::into_inner);
        let Some(queries) = self.queries.as_ref().filter(|_| passes > 0) else { return Ok(None) };
        let mut encoder = gpu.device.create_command_encoder(&wgpu::CommandEncoderDescriptor::default());
        encoder.resolve_query_set(&queries.set, 0..2 * passes, &queries.resolved.buffer, 0);
        let bytes = u64::from(passes) * 16;
        encoder.copy_buffer_to_buffer(&queries.resolved.buffer, 0, &queries.staging.buffer, 0, bytes);
        gpu.queue.submit([encoder.finish()]);
        let ticks = gpu.read(&queries.staging, |bytes| {
            let ticks = bytes.as_chunks::<8>().0.iter().map(|tick| u64::from_ne_bytes(*tick));
            let ticks: Vec<u64> = ticks.take(2 * passes as usize).collect();
            ticks.as_chunks::<2>().0.iter().map(|[begin, end]| end.saturating_sub(*begin)).sum::<u64>()
        })?;
        Ok(Some(ticks as f64 * queries.tick_secs))
    }
}
