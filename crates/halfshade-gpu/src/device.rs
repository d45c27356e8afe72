//! The graphics device: found, opened, watched.

use crate::{Choice, GpuError};
use std::{
    num::NonZeroU64,
    sync::{
        Arc, Mutex, PoisonError,
        atomic::{AtomicU64, Ordering},
        mpsc,
    },
    time::Duration,
};

/// Longest wait for the device, in seconds: no dispatch of ours takes a tenth of it, even in software.
const PATIENCE_SECS: u64 = 600;

/// The least size of a buffer: the largest element of any array of ours fits.
const LEAST_BYTES: u64 = 256;

/// An open device.
#[derive(Debug)]
pub struct Gpu {
    instance: wgpu::Instance,
    pub(crate) device: wgpu::Device,
    pub(crate) queue: wgpu::Queue,
    facts: AdapterFacts,
    faults: Arc<Faults>,
    held: Arc<AtomicU64>,
    /// Seconds per tick of its clock, if it has one.
    pub(crate) tick_secs: Option<f64>,
}

/// A device as results describe it.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct AdapterFacts {
    /// Name.
    pub name: String,
    /// Driver and its version.
    pub driver: String,
    /// Whether it is a program on the processor.
    pub is_software: bool,
}

/// The first complaint of the device, until someone asks.
#[derive(Debug, Default)]
struct Faults(Mutex<Option<Fault>>);

#[derive(Debug)]
enum Fault {
    Lost(String),
    OutOfMemory(String),
    Refused(String),
}

impl Faults {
    /// The first counts: others follow from it.
    fn add(&self, fault: Fault) {
        self.0.lock().unwrap_or_else(PoisonError::into_inner).get_or_insert(fault);
    }
}

/// A buffer on the device, counted as long as it lives.
#[derive(Debug)]
pub(crate) struct DeviceBuffer {
    pub(crate) buffer: wgpu::Buffer,
    /// Bytes that were asked for: kernels see so many.
    asked: u64,
    held: Arc<AtomicU64>,
}

impl DeviceBuffer {
    /// The part that kernels see; of an empty array some element, since there is no empty binding.
    pub(crate) fn binding(&self) -> wgpu::BindingResource<'_> {
        let size = NonZeroU64::new(self.asked.next_multiple_of(4));
        wgpu::BindingResource::Buffer(wgpu::BufferBinding { buffer: &self.buffer, offset: 0, size })
    }

    pub(crate) fn bytes(&self) -> usize {
        self.buffer.size() as usize
    }
}

impl Drop for DeviceBuffer {
    fn drop(&mut self) {
        self.held.fetch_sub(self.buffer.size(), Ordering::Relaxed);
        // Frees the memory at once, instead of when the last bind group goes.
        self.buffer.destroy();
    }
}

impl Gpu {
    /// Opens the device that `choice` asks for; `None` if it asks for none.
    pub fn open(choice: &Choice) -> Result<Option<Arc<Self>>, GpuError> {
        if *choice == Choice::Off {
            return Ok(None);
        }
        let instance = instance();
        let adapters = adapters(&instance);
        let adapter = chosen(&adapters, choice)?;
        let features = adapter.features() & wgpu::Features::TIMESTAMP_QUERY;
        let descriptor = wgpu::DeviceDescriptor {
            label: Some("halfshade"),
            required_features: features,
            required_limits: wgpu::Limits::default(),
            ..Default::default()
        };
        let (device, queue) = pollster::block_on(adapter.request_device(&descriptor))
            .map_err(|error| GpuError::NoAdapter(error.to_string()))?;
        let faults = Arc::new(Faults::default());
        let lost = faults.clone();
        device.set_device_lost_callback(move |_, reason| lost.add(Fault::Lost(reason)));
        let refused = faults.clone();
        device.on_uncaptured_error(Arc::new(move |error| {
            refused.add(match error {
                wgpu::Error::OutOfMemory { source } => Fault::OutOfMemory(source.to_string()),
                other => Fault::Refused(other.to_string()),
            });
        }));
        let has_clock = features.contains(wgpu::Features::TIMESTAMP_QUERY);
        let tick_secs = has_clock.then(|| f64::from(queue.get_timestamp_period()) * 1e-9);
        let facts = facts(&adapter.get_info());
        Ok(Some(Arc::new(Self { instance, device, queue, facts, faults, held: Arc::default(), tick_secs })))
    }

    /// Name, driver, software or hardware.
    pub fn facts(&self) -> &AdapterFacts {
        &self.facts
    }

    /// Bytes of all our buffers on the device.
    pub fn held_bytes(&self) -> u64 {
        self.held.load(Ordering::Relaxed)
    }

    /// Buffers, bindings, pipelines and commands that live, whoever holds them.
    pub fn live_objects(&self) -> usize {
        let Some(report) = self.instance.generate_report() else { return 0 };
        let hub = report.hub_report();
        let kinds = [
            &hub.buffers,
            &hub.bind_groups,
            &hub.bind_group_layouts,
            &hub.compute_pipelines,
            &hub.command_encoders,
            &hub.command_buffers,
            &hub.query_sets,
        ];
        kinds.iter().map(|kind| kind.num_allocated).sum()
    }

