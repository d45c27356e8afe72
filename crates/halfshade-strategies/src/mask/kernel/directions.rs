//! Directions, each of which stands for a cell of all directions, and how far caps close them.
//!
//! A cap of angular radius θ about unit a hides of the cell about ω, as if the cap's edge were straight there,
//!
//! ```text
//! h = clamp(o + (ω·a - cos θ) / (w r sin θ), 0, 1)
//! ```
//!
//! with r the radius of a disc of the cell's solid angle, w the setting `edge`, and o = 1/2. Where θ < w r the edge closes
//! before it opens: with q = θ/(w r), o = √q - q/2 makes the integral of h over all ω that of the cap, π θ² for small θ. Where
//! several caps reach into a cell, the one that closes most of it counts.

use super::cap::Cap;
use wide::f32x8;

/// Directions that are looked into together: they fit the registers of a processor.
pub(crate) const BLOCK: usize = 8;

/// Eight directions.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Directions8 {
    /// Unit; 0 in lanes that fill up.
    pub(crate) direction: [f32x8; 3],
    /// 1 over the width of an edge in radians.
    pub(crate) sharpness: f32x8,
}

/// The directions of receivers with about the same normal, in whole blocks.
#[derive(Debug, Clone)]
pub(crate) struct DirectionSet {
    /// Eight by eight.
    pub(crate) directions: Vec<Directions8>,
    /// Radiance times the solid angle of each one's cell, by channel.
    pub(crate) weights: [Vec<f32x8>; 3],
    /// Mean of the sharpness.
    pub(crate) mean_sharpness: f32,
}

/// Takes from what is open of directions what a cap closes; what is left may be less than nothing.
#[inline(always)]
pub(crate) fn close(open: &mut [f32x8; BLOCK], directions: &[Directions8; BLOCK], cap: &Cap) {
    let [x, y, z] = cap.axis.map(f32x8::splat);
    let (cotangent, rest) = (f32x8::splat(-cap.cotangent), f32x8::splat(1.0 - cap.offset));
    for (open, Directions8 { direction, sharpness }) in open.iter_mut().zip(directions) {
        let inside = direction[0].mul_add(x, direction[1].mul_add(y, direction[2].mul_add(z, cotangent)));
        *open = open.fast_min(inside.mul_neg_add(*sharpness, rest));
    }
}

/// Adds up directions: light that is left, and all light, by channel.
#[derive(Debug, Clone, Copy, Default)]
pub(crate) struct Sums {
    pub(crate) seen: [f32x8; 3],
    pub(crate) all: [f32x8; 3],
}

impl Sums {
    /// The share that is seen by channel; 1 where no direction carries light.
    #[inline(always)]
    pub(crate) fn shares(&self) -> [f32; 3] {
        std::array::from_fn(|channel| {
            let (seen, all) = (self.seen[channel].reduce_add(), self.all[channel].reduce_add());
            if all > 0.0 { (seen / all).min(1.0) } else { 1.0 }
        })
    }
}
