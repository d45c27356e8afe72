//! Vectors of spherical harmonics: basis, products, squares.

use super::{CALLS, axis_or_any, compare, numbers, rows};
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
        let load = "var a: array<vec4f, SH_PARTS>; var b: array<vec4f, SH_PARTS>;
            for (var k = 0u; k < SH_PARTS; k++) { a[k] = input[k]; b[k] = input[SH_PARTS + k]; }";
        let give = |value: &str| {
            format!("let parts = sh_parts({value}); for (var k = 0u; k < SH_PARTS; k++) {{ output[k] = parts[k]; }}")
        };
        let call = |body: &str, taken: usize, inputs: &[[f32; 4]]| {
            let rows = [taken, parts];
            Probe { shader: "", bands: Some(bands), constants: &[], rows, body, variables: &[] }.call(gpu, inputs)
        };
        let directions: Vec<DVec3> = (0..CALLS).map(|i| axis_or_any(i, &mut random)).collect();
        let inputs: Vec<[f32; 4]> = directions.iter().map(|d| d.as_vec3().extend(0.0).to_array()).collect();
        let expected: Vec<f64> = directions.iter().flat_map(|d| basis::evaluate(bands, d.to_array())).collect();
        let found = call(&give("sh_basis(input[0].xyz)"), 1, &inputs)?;
        compare(&format!("basis of {bands} bands"), GENERATED, &found, &expected, count)?;

        let pairs: Vec<[Vec<f64>; 2]> =
            (0..CALLS).map(|_| std::array::from_fn(|_| numbers(count, 1.0, &mut random))).collect();
        let inputs: Vec<[f32; 4]> = pairs.iter().flatten().flat_map(|vector| rows(vector)).collect();
        let products: Vec<f64> = pairs.iter().flat_map(|[a, b]| product::product(a, b)).collect();
        let found =
            call(&format!("{load} {}", give("sh_product(sh_of_parts(a), sh_of_parts(b))")), 2 * parts, &inputs)?;
        compare(&format!("product of {bands} bands"), GENERATED, &found, &products, count)?;
        let squares: Vec<f64> = pairs.iter().flat_map(|[a, _]| product::square(a)).collect();
        let found = call(&format!("{load} {}", give("sh_square(sh_of_parts(a))")), 2 * parts, &inputs)?;
        compare(&format!("square of {bands} bands"), GENERATED, &found, &squares, count)?;
    }
    Ok(())
}
