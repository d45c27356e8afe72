//! The kernels in WGSL, for graphics hardware: one receiver per invocation.
//!
//! They come from the generator that writes the Rust of [`crate::kernel`], out of the same coefficients, and do the same
//! operations in the same order; compilers of shaders may fuse multiplications with additions or not.

/// Most bands that there are WGSL kernels for.
pub const MAX_WGSL_BANDS: usize = 6;

/// The text of a file per number of bands.
macro_rules! generated {
    ($bands:expr, $stem:literal) => {
        match $bands {
            1 => Some(include_str!(concat!(env!("OUT_DIR"), "/", $stem, "1.wgsl"))),
            2 => Some(include_str!(concat!(env!("OUT_DIR"), "/", $stem, "2.wgsl"))),
            3 => Some(include_str!(concat!(env!("OUT_DIR"), "/", $stem, "3.wgsl"))),
            4 => Some(include_str!(concat!(env!("OUT_DIR"), "/", $stem, "4.wgsl"))),
            5 => Some(include_str!(concat!(env!("OUT_DIR"), "/", $stem, "5.wgsl"))),
            6 => Some(include_str!(concat!(env!("OUT_DIR"), "/", $stem, "6.wgsl"))),
            _ => None,
        }
    };
}

/// The WGSL module for a number of bands, or `None` if there is none.
///
/// It declares `SH_BANDS` and `SH_COUNT`, the vector `Sh` of so many coefficients `h0`, `h1`, .., `ShBands` of one number per band, and
/// `sh_basis(direction)`, `sh_add_lobe(direction, scale, sum)`, `sh_product(f, g)`, `sh_square(f)` as in [`crate::kernel`];
/// `sh_times_bands(f, factors)`, `sh_scaled(f, factor)`, `sh_plus(f, g)`, `sh_mix(f, g, weight)`, `sh_scaled_plus(f, factor, g)`,
/// coefficient by coefficient; `sh_dot(f, g)`, and `sh_isolated_energy(f)`, the squares of all coefficients but the first;
/// `sh_parts(f)` and `sh_of_parts(parts)`, the vector as `SH_PARTS` rows of four, filled up with zeros; and `sh_bands(low,
/// high)`, of eight numbers those of the bands there are.
pub fn kernels(bands: usize) -> Option<&'static str> {
    generated!(bands, "sh_")
}

/// The function `sh_rotated(f, first)` that turns vectors of so many bands, for modules that have [`kernels`] and
/// `sh_rotation_part(row: u32) -> vec4f`: there, from row `first` on, `SH_ROTATION_PARTS` rows of four hold the blocks of the
/// rotation, band by band and row by row, filled up with zeros.
pub fn rotation(bands: usize) -> Option<&'static str> {
    generated!(bands, "sh_rotation_")
}
