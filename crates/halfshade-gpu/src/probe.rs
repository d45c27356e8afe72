//! Single functions of the shaders, called with rows of numbers: for tests that hold each twin to double precision.

pub use crate::{
    analytic::FrameUniforms as AnalyticFrame,
    mask::FrameUniforms as MaskFrame,
    prt::{Between as TransferBetween, ClusterBetween, ClusterUniforms, FrameUniforms as TransferFrame, fit_rows},
    ray_traced::buffers::RayBuffers,
    sh_exp::{
        first_pass::{Emitter, Rounds},
        frame::DeviceBlocker,
        tables::{FrameUniforms, LinearTable, Tables},
    },
    shadow_field::buffers::FieldBuffers,
};

use crate::{
    Gpu, GpuError,
    device::DeviceBuffer,
    kernels::Kernel,
    pipeline::{Pass, PassClock, Pipeline, WORKGROUP},
    shader,
};
use bytemuck::NoUninit;
use std::sync::Arc;

/// Calls of a function, one per invocation.
#[derive(Debug, Clone, Copy)]
pub struct Probe<'a> {
    /// File in `shaders/` that the function is in.
    pub shader: &'a str,
    /// Bands of SH vectors, if there are any.
    pub bands: Option<usize>,
    /// Values of `override`s.
    pub constants: &'a [(&'a str, f64)],
    /// Rows of four numbers that a call gets and gives.
    pub rows: [usize; 2],
    /// Statements that read `input` and write `output`, arrays of `vec4f`.
    pub body: &'a str,
    /// Variables that the function reads.
    pub variables: &'a [Variable<'a>],
}

/// The group of what calls get and give, behind all groups of shaders.
const CALLS: u32 = 2;

/// A variable of a shader that is bound to a buffer, and what it holds: one of group 1, unless it is of another.
#[derive(Debug, Clone, Copy)]
pub struct Variable<'a> {
    group: u32,
    binding: u32,
    name: &'a str,
    bytes: &'a [u8],
    kind: Kind,
}

#[derive(Debug, Clone, Copy, PartialEq, Eq)]
enum Kind {
    Uniform,
    Array,
    /// In `storage`.
    Struct,
}

impl<'a> Variable<'a> {
    /// A struct in `uniform` memory.
    pub fn uniform<T: NoUninit>(binding: u32, name: &'a str, value: &'a T) -> Self {
        Self { group: 1, binding, name, bytes: bytemuck::bytes_of(value), kind: Kind::Uniform }
    }

    /// An array in `storage` that is only read.
    pub fn storage<T: NoUninit>(binding: u32, name: &'a str, values: &'a [T]) -> Self {
        Self { group: 1, binding, name, bytes: bytemuck::cast_slice(values), kind: Kind::Array }
    }

    /// A struct in `storage` that is only read, by the function that is called.
    pub fn storage_struct<T: NoUninit>(binding: u32, name: &'a str, value: &'a T) -> Self {
        Self { group: 1, binding, name, bytes: bytemuck::bytes_of(value), kind: Kind::Struct }
    }

    /// The same in another group than 1.
    pub fn of_group(self, group: u32) -> Self {
        Self { group, ..self }
    }

    fn buffer(&self, gpu: &Gpu) -> Result<DeviceBuffer, GpuError> {
        if self.kind != Kind::Uniform {
            return gpu.filled(self.name, self.bytes);
        }
        let buffer = gpu.uniforms(self.name, self.bytes.len() as u64)?;
        gpu.queue.write_buffer(&buffer.buffer, 0, self.bytes);
        Ok(buffer)
    }

    /// A statement that uses it: a binding that nothing uses isn't there.
    fn use_of(&self) -> String {
        match self.kind {
            Kind::Uniform => format!("_ = {};", self.name),
            Kind::Array => format!("_ = arrayLength(&{});", self.name),
            Kind::Struct => String::new(),
        }
    }
}

