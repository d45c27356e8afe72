//! Receivers on the device: their places on their objects go up once, the objects' places with every frame.

use crate::{
    Gpu, GpuError,
    device::DeviceBuffer,
    pipeline::{MOST_RECEIVERS, Pipeline},
};
use bytemuck::{Pod, Zeroable};
use glam::{DMat3, DVec3, Vec3};
use halfshade_rays::origin_between;
use halfshade_scene::{Frame, RadianceMut, Receivers, SurfacePoint};
use std::{
    ops::Range,
    sync::{Mutex, PoisonError},
};

/// Where an object is, as `common/receivers.wgsl` reads it: rows of the map to the space of the light.
#[repr(C)]
#[derive(Debug, Clone, Copy, Pod, Zeroable)]
pub(crate) struct Placement {
    pub(crate) position: [[f32; 4]; 3],
    pub(crate) direction: [[f32; 4]; 3],
}

/// The space that kernels work in, from world space: `scale · rotation · (point - center)`.
#[derive(Debug, Clone, Copy)]
pub(crate) struct KernelSpace {
    pub(crate) rotation: DMat3,
    pub(crate) center: DVec3,
    /// A power of two that brings lengths near 1: on graphics hardware small squares are 0.
    pub(crate) scale: f64,
}

/// All receivers of the frames to come.
#[derive(Debug, Default)]
pub(crate) struct ResidentReceivers {
    parts: Vec<Part>,
    count: usize,
    placements: Option<DeviceBuffer>,
    staging: Mutex<Option<DeviceBuffer>>,
    /// Receivers on objects that change their shape, whose places go up with every frame.
    deforming: Option<Deforming>,
}

/// Bytes of a binding, as WebGPU has them by default.
const MOST_BYTES: usize = 128 << 20;

/// As many receivers as one dispatch takes.
#[derive(Debug)]
struct Part {
    first: usize,
    count: usize,
    places: DeviceBuffer,
    albedos: DeviceBuffer,
    radiances: DeviceBuffer,
}

#[derive(Debug)]
struct Deforming {
    object: Vec<u32>,
    surface: Vec<SurfacePoint>,
    group: Vec<u32>,
    rest: Vec<[Vec3; 2]>,
}

impl KernelSpace {
    /// A similarity that isn't turned and not moved far.
    pub(crate) fn around(center: DVec3, rotation: DMat3, extent: f64) -> Self {
        let scale = if extent > 0.0 && extent.is_finite() { extent.log2().round().exp2().recip() } else { 1.0 };
        Self { rotation, center, scale }
    }

    /// Around some points.
    pub(crate) fn of_points(points: impl Iterator<Item = DVec3>, rotation: DMat3) -> Self {
        let corners = points.filter(|point| point.is_finite()).fold(None, |corners: Option<(DVec3, DVec3)>, point| {
            Some(corners.map_or((point, point), |(low, high)| (low.min(point), high.max(point))))
        });
        let (low, high) = corners.unwrap_or_default();
        let center = origin_between(low, high);
        Self::around(center, rotation, (high - center).max(center - low).max_element())
    }

    /// A point of world space.
    pub(crate) fn place(&self, point: DVec3) -> DVec3 {
        self.scale * (self.rotation * (point - self.center))
    }

    /// A sphere of world space: centre and radius.
    pub(crate) fn place_sphere(&self, center: Vec3, radius: f32) -> [f32; 4] {
        self.place(center.as_dvec3()).extend(self.scale * f64::from(radius)).as_vec4().to_array()
    }

    /// Placements of all objects of a frame.
    fn placements(&self, frame: &Frame<'_>) -> Vec<Placement> {
        let of_object = |pose: &halfshade_scene::Pose| {
            let direction = self.rotation * DMat3::from_quat(pose.rotation.as_dquat());
            let position = direction * (f64::from(pose.scale) * self.scale);
            let offset = self.place(pose.translation.as_dvec3());
            Placement { position: affine_rows(position, offset), direction: affine_rows(direction, DVec3::ZERO) }
        };
        // Last a place for what lies on no object.
        frame.world_from_object.iter().chain([&halfshade_scene::Pose::IDENTITY]).map(of_object).collect()
    }
}

/// Rows of `matrix · point + offset`, as kernels read them.
pub(crate) fn affine_rows(matrix: DMat3, offset: DVec3) -> [[f32; 4]; 3] {
    std::array::from_fn(|k| matrix.row(k).extend(offset[k]).as_vec4().to_array())
}

