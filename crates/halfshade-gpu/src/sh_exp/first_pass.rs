//! First pass of reflections on the device: as many rounds of shading sample points and making radiance of it as there are
//! bounces.

use crate::{
    Gpu, GpuError,
    device::DeviceBuffer,
    kernels::{SH_EXP, SH_EXP_EMIT},
    pipeline::{Pass, Pipeline, WORKGROUP},
    receivers::{KernelSpace, ResidentReceivers},
    runner::{Bench, Runner},
};
use bytemuck::{Pod, Zeroable};
use halfshade_scene::Frame;
use halfshade_strategies::sh_exp::{
    BakedScene,
    arrays::{FrameArrays, ReflectionArrays},
};
use std::sync::Arc;

/// A sphere that radiates, as `sh_exp/emit.wgsl` reads it.
#[repr(C)]
#[derive(Debug, Clone, Copy, Pod, Zeroable)]
#[expect(missing_docs, reason = "fields are told of in `sh_exp/emit.wgsl`")]
pub struct Emitter {
    pub first_sample: u32,
    pub samples: u32,
    pub weights: u32,
    pub rotation: u32,
}

/// Settings of all rounds, as `sh_exp/emit.wgsl` reads them.
#[repr(C)]
#[derive(Debug, Clone, Copy, PartialEq, Pod, Zeroable)]
#[expect(missing_docs, reason = "fields are told of in `sh_exp/emit.wgsl`")]
pub struct Rounds {
    pub channels: u32,
    pub surface_channels: u32,
    pub used: u32,
    pub samples: u32,
}

/// Sample points and weights of all spheres on the device.
#[derive(Debug)]
pub(super) struct DeviceFirstPass {
    gpu: Arc<Gpu>,
    /// Sample points in the dark, and once spheres radiate.
    shade: [Arc<Pipeline>; 2],
    emit: Arc<Pipeline>,
    points: ResidentReceivers,
    weights: DeviceBuffer,
    rounds: DeviceBuffer,
    emitters: Option<DeviceBuffer>,
    rotations: Option<DeviceBuffer>,
    bounces: usize,
    spheres: Vec<Emitter>,
    channels: usize,
    is_bound: bool,
}

/// Kernels of sample points: without reflections, and with them.
pub(super) struct Kernels<'a> {
    pub(super) bands: usize,
    pub(super) dark: &'a [(&'static str, f64)],
    pub(super) lit: &'a [(&'static str, f64)],
    /// Whether sample points find their cut, and own occlusion, in rows of two.
    pub(super) knows_own: bool,
}

impl DeviceFirstPass {
    pub(super) fn new(
        Bench { gpu, pipelines }: &Bench,
        kernels: &Kernels<'_>,
        baked: &BakedScene,
        arrays: &ReflectionArrays<'_>,
        frame: &Frame<'_>,
    ) -> Result<Self, GpuError> {
        let (points, emitters) = arrays.sample_points(frame);
        let mut spheres = Vec::new();
        let mut weights: Vec<f32> = Vec::new();
        let mut first_sample = 0;
        for (samples, of_sphere) in arrays.surfaces() {
            let samples = samples as u32;
            spheres.push(Emitter { first_sample, samples, weights: weights.len() as u32, rotation: 0 });
            weights.extend(of_sphere);
            first_sample += samples;
        }
        let bands = Some(kernels.bands);
        let cuts = baked.cut_of_emitters(&emitters);
        let group = |i: usize| match kernels.knows_own {
            true => 2 * i as u32,
            false => cuts.as_ref().map_or(0, |cuts| cuts[i]),
        };
        let points = ResidentReceivers::new(gpu, frame, points.view(), &group, 0)?;
        if points.parts() > 1 {
            return Err(GpuError::Refused("there are more sample points of spheres than a dispatch takes".into()));
        }
        Ok(Self {
            gpu: gpu.clone(),
            shade: [
                pipelines.get(gpu, &SH_EXP, bands, kernels.dark)?,
                pipelines.get(gpu, &SH_EXP, bands, kernels.lit)?,
            ],
            emit: pipelines.get(gpu, &SH_EXP_EMIT, bands, &[])?,
            points,
            weights: gpu.filled("colours of spheres", &weights)?,
            rounds: gpu.uniforms("settings of the first pass", size_of::<Rounds>() as u64)?,
            emitters: None,
            rotations: None,
            bounces: arrays.bounces,
            spheres,
            channels: 0,
            is_bound: false,
        })
    }

