//! f32 kernels over batches of eight: what runs per receiver.
//!
//! Coefficient counts are const generics here (`N = bands²` for 1 to 8 bands); [`dispatch_bands!`](crate::dispatch_bands)
//! gets there from a runtime number of bands. Every lane's result depends on that lane's input alone, so that results
//! have the same bits however receivers are grouped.

mod exponential;
mod exposed_shares;
mod lane;
mod straight_line;
mod table;

pub use exponential::{BatchExponential, ExponentialParts, FULL, dot, limit_to_visibility};
pub use exposed_shares::{ExposedShares, SphericalCap8};
pub use lane::Lane;
pub use straight_line::{accumulate_lobe, basis, product, product_one, square, square_one, times_bands};

use wide::f32x8;

/// Lanes of a batch.
pub const LANES: usize = 8;

/// Most bands that the kernels support.
pub const MAX_BANDS: usize = 8;

/// Eight SH vectors of `N` coefficients, coefficient by coefficient.
pub type ShBatch<const N: usize> = [f32x8; N];

/// Runs an expression with a constant `N`, the number of coefficients of a runtime number of bands from 1 to 8:
/// `dispatch_bands!(bands, N => shade::<N>(..))`. Evaluates to `None` for any other number, else to `Some`.
#[macro_export]
macro_rules! dispatch_bands {
    ($bands:expr, $n:ident => $body:expr) => {
        match $bands {
            1 => {
                const $n: usize = 1;
                Some($body)
            }
            2 => {
                const $n: usize = 4;
                Some($body)
            }
            3 => {
                const $n: usize = 9;
                Some($body)
            }
            4 => {
                const $n: usize = 16;
                Some($body)
            }
            5 => {
                const $n: usize = 25;
                Some($body)
            }
            6 => {
                const $n: usize = 36;
                Some($body)
            }
            7 => {
                const $n: usize = 49;
                Some($body)
            }
            8 => {
                const $n: usize = 64;
                Some($body)
            }
            _ => None,
        }
    };
}

#[cfg(test)]
mod tests;