impl ResidentReceivers {
    /// Puts receivers of `frame` on the device; `group` is a number per receiver that kernels get with it, `kept` how many
    /// vectors of each they keep beside its radiance.
    pub(crate) fn new(
        gpu: &Gpu,
        frame: &Frame<'_>,
        receivers: Receivers<'_>,
        group: &dyn Fn(usize) -> u32,
        kept: usize,
    ) -> Result<Self, GpuError> {
        let count = receivers.len();
        let rest: Vec<[Vec3; 2]> = (0..count).map(|i| at_rest(frame, receivers, i)).collect();
        let groups: Vec<u32> = (0..count).map(group).collect();
        let none = frame.world_from_object.len() as u32;
        let objects: Vec<u32> = receivers.object.iter().map(|&object| object.min(none)).collect();
        let mut parts = Vec::new();
        // No more of what is written than a binding may have.
        let most = MOST_RECEIVERS.min(MOST_BYTES / (12 * (1 + kept)));
        for first in (0..count).step_by(most) {
            let range = first..(first + most).min(count);
            let places = places(&rest[range.clone()], &objects[range.clone()], &groups[range.clone()]);
            let mut albedos: Vec<f32> =
                receivers.albedo.iter().flat_map(|channel| &channel[range.clone()]).copied().collect();
            if frame.scene.is_glossy() {
                albedos.extend(gloss_factors(receivers, range.clone()));
            }
            parts.push(Part {
                first,
                count: range.len(),
                places: gpu.filled("places of receivers", &places)?,
                albedos: gpu.filled("albedos of receivers", &albedos)?,
                radiances: gpu.buffer("radiances", (1 + kept) as u64 * 12 * range.len() as u64)?,
            });
            // Data that is written is held twice until it is submitted.
            gpu.queue.submit([]);
        }
        let deforms = frame.scene.objects.iter().any(|object| object.skin.is_some());
        let deforming =
            deforms.then(|| Deforming { object: objects, surface: receivers.surface.to_vec(), group: groups, rest });
        Ok(Self { parts, count, placements: None, staging: Mutex::default(), deforming })
    }

    pub(crate) fn len(&self) -> usize {
        self.count
    }

    /// Dispatches that all of them take.
    pub(crate) fn parts(&self) -> usize {
        self.parts.len()
    }

    /// The receivers of each dispatch.
    pub(crate) fn ranges(&self) -> impl Iterator<Item = Range<usize>> {
        self.parts.iter().map(|part| part.first..part.first + part.count)
    }

    /// Outgoing radiance of every part, channel by channel.
    pub(crate) fn radiances(&self) -> impl Iterator<Item = &DeviceBuffer> {
        self.parts.iter().map(|part| &part.radiances)
    }

    /// Brings the objects' places up to `frame`. True if bindings are to be made again.
    pub(crate) fn place(&mut self, gpu: &Gpu, frame: &Frame<'_>, space: &KernelSpace) -> Result<bool, GpuError> {
        if let Some(deforming) = &mut self.deforming {
            deforming.follow(frame);
            for part in &self.parts {
                let range = part.first..part.first + part.count;
                let Deforming { rest, object, group, .. } = &*deforming;
                let places = places(&rest[range.clone()], &object[range.clone()], &group[range]);
                gpu.queue.write_buffer(&part.places.buffer, 0, bytemuck::cast_slice(&places));
            }
        }
        gpu.write("placements of objects", &mut self.placements, &space.placements(frame))
    }

    /// Bindings of group 0 for every part, and how many receivers it has.
    pub(crate) fn bind(&self, gpu: &Gpu, pipeline: &Pipeline) -> Vec<(wgpu::BindGroup, usize)> {
        let Some(placements) = &self.placements else { return Vec::new() };
        let bind = |part: &Part| {
            let buffers = [&part.places, &part.albedos, placements, &part.radiances];
            (pipeline.bind(gpu, 0, &buffers), part.count)
        };
        self.parts.iter().map(bind).collect()
    }

