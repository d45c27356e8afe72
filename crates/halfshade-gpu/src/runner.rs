//! A kernel over receivers, with everything that it reads on the device.

use crate::{
    Gpu, GpuError,
    device::DeviceBuffer,
    kernels::Kernel,
    pipeline::{self, Pass, PassClock, Pipeline, Pipelines},
    receivers::{KernelSpace, ResidentReceivers},
};
use halfshade_scene::{Frame, RadianceMut, Receivers};
use halfshade_strategy::{Batching, Prepared, Shading, StrategyError};
use std::{
    ops::Range,
    sync::{Arc, Mutex, PoisonError},
};

/// A device, and the kernels that were made ready for it.
#[derive(Debug, Clone)]
pub(crate) struct Bench {
    pub(crate) gpu: Arc<Gpu>,
    pub(crate) pipelines: Arc<Pipelines>,
}

/// A kernel, its receivers and its data.
#[derive(Debug)]
pub(crate) struct Runner {
    gpu: Arc<Gpu>,
    name: &'static str,
    pipeline: Arc<Pipeline>,
    clock: PassClock,
    receivers: ResidentReceivers,
    uniforms: DeviceBuffer,
    /// The buffers of group 1, from binding 1 on.
    buffers: Vec<Option<DeviceBuffer>>,
    /// Names of those buffers.
    names: &'static [&'static str],
    bindings: Option<Bindings>,
    /// Other kernels that run before.
    before: Vec<Pass>,
    /// Other kernels that run after, stage by stage.
    after: Vec<Follower>,
    /// Settings of each dispatch, where a frame takes several, and their bindings of group 2.
    parts: Vec<(DeviceBuffer, wgpu::BindGroup)>,
    /// Vectors that the kernel keeps of each receiver beside its radiance.
    kept: usize,
    /// The error while shading, for who reads back.
    fault: Mutex<Option<GpuError>>,
}

#[derive(Debug)]
struct Bindings {
    /// Receivers of each part, and how many they are.
    receivers: Vec<(wgpu::BindGroup, usize)>,
    frame: wgpu::BindGroup,
    /// Receivers of each part for those that run after.
    after: Vec<wgpu::BindGroup>,
}

/// A pass over the same receivers behind those of a kernel.
#[derive(Debug)]
pub(crate) struct Follower {
    /// The same for all.
    pub(crate) pipeline: Arc<Pipeline>,
    /// Bindings of group 1 for each part of the receivers.
    pub(crate) bindings: Vec<wgpu::BindGroup>,
}

/// A frame on its way through the device.
struct OnItsWay {
    gpu: Arc<Gpu>,
    last: wgpu::SubmissionIndex,
}

impl Shading for OnItsWay {
    fn finish(self: Box<Self>) -> Result<(), StrategyError> {
        Ok(self.gpu.wait_for(self.last)?)
    }
}

/// The frame that was uploaded last, to be shaded.
pub(crate) struct Uploaded<'a>(pub(crate) &'a Runner);

impl Runner {
    /// `constants` are values of the kernel's `override`s; `uniform_bytes` is the size of its frame's settings.
    pub(crate) fn new(
        Bench { gpu, pipelines }: &Bench,
        kernel: &Kernel,
        bands: Option<usize>,
        constants: &[(&str, f64)],
        uniform_bytes: usize,
    ) -> Result<Self, GpuError> {
        let names = kernel.buffers.get(1).and_then(|group| group.get(1..)).unwrap_or_default();
        Ok(Self {
            name: kernel.name,
            pipeline: pipelines.get(gpu, kernel, bands, constants)?,
            clock: PassClock::new(gpu)?,
            receivers: ResidentReceivers::default(),
            uniforms: gpu.uniforms("settings of the frame", uniform_bytes as u64)?,
            buffers: names.iter().map(|_| None).collect(),
            names,
            bindings: None,
            before: Vec::new(),
            after: Vec::new(),
            parts: Vec::new(),
            kept: 0,
            fault: Mutex::default(),
            gpu: gpu.clone(),
        })
    }

