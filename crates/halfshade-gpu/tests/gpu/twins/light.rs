//! Light of caps and of maps by normal, and quotients next to zero.

use super::{CALLS, compare, direction, single, tolerance};
use glam::DVec3;
use halfshade_gpu::{Gpu, probe::Probe};
use halfshade_scene::light::{OctahedralGrid, cap_irradiance};
use libtest_mimic::Failed;
use rand::{RngExt, SeedableRng};
use rand_pcg::Pcg64Mcg;
use std::sync::Arc;

/// Caps above, at and below the horizon, from a millionth of a radian to half of all directions.
pub(super) fn cap(gpu: &Arc<Gpu>) -> Result<(), Failed> {
    let mut random = Pcg64Mcg::seed_from_u64(5);
    for sine in [1e-6, 1e-3, 0.00465, 0.1, 0.5, 0.999, 1.0].map(single) {
        let cosines: Vec<f64> = (0..CALLS)
            .map(|i| match i {
                0 => -1.0,
                1 => 1.0,
                2 => sine,
                3 => -sine,
                4 => 0.0,
                _ if i % 2 == 0 => single(random.random_range(-1.0..1.0)),
                _ => single(sine * random.random_range(-1.1..1.1f64).clamp(-1.0 / sine, 1.0 / sine)),
            })
            .collect();
        let inputs: Vec<[f32; 4]> = cosines.iter().map(|&cosine| [cosine as f32, sine as f32, 0.0, 0.0]).collect();
        let body = "output[0].x = cap_irradiance(input[0].x, input[0].y);";
        let shader = "common/cap.wgsl";
        let found =
            Probe { shader, bands: None, constants: &[], rows: [1, 1], body, variables: &[] }.call(gpu, &inputs)?;
        let expected: Vec<f64> = cosines.iter().map(|&cosine| cap_irradiance(cosine, sine)).collect();
        compare(&format!("sine {sine:e}"), tolerance(shader), &found, &expected, 1)?;
    }
    Ok(())
}

/// A function of the nodes, interpolated: also on axes and edges of cells.
pub(super) fn octahedral(gpu: &Arc<Gpu>) -> Result<(), Failed> {
    let mut random = Pcg64Mcg::seed_from_u64(6);
    for cells in [2, 32, 128] {
        let grid = OctahedralGrid::new(cells);
        let directions: Vec<DVec3> = (0..CALLS)
            .map(|i| match i % 4 {
                0 => grid.direction(i % grid.node_count()).as_dvec3(),
                1 => DVec3::AXES[i / 4 % 3] * if i % 8 == 1 { 1.0 } else { -1.0 },
                _ => direction(&mut random),
            })
            .collect();
        let inputs: Vec<[f32; 4]> = directions.iter().map(|d| d.as_vec3().extend(cells as f32).to_array()).collect();
        let body = "let found = octahedral_lookup(input[0].xyz, input[0].w);
            output[0] = vec4f(vec3f(found.nodes), 0.0);
            output[1] = vec4f(found.weights, 0.0);";
        let shader = "common/octahedral.wgsl";
        let found =
            Probe { shader, bands: None, constants: &[], rows: [1, 2], body, variables: &[] }.call(gpu, &inputs)?;
        let value = |node: usize| (grid.direction(node).as_dvec3() * DVec3::new(1.0, 2.0, 3.0)).element_sum();
        let interpolated: Vec<[f32; 4]> = (found.as_chunks::<2>().0.iter())
            .map(|[nodes, weights]| {
                let sum: f64 = (0..3).map(|k| f64::from(weights[k]) * value(nodes[k] as usize)).sum();
                [sum as f32, 0.0, 0.0, 0.0]
            })
            .collect();
        let expected: Vec<f64> = (directions.iter())
            .map(|direction| {
                let found = grid.lookup(direction.as_vec3());
                found.nodes.iter().zip(found.weights).map(|(&node, weight)| f64::from(weight) * value(node)).sum()
            })
            .collect();
        compare(&format!("{cells} cells"), tolerance(shader), &interpolated, &expected, 1)?;
    }
    Ok(())
}

/// Quotients by the argument, which are near 1 however small it is, of either sign.
pub(super) fn near_zero(gpu: &Arc<Gpu>) -> Result<(), Failed> {
    let mut random = Pcg64Mcg::seed_from_u64(7);
    let numbers: Vec<f64> = (0..CALLS).map(|_| single(0.9 * 10f64.powf(random.random_range(-30.0..0.0)))).collect();
    let inputs: Vec<[f32; 4]> = numbers.iter().map(|&x| [x as f32, 0.0, 0.0, 0.0]).collect();
    let body = "let x = input[0].x;
        output[0] = vec4f(exp_minus_one(x), exp_minus_one(-x), log_one_minus(x), 4.0 * log_one_minus(-0.25 * x)) / x;";
    let shader = "common/near_zero.wgsl";
    let found = Probe { shader, bands: None, constants: &[], rows: [1, 1], body, variables: &[] }.call(gpu, &inputs)?;
    let expected: Vec<f64> = numbers
        .iter()
        .flat_map(|x| [x.exp_m1(), (-x).exp_m1(), (-x).ln_1p(), 4.0 * (0.25 * x).ln_1p()].map(|y| y / x))
        .collect();
    compare("quotients", tolerance(shader), &found, &expected, 4)
}