    /// Copies radiance back.
    pub(crate) fn read_back(&self, gpu: &Gpu, out: &mut RadianceMut<'_>) -> Result<(), GpuError> {
        let mut slot = self.staging.lock().unwrap_or_else(PoisonError::into_inner);
        for part in &self.parts {
            let bytes = 12 * part.count as u64;
            if slot.as_ref().is_none_or(|staging| (staging.bytes() as u64) < bytes) {
                *slot = Some(gpu.staging("radiances", bytes)?);
            }
            let Some(staging) = slot.as_ref() else { continue };
            gpu.read_copy(&part.radiances, staging, bytes, |bytes| {
                let values: &[f32] = bytemuck::cast_slice(bytes);
                for (channel, values) in out.channels.iter_mut().zip(values.chunks_exact(part.count)) {
                    channel[part.first..part.first + part.count].copy_from_slice(values);
                }
            })?;
        }
        Ok(())
    }

    pub(crate) fn bytes(&self) -> usize {
        let of_part = |part: &Part| [&part.places, &part.albedos, &part.radiances].map(DeviceBuffer::bytes);
        let parts: usize = self.parts.iter().flat_map(of_part).sum();
        parts + self.placements.as_ref().map_or(0, DeviceBuffer::bytes)
    }
}

impl Deforming {
    /// Where the receivers on objects that have left their rest are, in their objects' space.
    fn follow(&mut self, frame: &Frame<'_>) {
        for (i, place) in self.rest.iter_mut().enumerate() {
            let object = self.object[i] as usize;
            let Some(object_at_rest) = frame.scene.objects.get(object).filter(|object| object.skin.is_some()) else {
                continue;
            };
            let mesh = &object_at_rest.mesh;
            let Some(weights) = self.surface[i].weights(mesh) else { continue };
            let (positions, normals) = match frame.deformed.get(object).and_then(Option::as_deref) {
                Some(deformed) => (&deformed.positions, &deformed.normals),
                None => (&mesh.positions, &mesh.normals),
            };
            let behind = matches!(self.surface[i], SurfacePoint::Triangle { from_behind: true, .. });
            let mixed = |values: &[Vec3]| weights.parts().map(|(vertex, weight)| weight * values[vertex]).sum::<Vec3>();
            let normal = mixed(normals).normalize_or_zero();
            *place = [mixed(positions), if behind { -normal } else { normal }];
        }
    }
}

/// Factors of gloss, channel by channel of the specular scale, then of the exponent.
fn gloss_factors(receivers: Receivers<'_>, range: Range<usize>) -> Vec<f32> {
    let glosses: Vec<[f32; 4]> =
        range.map(|i| receivers.gloss_at(i)).map(|gloss| gloss.specular.extend(gloss.exponent).to_array()).collect();
    (0..4).flat_map(|factor| glosses.iter().map(move |gloss| gloss[factor])).collect()
}

/// Position and normal of a receiver in its object's space.
fn at_rest(frame: &Frame<'_>, receivers: Receivers<'_>, i: usize) -> [Vec3; 2] {
    let object = receivers.object[i] as usize;
    let (position, normal) = (receivers.position_at(i), receivers.normal_at(i));
    let Some(pose) = frame.world_from_object.get(object) else { return [position, normal] };
    if let SurfacePoint::Vertex(vertex) = receivers.surface[i]
        && let Some(known) = frame.scene.objects.get(object)
        && known.skin.is_none()
        && let Some((&position, &normal)) =
            known.mesh.positions.get(vertex as usize).zip(known.mesh.normals.get(vertex as usize))
    {
        return [position, normal];
    }
    let back = pose.rotation.as_dquat().conjugate();
    let position = back * (position.as_dvec3() - pose.translation.as_dvec3()) / f64::from(pose.scale);
    [position.as_vec3(), (back * normal.as_dvec3()).as_vec3()]
}

/// A receiver in its object's space, as `common/receivers.wgsl` reads it.
#[repr(C)]
#[derive(Debug, Clone, Copy, Pod, Zeroable)]
pub(crate) struct Place {
    pub(crate) position: [f32; 3],
    pub(crate) object: u32,
    pub(crate) normal: [f32; 3],
    pub(crate) group: u32,
}

/// Receivers as kernels read them.
fn places(rest: &[[Vec3; 2]], object: &[u32], group: &[u32]) -> Vec<Place> {
    let place = |((&[position, normal], &object), &group): ((&[Vec3; 2], &u32), &u32)| Place {
        position: position.to_array(),
        object,
        normal: normal.to_array(),
        group,
    };
    rest.iter().zip(object).zip(group).map(place).collect()
}
