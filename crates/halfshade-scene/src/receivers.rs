//! Receivers: the points whose outgoing radiance is asked for, as structures of arrays.

use crate::Frame;
use glam::Vec3;
use std::ops::Range;

/// Owned receivers, one array per component.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct ReceiverBuffer {
    /// Positions in world space: x, y, z.
    pub position: [Vec<f32>; 3],
    /// Unit normals in world space: x, y, z.
    pub normal: [Vec<f32>; 3],
    /// Albedo: red, green, blue.
    pub albedo: [Vec<f32>; 3],
    /// The object each receiver lies on.
    pub object: Vec<u32>,
    /// A number that is stable within the scene: for a vertex receiver its vertex, counted over all objects.
    pub index: Vec<u32>,
}

/// A borrowed batch of receivers; every slice has the same length.
#[derive(Debug, Clone, Copy)]
pub struct Receivers<'a> {
    /// Positions in world space: x, y, z.
    pub position: [&'a [f32]; 3],
    /// Unit normals in world space: x, y, z.
    pub normal: [&'a [f32]; 3],
    /// Albedo: red, green, blue.
    pub albedo: [&'a [f32]; 3],
    /// The object each receiver lies on.
    pub object: &'a [u32],
    /// Stable numbers.
    pub index: &'a [u32],
}

impl ReceiverBuffer {
    /// Every vertex of every object, in world space at `frame`.
    pub fn vertices(frame: &Frame<'_>) -> Self {
        let mut buffer = Self::default();
        for (number, (object, pose)) in frame.scene.objects.iter().zip(&frame.world_from_object).enumerate() {
            let mesh = &object.mesh;
            for (vertex, (&position, &normal)) in mesh.positions.iter().zip(&mesh.normals).enumerate() {
                let albedo = object.material.albedo * mesh.colors.get(vertex).copied().unwrap_or(Vec3::ONE);
                buffer.push(pose.transform_point(position), pose.transform_direction(normal), albedo, number as u32);
            }
        }
        buffer
    }

    /// Adds one receiver; its stable number is its place.
    pub fn push(&mut self, position: Vec3, normal: Vec3, albedo: Vec3, object: u32) {
        self.index.push(self.object.len() as u32);
        self.object.push(object);
        for axis in 0..3 {
            self.position[axis].push(position[axis]);
            self.normal[axis].push(normal[axis]);
            self.albedo[axis].push(albedo[axis]);
        }
    }

    /// How many there are.
    pub fn len(&self) -> usize {
        self.object.len()
    }

    /// Whether there are none.
    pub fn is_empty(&self) -> bool {
        self.object.is_empty()
    }

    /// All of them, borrowed.
    pub fn view(&self) -> Receivers<'_> {
        Receivers {
            position: self.position.each_ref().map(Vec::as_slice),
            normal: self.normal.each_ref().map(Vec::as_slice),
            albedo: self.albedo.each_ref().map(Vec::as_slice),
            object: &self.object,
            index: &self.index,
        }
    }
}

impl<'a> Receivers<'a> {
    /// How many there are.
    pub fn len(&self) -> usize {
        self.object.len()
    }

    /// Whether there are none.
    pub fn is_empty(&self) -> bool {
        self.object.is_empty()
    }

    /// A part of the batch.
    pub fn slice(&self, range: Range<usize>) -> Self {
        Self {
            position: self.position.map(|axis| &axis[range.clone()]),
            normal: self.normal.map(|axis| &axis[range.clone()]),
            albedo: self.albedo.map(|channel| &channel[range.clone()]),
            object: &self.object[range.clone()],
            index: &self.index[range],
        }
    }

    /// Position of receiver `i` in world space.
    pub fn position_at(&self, i: usize) -> Vec3 {
        Vec3::from(self.position.map(|axis| axis[i]))
    }

    /// Unit normal of receiver `i` in world space.
    pub fn normal_at(&self, i: usize) -> Vec3 {
        Vec3::from(self.normal.map(|axis| axis[i]))
    }

    /// Albedo of receiver `i`.
    pub fn albedo_at(&self, i: usize) -> Vec3 {
        Vec3::from(self.albedo.map(|channel| channel[i]))
    }
}

/// Owned outgoing radiance, one array per channel.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct RadianceBuffer {
    /// Red, green, blue.
    pub channels: [Vec<f32>; 3],
}

/// Borrowed outgoing radiance to write; every slice has the receivers' length.
#[derive(Debug)]
pub struct RadianceMut<'a> {
    /// Red, green, blue.
    pub channels: [&'a mut [f32]; 3],
}

impl RadianceBuffer {
    /// Black, for `len` receivers.
    pub fn zeros(len: usize) -> Self {
        Self { channels: std::array::from_fn(|_| vec![0.0; len]) }
    }

    /// How many receivers it is for.
    pub fn len(&self) -> usize {
        self.channels[0].len()
    }

    /// Whether it is for none.
    pub fn is_empty(&self) -> bool {
        self.channels[0].is_empty()
    }

    /// All of it, to write.
    pub fn view_mut(&mut self) -> RadianceMut<'_> {
        RadianceMut { channels: self.channels.each_mut().map(Vec::as_mut_slice) }
    }

    /// Radiance of receiver `i`.
    pub fn at(&self, i: usize) -> Vec3 {
        Vec3::from(self.channels.each_ref().map(|channel| channel[i]))
    }
}

impl<'a> RadianceMut<'a> {
    /// How many receivers it is for.
    pub fn len(&self) -> usize {
        self.channels[0].len()
    }

    /// Whether it is for none.
    pub fn is_empty(&self) -> bool {
        self.channels[0].is_empty()
    }

    /// Two parts: the first `mid` receivers, and the rest.
    pub fn split_at(self, mid: usize) -> (Self, Self) {
        let [r, g, b] = self.channels;
        let ((r0, r1), (g0, g1), (b0, b1)) = (r.split_at_mut(mid), g.split_at_mut(mid), b.split_at_mut(mid));
        (Self { channels: [r0, g0, b0] }, Self { channels: [r1, g1, b1] })
    }

    /// Sets the radiance of receiver `i`.
    pub fn set(&mut self, i: usize, radiance: Vec3) {
        for (channel, value) in self.channels.iter_mut().zip(radiance.to_array()) {
            channel[i] = value;
        }
    }
}