    /// The fault since it was last asked.
    pub(crate) fn check(&self) -> Result<(), GpuError> {
        let fault = self.faults.0.lock().unwrap_or_else(PoisonError::into_inner).take();
        match fault {
            None => Ok(()),
            Some(Fault::Lost(reason)) => Err(GpuError::Lost(reason)),
            Some(Fault::OutOfMemory(problem)) => Err(GpuError::OutOfMemory { held: self.held_bytes(), problem }),
            Some(Fault::Refused(problem)) => Err(GpuError::Refused(problem)),
        }
    }

    /// A buffer of at least `bytes`, which kernels read and write and which can be copied to and from.
    pub(crate) fn buffer(&self, what: &str, bytes: u64) -> Result<DeviceBuffer, GpuError> {
        self.buffer_for(what, bytes, wgpu::BufferUsages::STORAGE | wgpu::BufferUsages::COPY_SRC)
    }

    /// A small buffer of settings, for either kind of binding.
    pub(crate) fn uniforms(&self, what: &str, bytes: u64) -> Result<DeviceBuffer, GpuError> {
        self.buffer_for(what, bytes, wgpu::BufferUsages::UNIFORM | wgpu::BufferUsages::STORAGE)
    }

    fn buffer_for(&self, what: &str, bytes: u64, usage: wgpu::BufferUsages) -> Result<DeviceBuffer, GpuError> {
        // Nothing can be bound that is smaller than an element of its array, and sizes are whole rows.
        let size = bytes.max(LEAST_BYTES).next_multiple_of(16);
        let limit = self.device.limits().max_storage_buffer_binding_size;
        if size > limit {
            return Err(GpuError::TooLarge { what: what.to_owned(), bytes, limit });
        }
        self.new_buffer(what, bytes, size, usage | wgpu::BufferUsages::COPY_DST)
    }

    fn new_buffer(
        &self,
        what: &str,
        asked: u64,
        size: u64,
        usage: wgpu::BufferUsages,
    ) -> Result<DeviceBuffer, GpuError> {
        self.held.fetch_add(size, Ordering::Relaxed);
        let descriptor = wgpu::BufferDescriptor { label: Some(what), size, usage, mapped_at_creation: false };
        let buffer = self.device.create_buffer(&descriptor);
        let buffer = DeviceBuffer { buffer, asked, held: self.held.clone() };
        self.check()?;
        Ok(buffer)
    }

    /// A buffer of which the processor reads what was copied into it.
    pub(crate) fn staging(&self, what: &str, bytes: u64) -> Result<DeviceBuffer, GpuError> {
        let usage = wgpu::BufferUsages::MAP_READ | wgpu::BufferUsages::COPY_DST;
        self.new_buffer(what, bytes, bytes.max(16).next_multiple_of(16), usage)
    }

    /// A buffer for the device's clock.
    pub(crate) fn query_results(&self, what: &str, bytes: u64) -> Result<DeviceBuffer, GpuError> {
        self.new_buffer(what, bytes, bytes, wgpu::BufferUsages::QUERY_RESOLVE | wgpu::BufferUsages::COPY_SRC)
    }

    /// Makes a buffer that has room for so many bytes, if there is none yet. True if it is another buffer.
    pub(crate) fn reserve(&self, what: &str, slot: &mut Option<DeviceBuffer>, bytes: usize) -> Result<bool, GpuError> {
        if slot.as_ref().is_some_and(|buffer| buffer.bytes() >= bytes) {
            return Ok(false);
        }
        // The old one goes first: both may not fit.
        *slot = None;
        *slot = Some(self.buffer(what, bytes as u64)?);
        Ok(true)
    }

    /// Writes `values` into a buffer that has room for them, making a larger one if it hasn't. True if it is another buffer.
    pub(crate) fn write<T: bytemuck::NoUninit>(
        &self,
        what: &str,
        slot: &mut Option<DeviceBuffer>,
        values: &[T],
    ) -> Result<bool, GpuError> {
        let bytes = bytemuck::cast_slice::<T, u8>(values);
        let is_new = self.reserve(what, slot, bytes.len())?;
        if let Some(buffer) = slot {
            self.queue.write_buffer(&buffer.buffer, 0, bytes);
        }
        Ok(is_new)
    }

    /// A buffer that holds `values`.
    pub(crate) fn filled<T: bytemuck::NoUninit>(&self, what: &str, values: &[T]) -> Result<DeviceBuffer, GpuError> {
        let bytes = bytemuck::cast_slice::<T, u8>(values);
        let buffer = self.buffer(what, bytes.len() as u64)?;
        self.queue.write_buffer(&buffer.buffer, 0, bytes);
        Ok(buffer)
    }

    /// Waits until all that was submitted is done.
    pub(crate) fn wait(&self) -> Result<(), GpuError> {
        self.wait_until(None)
    }