    pub(crate) fn gpu(&self) -> &Gpu {
        &self.gpu
    }

    /// Shades a frame in as many dispatches as there are `parts`, one after another.
    pub(crate) fn set_parts(&mut self, parts: &[[u32; 4]]) -> Result<(), GpuError> {
        self.parts.clear();
        for part in parts {
            let buffer = self.gpu.uniforms("settings of a dispatch", size_of_val(part) as u64)?;
            self.gpu.queue.write_buffer(&buffer.buffer, 0, bytemuck::bytes_of(part));
            let bindings = self.pipeline.bind(&self.gpu, 2, &[&buffer]);
            self.parts.push((buffer, bindings));
        }
        self.gpu.check()
    }

    /// Makes room for vectors that the kernel keeps of each receiver placed from now on.
    pub(crate) fn keep_vectors(&mut self, count: usize) {
        self.kept = count;
    }

    /// Puts receivers on the device.
    pub(crate) fn place_receivers(
        &mut self,
        frame: &Frame<'_>,
        receivers: Receivers<'_>,
        group: &dyn Fn(usize) -> u32,
    ) -> Result<(), GpuError> {
        self.bindings = None;
        self.after.clear();
        self.receivers = ResidentReceivers::default();
        self.receivers = ResidentReceivers::new(&self.gpu, frame, receivers, group, self.kept)?;
        Ok(())
    }

    /// Brings the objects' places up to a frame.
    pub(crate) fn place_objects(&mut self, frame: &Frame<'_>, space: &KernelSpace) -> Result<(), GpuError> {
        if self.receivers.place(&self.gpu, frame, space)? {
            self.bindings = None;
        }
        Ok(())
    }

    /// Writes the frame's settings.
    pub(crate) fn write_uniforms<T: bytemuck::NoUninit>(&self, values: &T) {
        self.gpu.queue.write_buffer(&self.uniforms.buffer, 0, bytemuck::bytes_of(values));
    }

    /// Writes the buffer of group 1 at a binding, from 1 on.
    pub(crate) fn write<T: bytemuck::NoUninit>(&mut self, binding: usize, values: &[T]) -> Result<(), GpuError> {
        let place = binding - 1;
        if self.gpu.write(self.names[place], &mut self.buffers[place], values)? {
            self.bindings = None;
        }
        Ok(())
    }

    /// Writes the beginning of a buffer of group 1 that was written before.
    pub(crate) fn write_part<T: bytemuck::NoUninit>(&self, binding: usize, values: &[T]) {
        if let Some(buffer) = self.buffers[binding - 1].as_ref().filter(|_| !values.is_empty()) {
            self.gpu.queue.write_buffer(&buffer.buffer, 0, bytemuck::cast_slice(values));
        }
    }

    /// Makes room in the buffer of group 1 at a binding, which a kernel is going to write.
    pub(crate) fn reserve(&mut self, binding: usize, bytes: usize) -> Result<(), GpuError> {
        let place = binding - 1;
        if self.gpu.reserve(self.names[place], &mut self.buffers[place], bytes)? {
            self.bindings = None;
        }
        Ok(())
    }

    /// The buffer of group 1 at a binding, from 1 on.
    pub(crate) fn buffer(&self, binding: usize) -> Option<&DeviceBuffer> {
        self.buffers[binding - 1].as_ref()
    }

    /// Runs other kernels before this one, frame by frame.
    pub(crate) fn run_before(&mut self, passes: Vec<Pass>) {
        self.before = passes;
    }

    /// Runs other kernels after this one, frame by frame, until receivers are placed anew.
    pub(crate) fn run_after(&mut self, followers: Vec<Follower>) {
        self.bindings = None;
        self.after = followers;
    }

    /// The receivers of each part.
    pub(crate) fn receiver_ranges(&self) -> Vec<Range<usize>> {
        self.receivers.ranges().collect()
    }

