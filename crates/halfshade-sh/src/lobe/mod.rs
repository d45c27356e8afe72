//! Cosine lobes, `c(v) = s·max(a·v, 0)^e`: products, integrals, and the lobe that stands for a cap [Meunier2009, 4 and
//! 5.2].
//!
//! [`Lobe`] with [`product`], [`product_integral`] and [`cap_lobe`] is the f64 reference, a quadrature per call.
//! [`Lobe8`] with [`LobeTable`] and [`CapLobeTable`] is what runs per receiver: reflectance times light by
//! [`LobeTable::product8`], then with every visibility lobe [`LobeTable::product_integral8`], skipped where
//! [`Lobe8::product_bound`] is below a threshold. [`LobeSum`] is light from infinitely far as lobes.
//!
//! `examples/lobe_accuracy.rs` prints the errors of each rule over the samples of [Meunier2009, 4.1], and those of
//! chains: reflectance times light times blocker, as a fraction of the unshadowed. Errors of the integral are the
//! table's interpolation alone for the two rules that keep it.

pub mod accuracy;
mod batch;
mod cap_lobe;
mod cap_lobe_table;
mod fit;
mod nonnegative;
mod pair;
mod plane;
mod product;
mod radiance;
mod table;

pub use batch::Lobe8;
pub use cap_lobe::{CapFit, cap_distance, cap_lobe};
pub use cap_lobe_table::CapLobeTable;
pub use product::{ProductRule, product, product_bound, product_integral};
pub use radiance::{ColoredLobe, LobeSum};
pub use table::LobeTable;

use std::f64::consts::TAU;

/// Exponents are clamped to this.
///
/// [Meunier2009, 4.1] ends its table at 1e5. Nothing here needs an end; this one is where the rounding of an axis to
/// f32 is a part in 5000 of the lobe's width `1/sqrt(e)`.
pub const MAX_EXPONENT: f64 = 1e7;

/// `s·max(a·v, 0)^e` [Meunier2009, eq. 4]. With e = 0 it is s on the hemisphere about the axis, the limit of small e.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Lobe {
    /// a, of unit length; functions divide by another length.
    pub axis: [f64; 3],
    /// e, the *thickness* of the paper, clamped to [0, [`MAX_EXPONENT`]].
    pub exponent: f64,
    /// s, the value on the axis, of any sign.
    pub scale: f64,
}

impl Lobe {
    /// The value in a unit direction.
    pub fn value(&self, direction: [f64; 3]) -> f64 {
        let axis = pair::unit(self.axis);
        let cosine = crate::basis::dot(&axis, &direction);
        if cosine > 0.0 { self.scale * cosine.powf(finite_exponent(self.exponent)) } else { 0.0 }
    }

    /// `∫ c dω = 2π s/(e+1)`, exactly, in steradians times the unit of the scale: [Meunier2009, 4.2] tabulates it.
    pub fn integral(&self) -> f64 {
        self.scale * TAU / (finite_exponent(self.exponent) + 1.0)
    }
}

/// An exponent in [0, [`MAX_EXPONENT`]]; NaN counts as 0.
fn finite_exponent(exponent: f64) -> f64 {
    // Not `clamp`, which keeps NaN.
    if exponent > 0.0 { exponent.min(MAX_EXPONENT) } else { 0.0 }
}