    /// Waits until a submission is done, and all before it.
    pub(crate) fn wait_for(&self, last: wgpu::SubmissionIndex) -> Result<(), GpuError> {
        self.wait_until(Some(last))
    }

    fn wait_until(&self, submission_index: Option<wgpu::SubmissionIndex>) -> Result<(), GpuError> {
        let timeout = Some(Duration::from_secs(PATIENCE_SECS));
        let waited = self.device.poll(wgpu::PollType::Wait { submission_index, timeout });
        self.check()?;
        match waited {
            Ok(_) => Ok(()),
            Err(wgpu::PollError::Timeout) => Err(GpuError::Timeout(PATIENCE_SECS)),
            Err(error) => Err(GpuError::Refused(error.to_string())),
        }
    }

    /// Copies the first bytes of a buffer into a staging buffer, and hands that to `read`.
    pub(crate) fn read_copy<R>(
        &self,
        source: &DeviceBuffer,
        staging: &DeviceBuffer,
        bytes: u64,
        read: impl FnOnce(&[u8]) -> R,
    ) -> Result<R, GpuError> {
        let mut encoder = self.device.create_command_encoder(&wgpu::CommandEncoderDescriptor::default());
        encoder.copy_buffer_to_buffer(&source.buffer, 0, &staging.buffer, 0, bytes);
        self.queue.submit([encoder.finish()]);
        self.read(staging, read)
    }

    /// Hands the bytes of a staging buffer, into which something was copied, to `read`.
    pub(crate) fn read<R>(&self, staging: &DeviceBuffer, read: impl FnOnce(&[u8]) -> R) -> Result<R, GpuError> {
        let refused = |error: &dyn std::fmt::Display| GpuError::Refused(error.to_string());
        let (sender, receiver) = mpsc::channel();
        staging.buffer.map_async(wgpu::MapMode::Read, .., move |result| {
            // Whoever gave up doesn't listen.
            let _ = sender.send(result);
        });
        self.wait()?;
        // Another thread that waits for the device may be the one that is about to tell.
        match receiver.recv_timeout(Duration::from_secs(PATIENCE_SECS)) {
            Ok(Ok(())) => {}
            Ok(Err(error)) => return Err(refused(&error)),
            Err(_) => return Err(GpuError::Timeout(PATIENCE_SECS)),
        }
        let found = {
            let view = staging.buffer.get_mapped_range(..).map_err(|error| refused(&error))?;
            read(&view)
        };
        staging.buffer.unmap();
        Ok(found)
    }
}

/// All graphics devices, in the order of their numbers.
pub fn devices() -> Vec<AdapterFacts> {
    adapters(&instance()).iter().map(|adapter| facts(&adapter.get_info())).collect()
}

fn instance() -> wgpu::Instance {
    wgpu::Instance::new(wgpu::InstanceDescriptor {
        backends: wgpu::Backends::VULKAN,
        ..wgpu::InstanceDescriptor::new_without_display_handle()
    })
}

fn adapters(instance: &wgpu::Instance) -> Vec<wgpu::Adapter> {
    pollster::block_on(instance.enumerate_adapters(wgpu::Backends::VULKAN))
}

/// The adapter that is asked for.
fn chosen<'a>(adapters: &'a [wgpu::Adapter], choice: &Choice) -> Result<&'a wgpu::Adapter, GpuError> {
    let none = || GpuError::NoAdapter("no Vulkan driver was found".into());
    let best_first = |adapter: &&wgpu::Adapter| match adapter.get_info().device_type {
        wgpu::DeviceType::DiscreteGpu => 0,
        wgpu::DeviceType::IntegratedGpu => 1,
        wgpu::DeviceType::VirtualGpu => 2,
        wgpu::DeviceType::Other => 3,
        wgpu::DeviceType::Cpu => 4,
    };
    let best = adapters.iter().min_by_key(best_first).ok_or_else(none)?;
    let unknown = |asked: String| GpuError::UnknownAdapter { asked, known: listed(adapters) };
    match choice {
        Choice::Auto | Choice::Off => Ok(best),
        Choice::Number(number) => adapters.get(*number).ok_or_else(|| unknown(number.to_string())),
        Choice::Name(name) => {
            let wanted = name.to_lowercase();
            let is_wanted = |adapter: &&wgpu::Adapter| adapter.get_info().name.to_lowercase().contains(&wanted);
            adapters.iter().find(is_wanted).ok_or_else(|| unknown(name.clone()))
        }
    }
}

fn listed(adapters: &[wgpu::Adapter]) -> String {
    let name = |(number, adapter): (usize, &wgpu::Adapter)| format!("{number}: {}", adapter.get_info().name);
    adapters.iter().enumerate().map(name).collect::<Vec<_>>().join(", ")
}

fn facts(info: &wgpu::AdapterInfo) -> AdapterFacts {
    AdapterFacts {
        name: info.name.clone(),
        driver: format!("{} {}", info.driver, info.driver_info).trim().to_owned(),
        is_software: info.device_type == wgpu::DeviceType::Cpu,
    }
}