    /// Sends what was written on its way, and makes bindings anew if a buffer is another one: then it is true.
    pub(crate) fn upload(&mut self) -> Result<bool, GpuError> {
        self.gpu.queue.submit([]);
        let is_new = self.bindings.is_none();
        if is_new {
            let frame = self.bind_frame(&self.pipeline);
            let receivers = self.receivers.bind(&self.gpu, &self.pipeline);
            let after = (self.after.first()).map(|first| self.receivers.bind(&self.gpu, &first.pipeline));
            let after = after.unwrap_or_default().into_iter().map(|(places, _)| places).collect();
            self.bindings = Some(Bindings { receivers, frame, after });
        }
        self.gpu.check()?;
        Ok(is_new)
    }

    /// The frame's data as a pipeline of this kernel or of a like one reads it.
    pub(crate) fn bind_frame(&self, pipeline: &Pipeline) -> wgpu::BindGroup {
        let buffers = std::iter::once(&self.uniforms).chain(self.buffers.iter().flatten());
        pipeline.bind(&self.gpu, 1, &buffers.collect::<Vec<_>>())
    }

    /// All dispatches of the frame that was uploaded last.
    fn passes(&self, count: usize) -> Result<Vec<Pass>, GpuError> {
        if count != self.receivers.len() {
            let placed = self.receivers.len();
            return Err(GpuError::Refused(format!("{count} receivers are to be shaded, but {placed} were placed")));
        }
        let Some(Bindings { receivers, frame, after }) = &self.bindings else { return Ok(Vec::new()) };
        let mut passes = self.before.clone();
        for (number, (places, count)) in receivers.iter().enumerate() {
            let mut add = |part: Option<&'_ wgpu::BindGroup>| {
                let bind_groups = [places, frame].into_iter().chain(part).cloned().collect();
                passes.push(Pass { pipeline: self.pipeline.clone(), bind_groups, count: *count });
            };
            match self.parts.as_slice() {
                [] => add(None),
                parts => parts.iter().for_each(|(_, part)| add(Some(part))),
            }
            if let Some(places) = after.get(number) {
                passes.extend(self.after.iter().map(|Follower { pipeline, bindings }| {
                    let bind_groups = vec![places.clone(), bindings[number].clone()];
                    Pass { pipeline: pipeline.clone(), bind_groups, count: *count }
                }));
            }
        }
        Ok(passes)
    }

    fn run(&self, count: usize) -> Result<(), GpuError> {
        self.clock.run(&self.gpu, &self.passes(count)?)
    }

    /// Bytes of receivers, and of everything else.
    pub(crate) fn bytes(&self) -> [usize; 2] {
        let others: usize = self.buffers.iter().flatten().map(DeviceBuffer::bytes).sum();
        [self.receivers.bytes(), others + self.uniforms.bytes()]
    }
}

impl Prepared for Uploaded<'_> {
    fn batching(&self) -> Batching {
        Batching::WholeFrame
    }

    fn shade(&self, receivers: Receivers<'_>, _out: RadianceMut<'_>) {
        let outcome = self.0.run(receivers.len());
        *self.0.fault.lock().unwrap_or_else(PoisonError::into_inner) = outcome.err();
    }

    fn start(&self, receivers: Receivers<'_>) -> Option<Result<Box<dyn Shading>, StrategyError>> {
        let gpu = self.0.gpu.clone();
        let start = |passes: Vec<Pass>| -> Box<dyn Shading> {
            let last = pipeline::start(&gpu, &passes);
            Box::new(OnItsWay { gpu, last })
        };
        Some(self.0.passes(receivers.len()).map(start).map_err(StrategyError::from))
    }

    fn read_back(&self, mut out: RadianceMut<'_>) -> Result<(), StrategyError> {
        let Runner { gpu, receivers, fault, name, .. } = self.0;
        let told = |error: GpuError| StrategyError::Failed(format!("{name}: {error}"));
        if let Some(error) = fault.lock().unwrap_or_else(PoisonError::into_inner).take() {
            return Err(told(error));
        }
        receivers.read_back(gpu, &mut out).map_err(told)
    }

    fn device_secs(&self) -> Option<f64> {
        self.0.clock.secs(&self.0.gpu).ok().flatten()
    }
}
