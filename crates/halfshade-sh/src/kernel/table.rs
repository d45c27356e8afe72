//! Products that walk a table of factored tripling coefficients: for bands beyond the unrolled kernels.

use super::Lane;

/// The tripling coefficients that share the pair of indices `(i, j)`, as (third index, coefficient). With `i == j` the
/// pair is a square.
pub(super) struct Group {
    pub(super) i: usize,
    pub(super) j: usize,
    pub(super) thirds: &'static [(usize, f64)],
}

/// `h = f*g`: per pair, with `s = Σ c_k f_k` and `t = Σ c_k g_k`, `h_i += s g_j + t f_j`, `h_j += s g_i + t f_i`,
/// `h_k += c_k (f_i g_j + f_j g_i)`; a square counts once.
#[inline(always)]
pub(super) fn product_by_table<L: Lane, const N: usize>(groups: &[Group], f: &[L; N], g: &[L; N], h: &mut [L; N]) {
    h.fill(L::default());
    for &Group { i, j, thirds } in groups {
        let (mut s, mut t) = (L::default(), L::default());
        let (pair, same) = if i == j { (f[i] * g[i], i) } else { (f[j].mul_add(g[i], f[i] * g[j]), N) };
        for &(k, value) in thirds {
            let c = L::constant(value);
            h[k] = pair.mul_add(c, h[k]);
            if k != same {
                s = f[k].mul_add(c, s);
                t = g[k].mul_add(c, t);
            }
        }
        h[i] = s.mul_add(g[j], t.mul_add(f[j], h[i]));
        if i != j {
            h[j] = s.mul_add(g[i], t.mul_add(f[i], h[j]));
        }
    }
}

/// `h = f*f`: as [`product_by_table`] with f = g.
#[inline(always)]
pub(super) fn square_by_table<L: Lane, const N: usize>(groups: &[Group], f: &[L; N], h: &mut [L; N]) {
    h.fill(L::default());
    for &Group { i, j, thirds } in groups {
        let mut s = L::default();
        let (pair, same) = if i == j { (f[i] * f[i], i) } else { ((f[i] + f[i]) * f[j], N) };
        for &(k, value) in thirds {
            let c = L::constant(value);
            h[k] = pair.mul_add(c, h[k]);
            if k != same {
                s = f[k].mul_add(c, s);
            }
        }
        let s = s + s;
        h[i] = s.mul_add(f[j], h[i]);
        if i != j {
            h[j] = s.mul_add(f[i], h[j]);
        }
    }
}
