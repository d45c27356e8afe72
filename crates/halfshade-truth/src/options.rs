//! Options of an estimate.

use crate::points::MAX_POINTS;
use halfshade_scene::spheres::AdjustRule;

/// Independently scrambled estimates per value.
pub const REPLICATES: usize = 16;

/// Most samples per receiver and technique.
pub const MAX_SAMPLES: usize = REPLICATES * MAX_POINTS;

/// Geometry that blocks.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash, Default)]
pub enum Geometry {
    /// The triangles of every object, receive-only objects too.
    #[default]
    Mesh,
    /// The sphere sets, each sphere adjusted to each receiver. Objects without spheres block nothing here, though their
    /// meshes do: a receiver that looks down onto a ground box sees it in the mesh reference only. That difference is
    /// part of the geometry error.
    Spheres(AdjustRule),
}

/// Whether anything blocks.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash, Default)]
pub enum Transport {
    /// Direct light with shadows.
    #[default]
    Shadowed,
    /// The same integrals with visibility 1: closed forms and deterministic quadrature, no samples, no standard error.
    /// Those over the lobes of glossy receivers, and over the surfaces of translucent ones, are sampled.
    Unshadowed,
}

/// Options of an estimate.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Options {
    /// Geometry that blocks.
    pub geometry: Geometry,
    /// Whether anything blocks.
    pub transport: Transport,
    /// Samples per receiver and technique (one technique for constant light, two for a map, one more for a sun and for
    /// each local light, two for a local light that is wide; at most two more for each light at glossy receivers).
    /// Rounded up to a multiple of [`REPLICATES`]; powers of two from 64 on use the points best. At most
    /// [`MAX_SAMPLES`]. With a noise target, where to start.
    pub samples: usize,
    /// Go on until [`crate::Estimate::relative_rms_standard_error`] is at most this, or `max_samples` are used up.
    pub noise_target: Option<f64>,
    /// Bounces on top of direct light, see [`crate`]: 0 is direct light alone. As many paths as samples.
    pub bounces: usize,
    /// Most samples per receiver and technique that a noise target may take.
    pub max_samples: usize,
    /// The same seed gives the same bits, on one thread or many, however receivers are split into batches (as long as
    /// no noise target looks at all of them).
    pub seed: u64,
}

impl Default for Options {
    fn default() -> Self {
        Self {
            geometry: Geometry::Mesh,
            transport: Transport::Shadowed,
            samples: 1024,
            noise_target: None,
            bounces: 0,
            max_samples: MAX_SAMPLES,
            seed: 0,
        }
    }
}
