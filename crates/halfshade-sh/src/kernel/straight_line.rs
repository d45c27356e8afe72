//! Basis, lobes, product and square as straight-line code, written by the build script from the exact coefficients.

use super::{Lane, ShBatch};
use wide::f32x8;

/// The basis functions of `N = bands²` coefficients along unit `[x, y, z]`, without trigonometry.
///
/// As [`crate::basis::evaluate`], within 1e-6 of the largest value in f32.
///
/// # Panics
/// If `N` is not the square of 1 to 8; the same holds for every function here.
#[inline(always)]
pub fn basis<L: Lane, const N: usize>(direction: [L; 3]) -> [L; N] {
    generated::basis(direction)
}

/// Each band of a vector times that band's factor, of which there is at least one per band.
#[inline(always)]
pub fn times_bands<const N: usize, F: Copy + Into<f32x8>>(vector: &ShBatch<N>, factors: &[F]) -> ShBatch<N> {
    let mut product = *vector;
    for l in 0..const { N.isqrt() } {
        let factor: f32x8 = factors[l].into();
        product[l * l..(l + 1) * (l + 1)].iter_mut().for_each(|value| *value *= factor);
    }
    product
}

/// Adds a zonal function turned to unit `direction` to `sum`: `sum_i += scale_l y_i(direction)`
/// [Guerrero2007, eq. 3.17]; `scale` holds `sqrt(4π/(2l+1)) g_l`, at least one per band.
#[inline(always)]
pub fn accumulate_lobe<L: Lane, const N: usize>(direction: [L; 3], scale: &[L], sum: &mut [L; N]) {
    generated::accumulate(direction, scale, sum);
}

/// The SH product of eight pairs [Guerrero2007, eq. 3.19].
#[inline(never)]
fn product_batch(f: &[f32x8], g: &[f32x8], out: &mut [f32x8]) {
    generated::product(f, g, out);
}

#[inline(never)]
fn square_batch(f: &[f32x8], out: &mut [f32x8]) {
    generated::square(f, out);
}

#[inline(never)]
fn product_scalar(f: &[f32], g: &[f32], out: &mut [f32]) {
    generated::product(f, g, out);
}

#[inline(never)]
fn square_scalar(f: &[f32], out: &mut [f32]) {
    generated::square(f, out);
}

/// The SH product `(f*g)_i = Σ_jk Γ_ijk f_j g_k` of eight pairs [Guerrero2007, eq. 3.19].
///
/// Relative error below 1e-6 of `|f|·|g|` against [`crate::product::product`].
#[inline]
pub fn product<const N: usize>(f: &ShBatch<N>, g: &ShBatch<N>) -> ShBatch<N> {
    let mut out = [f32x8::ZERO; N];
    product_batch(f, g, &mut out);
    out
}

/// `f*f` of eight vectors, with a little over half the operations of [`product`].
#[inline]
pub fn square<const N: usize>(f: &ShBatch<N>) -> ShBatch<N> {
    let mut out = [f32x8::ZERO; N];
    square_batch(f, &mut out);
    out
}

/// [`product`] for one pair.
#[inline]
pub fn product_one<const N: usize>(f: &[f32; N], g: &[f32; N]) -> [f32; N] {
    let mut out = [0.0; N];
    product_scalar(f, g, &mut out);
    out
}

/// [`square`] for one vector.
#[inline]
pub fn square_one<const N: usize>(f: &[f32; N]) -> [f32; N] {
    let mut out = [0.0; N];
    square_scalar(f, &mut out);
    out
}

mod generated {
    use super::Lane;
    use crate::kernel::table::{Group, product_by_table, square_by_table};

    // The products are instantiated for f32 and f32x8 here, once, and not in every crate that calls them.
    include!(concat!(env!("OUT_DIR"), "/kernels.rs"));

    macro_rules! basis_entry_points {
        ($($count:literal $basis:ident $accumulate:ident)*) => {
            #[inline(always)]
            pub(super) fn basis<L: Lane, const N: usize>(direction: [L; 3]) -> [L; N] {
                let mut values = [L::default(); N];
                match N {
                    $($count => values.copy_from_slice(&$basis(direction)),)*
                    _ => unsupported(N),
                }
                values
            }

            #[inline(always)]
            pub(super) fn accumulate<L: Lane, const N: usize>(direction: [L; 3], scale: &[L], sum: &mut [L; N]) {
                match N {
                    $($count => $accumulate(direction, scale, sized(sum)),)*
                    _ => unsupported(N),
                }
            }
        };
    }
    basis_entry_points! {
        1 basis_1 accumulate_1
        4 basis_2 accumulate_2
        9 basis_3 accumulate_3
        16 basis_4 accumulate_4
        25 basis_5 accumulate_5
        36 basis_6 accumulate_6
        49 basis_7 accumulate_7
        64 basis_8 accumulate_8
    }

    macro_rules! product_entry_points {
        (unrolled: $($count:literal $product:ident $square:ident)*; tables: $($table_count:literal $table:ident)*) => {
            #[inline(always)]
            pub(super) fn product<L: Lane>(f: &[L], g: &[L], out: &mut [L]) {
                match out.len() {
                    $($count => out.copy_from_slice(&$product(sized_ref(f), sized_ref(g))),)*
                    $($table_count => product_by_table::<L, $table_count>(&$table, sized_ref(f), sized_ref(g), sized(out)),)*
                    n => unsupported(n),
                }
            }

            #[inline(always)]
            pub(super) fn square<L: Lane>(f: &[L], out: &mut [L]) {
                match out.len() {
                    $($count => out.copy_from_slice(&$square(sized_ref(f))),)*
                    $($table_count => square_by_table::<L, $table_count>(&$table, sized_ref(f), sized(out)),)*
                    n => unsupported(n),
                }
            }
        };
    }
    product_entry_points! {
        unrolled: 1 product_1 square_1 4 product_2 square_2 9 product_3 square_3 16 product_4 square_4;
        tables: 25 GROUPS_5 36 GROUPS_6 49 GROUPS_7 64 GROUPS_8
    }

    fn sized<L, const N: usize>(slice: &mut [L]) -> &mut [L; N] {
        slice.try_into().expect("lengths were matched")
    }

    fn sized_ref<L, const N: usize>(slice: &[L]) -> &[L; N] {
        slice.try_into().expect("lengths were matched")
    }

    fn unsupported(count: usize) -> ! {
        panic!("kernels exist for 1 to 8 bands, not for {count} coefficients")
    }
}
