//! Vectors of spherical harmonics: basis, products, squares.

use super::{CALLS, axis_or_any, compare, given, numbers, rows, taken};
use glam::DVec3;
use halfshade_gpu::{Gpu, probe::Probe};
use halfshade_sh::{basis, product, wgsl::MAX_WGSL_BANDS};
use libtest_mimic::Failed;
use rand::SeedableRng;
use rand_pcg::Pcg64Mcg;
use std::sync::Arc;

/// Generated code has no file of its own; its functions are straight sums and products.
const GENERATED: f64 = 3e-6;

/// Basis, lobes, products, squares at every number of bands.
pub(super) fn vectors(gpu: &Arc<Gpu>) -> Result<(), Failed> {
    let mut random = Pcg64Mcg::seed_from_u64(1);
    for bands in 1..=MAX_WGSL_BANDS {
        let count = bands * bands;
        let parts = count.div_ceil(4);
        let load = format!("{} {}", taken("a", "0u"), taken("b", "SH_PARTS"));
        let call = |body: &str, rows: usize, inputs: &[[f32; 4]]| {
            let rows = [rows, parts];
            Probe { shader: "", bands: Some(bands), constants: &[], rows, body, variables: &[] }.call(gpu, inputs)
        };
        let directions: Vec<DVec3> = (0..CALLS).map(|i| axis_or_any(i, &mut random)).collect();
        let inputs: Vec<[f32; 4]> = directions.iter().map(|d| d.as_vec3().extend(0.0).to_array()).collect();
        let expected: Vec<f64> = directions.iter().flat_map(|d| basis::evaluate(bands, d.to_array())).collect();
        let found = call(&given("sh_basis(input[0].xyz)", "0u"), 1, &inputs)?;
        compare(&format!("basis of {bands} bands"), GENERATED, &found, &expected, count)?;

        let pairs: Vec<[Vec<f64>; 2]> =
            (0..CALLS).map(|_| std::array::from_fn(|_| numbers(count, 1.0, &mut random))).collect();
        let inputs: Vec<[f32; 4]> = pairs.iter().flatten().flat_map(|vector| rows(vector)).collect();
        let products: Vec<f64> = pairs.iter().flat_map(|[a, b]| product::product(a, b)).collect();
        let found = call(&format!("{load} {}", given("sh_product(a, b)", "0u")), 2 * parts, &inputs)?;
        compare(&format!("product of {bands} bands"), GENERATED, &found, &products, count)?;
        let squares: Vec<f64> = pairs.iter().flat_map(|[a, _]| product::square(a)).collect();
        let found = call(&format!("{load} {}", given("sh_square(a)", "0u")), 2 * parts, &inputs)?;
        compare(&format!("square of {bands} bands"), GENERATED, &found, &squares, count)?;
    }
    Ok(())
}