    /// Spheres that radiate.
    pub(super) fn sphere_count(&self) -> usize {
        self.spheres.len()
    }

    /// Brings everything up to a frame.
    pub(super) fn prepare(
        &mut self,
        arrays: &ReflectionArrays<'_>,
        of_frame: &FrameArrays<'_>,
        frame: &Frame<'_>,
        space: &KernelSpace,
    ) -> Result<(), GpuError> {
        let channels = of_frame.radiance_channels;
        let (rotations, numbers) = arrays.rotations(frame, of_frame.turns);
        let values: Vec<f32> = (rotations.iter())
            .flat_map(|rotation| (0..rotation.bands()).flat_map(|l| rotation.block(l).row_iter()))
            .flat_map(|row| row.iter().map(|&value| value as f32).collect::<Vec<_>>())
            .collect();
        let per_rotation = (values.len() / rotations.len().max(1)) as u32;
        for (sphere, number) in self.spheres.iter_mut().zip(numbers) {
            sphere.rotation = number * per_rotation;
        }
        let rounds = Rounds {
            channels: channels as u32,
            surface_channels: arrays.surface_channels as u32,
            used: arrays.radiance_coefficients as u32,
            samples: self.points.len() as u32,
        };
        let gpu = &self.gpu;
        gpu.queue.write_buffer(&self.rounds.buffer, 0, bytemuck::bytes_of(&rounds));
        let is_new = [
            gpu.write("rotations of spheres", &mut self.rotations, &values)?,
            gpu.write("spheres that radiate", &mut self.emitters, &self.spheres)?,
            self.points.place(gpu, frame, space)?,
            self.channels != channels,
        ];
        self.channels = channels;
        self.is_bound &= is_new == [false; 4];
        Ok(())
    }

    /// The passes of a frame, if they aren't those of the frame before; `radiance` is what spheres radiate. `is_new` says that
    /// the runner's buffers are others.
    pub(super) fn passes(&mut self, runner: &Runner, radiance: &DeviceBuffer, is_new: bool) -> Option<Vec<Pass>> {
        if self.is_bound && !is_new {
            return None;
        }
        let gpu = &self.gpu;
        let shade = self.shade.each_ref().map(|pipeline| {
            let (points, count) = self.points.bind(gpu, pipeline).into_iter().next()?;
            let bind_groups = vec![points, runner.bind_frame(pipeline)];
            Some(Pass { pipeline: pipeline.clone(), bind_groups, count })
        });
        let light = self.points.radiances().next();
        let emit =
            light.zip(self.emitters.as_ref()).zip(self.rotations.as_ref()).map(|((light, emitters), rotations)| {
                let buffers = [&self.rounds, emitters, &self.weights, rotations, light, radiance];
                let count = self.spheres.len() * self.channels * WORKGROUP as usize;
                Pass { pipeline: self.emit.clone(), bind_groups: vec![self.emit.bind(gpu, 0, &buffers)], count }
            });
        let rounds = (0..self.bounces).flat_map(|bounce| [shade[bounce.min(1)].clone(), emit.clone()]);
        self.is_bound = true;
        Some(rounds.flatten().collect())
    }

    pub(super) fn bytes(&self) -> usize {
        let others = [Some(&self.weights), Some(&self.rounds), self.emitters.as_ref(), self.rotations.as_ref()];
        self.points.bytes() + others.into_iter().flatten().map(DeviceBuffer::bytes).sum::<usize>()
    }
}