fn buffers(gpu: &Gpu, variables: &[Variable<'_>]) -> Result<Vec<(DeviceBuffer, u32)>, GpuError> {
    variables.iter().map(|variable| Ok((variable.buffer(gpu)?, variable.binding))).collect()
}

/// Rows that a kernel with a single group of variables writes into the last of them, having been given the others.
pub fn run(
    gpu: &Arc<Gpu>,
    kernel: &Kernel,
    bands: Option<usize>,
    variables: &[Variable<'_>],
    workgroups: usize,
    rows: usize,
) -> Result<Vec<[f32; 4]>, GpuError> {
    let pipeline = Arc::new(Pipeline::new(gpu, kernel.name, kernel.code(bands), &[])?);
    let given = buffers(gpu, variables)?;
    let outputs = gpu.buffer("outputs", 16 * rows as u64)?;
    let bound = given.iter().map(|(buffer, binding)| (buffer, *binding)).chain([(&outputs, given.len() as u32)]);
    let bind_groups = vec![pipeline.bind_at(gpu, 0, bound)];
    results(gpu, Pass { pipeline, bind_groups, count: workgroups * WORKGROUP as usize }, &outputs, rows)
}

fn results(gpu: &Gpu, pass: Pass, outputs: &DeviceBuffer, rows: usize) -> Result<Vec<[f32; 4]>, GpuError> {
    PassClock::new(gpu)?.run(gpu, &[pass])?;
    let bytes = 16 * rows as u64;
    let staging = gpu.staging("outputs", bytes)?;
    gpu.read_copy(outputs, &staging, bytes, |bytes| bytemuck::cast_slice(&bytes[..16 * rows]).to_vec())
}

impl Probe<'_> {
    /// Rows that the calls give for their `inputs`, call by call.
    pub fn call(&self, gpu: &Arc<Gpu>, inputs: &[[f32; 4]]) -> Result<Vec<[f32; 4]>, GpuError> {
        let [taken, given] = self.rows;
        let count = inputs.len() / taken;
        let pipeline = Arc::new(Pipeline::new(gpu, "probe", self.code(), self.constants)?);
        let inputs = gpu.filled("inputs", inputs)?;
        let outputs = gpu.buffer("outputs", 16 * (count * given) as u64)?;
        let variables = buffers(gpu, self.variables)?;
        let bind = |group: u32| {
            let bound = self.variables.iter().zip(&variables).filter(|(variable, _)| variable.group == group);
            pipeline.bind_at(gpu, group, bound.map(|(_, (buffer, binding))| (buffer, *binding)))
        };
        let mut bind_groups: Vec<_> = (0..CALLS).map(bind).collect();
        bind_groups.push(pipeline.bind(gpu, CALLS, &[&inputs, &outputs]));
        results(gpu, Pass { pipeline, bind_groups, count }, &outputs, count * given)
    }

    fn code(&self) -> String {
        let [taken, given] = self.rows;
        let mut code = shader::module(self.shader, self.bands);
        let entry = format!(
            "@group({CALLS}) @binding(0) var<storage, read> inputs: array<vec4f>;
            @group({CALLS}) @binding(1) var<storage, read_write> outputs: array<vec4f>;
            @compute @workgroup_size(64)
            fn main(@builtin(global_invocation_id) invocation: vec3u) {{
                let number = invocation.x;
                if ((number + 1u) * {taken}u > arrayLength(&inputs)) {{
                    return;
                }}
                var input: array<vec4f, {taken}>;
                for (var row = 0u; row < {taken}u; row++) {{
                    input[row] = inputs[number * {taken}u + row];
                }}
                var output: array<vec4f, {given}>;
                {bound}
                {body}
                for (var row = 0u; row < {given}u; row++) {{
                    outputs[number * {given}u + row] = output[row];
                }}
            }}",
            bound = self.variables.iter().map(Variable::use_of).collect::<String>(),
            body = self.body
        );
        code.push_str(&entry);
        code
    }
}
