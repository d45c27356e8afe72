//! A batch of light samples at one receiver, as a structure of arrays.

/// Samples per batch: whole vector registers, and small enough for the nearest cache.
pub(crate) const BATCH: usize = 64;

/// Directions, how far their rays reach, and what arrives if nothing is in the way.
#[derive(Debug)]
#[repr(align(64))]
pub(crate) struct Batch {
    /// Number of samples in use.
    pub(crate) len: usize,
    /// Unit directions in world space: x, y, z.
    pub(crate) direction: [[f32; BATCH]; 3],
    /// Length of the ray in tracing space: beyond it nothing blocks. Infinite for distant light.
    pub(crate) distance: [f32; BATCH],
    /// Radiance times cosine over density, per channel: the sample's estimate of unshadowed irradiance. 0 past the last
    /// sample in use.
    pub(crate) value: [[f32; BATCH]; 3],
    /// 1 where the light is seen, 0 where it is blocked.
    pub(crate) visible: [f32; BATCH],
}

impl Batch {
    pub(crate) fn new() -> Self {
        Self {
            len: 0,
            direction: [[0.0; BATCH]; 3],
            distance: [f32::INFINITY; BATCH],
            value: [[0.0; BATCH]; 3],
            visible: [0.0; BATCH],
        }
    }

    #[inline(always)]
    pub(crate) fn set_direction(&mut self, k: usize, direction: [f32; 3]) {
        for (row, component) in self.direction.iter_mut().zip(direction) {
            row[k] = component;
        }
    }

    #[inline(always)]
    pub(crate) fn set_value(&mut self, k: usize, value: [f32; 3]) {
        for (row, component) in self.value.iter_mut().zip(value) {
            row[k] = component;
        }
    }

    /// Puts out the samples that are not in use.
    pub(crate) fn clear_rest(&mut self) {
        for channel in &mut self.value {
            channel[self.len..].fill(0.0);
        }
    }

    /// Whether sample `k` carries any light.
    #[inline(always)]
    pub(crate) fn carries_light(&self, k: usize) -> bool {
        self.value[0][k] != 0.0 || self.value[1][k] != 0.0 || self.value[2][k] != 0.0
    }
}
