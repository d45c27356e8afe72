//! Inner loops: arrays and numbers in, numbers out, eight receivers side by side.
//!
//! Receivers are in light space, as the spheres that block are: turned like the environment, about an origin of the
//! frame's. Visibility is an SH vector per receiver, [`halfshade_sh::kernel::ShBatch`].

pub(crate) mod blocker;
pub(crate) mod gather;
pub(crate) mod ground;
pub(crate) mod lamps;
pub(crate) mod light;
pub(crate) mod log_sum;
pub(crate) mod own;
pub(crate) mod product;
pub(crate) mod shares;
pub(crate) mod sun;
pub(crate) mod traced;

pub(crate) use blocker::{Blocker, Blockers, OwnSpheres, Receivers8};

use halfshade_sh::kernel::ShBatch;
use wide::f32x8;

/// `a · b` of eight vectors with one that they share, coefficient by coefficient from the first.
#[inline(always)]
fn dot_shared<const N: usize>(a: &ShBatch<N>, b: &[f32]) -> f32x8 {
    a.iter().zip(b).fold(f32x8::ZERO, |sum, (a, &b)| a.mul_add(f32x8::splat(b), sum))
}
