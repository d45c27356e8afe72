//! Single functions of the shaders, called with rows of numbers: for tests that hold each twin to double precision.

pub use crate::sh_exp::tables::{FrameUniforms, LinearTable, Tables};

use crate::{
    Gpu, GpuError,
    device::DeviceBuffer,
    pipeline::{Pass, PassClock, Pipeline},
    shader,
};
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
    /// The frame's settings and rows of tables, as group 1 of `sh_exp` has them, if the function reads them.
    pub tables: Option<(&'a FrameUniforms, &'a [[f32; 4]])>,
}

impl Probe<'_> {
    /// Rows that the calls give for their `inputs`, call by call.
    pub fn call(&self, gpu: &Arc<Gpu>, inputs: &[[f32; 4]]) -> Result<Vec<[f32; 4]>, GpuError> {
        let [taken, given] = self.rows;
        let count = inputs.len() / taken;
        let pipeline = Arc::new(Pipeline::new(gpu, "probe", self.code(), self.constants)?);
        let inputs = gpu.filled("inputs", inputs)?;
        let bytes = (count * given * 16) as u64;
        let outputs = gpu.buffer("outputs", bytes)?;
        let tables = self.tables.map(|(uniforms, rows)| -> Result<[DeviceBuffer; 2], GpuError> {
            let settings = gpu.uniforms("settings", size_of::<FrameUniforms>() as u64)?;
            gpu.queue.write_buffer(&settings.buffer, 0, bytemuck::bytes_of(uniforms));
            Ok([settings, gpu.filled("tables", rows)?])
        });
        let tables = tables.transpose()?;
        let mut bind_groups = vec![pipeline.bind(gpu, 0, &[&inputs, &outputs])];
        if let Some([settings, rows]) = &tables {
            bind_groups.push(pipeline.bind_at(gpu, 1, [(settings, 0), (rows, 3)]));
        }
        PassClock::new(gpu)?.run(gpu, &[Pass { pipeline, bind_groups, count }])?;
        let staging = gpu.staging("outputs", bytes)?;
        gpu.read_copy(&outputs, &staging, bytes, |bytes| bytemuck::cast_slice(&bytes[..count * given * 16]).to_vec())
    }

    fn code(&self) -> String {
        let [taken, given] = self.rows;
        let mut code = shader::module(self.shader, self.bands);
        let entry = format!(
            "@group(0) @binding(0) var<storage, read> inputs: array<vec4f>;
            @group(0) @binding(1) var<storage, read_write> outputs: array<vec4f>;
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
            // A binding that nothing uses isn't there.
            bound = if self.tables.is_some() { "_ = frame.grid_cells; _ = tables[0];" } else { "" },
            body = self.body
        );
        code.push_str(&entry);
        code
    }
}
