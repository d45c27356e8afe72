//! Numbers of rays.

use super::{compare, tolerance};
use halfshade_gpu::{Gpu, probe::Probe};
use libtest_mimic::Failed;
use std::sync::Arc;

/// Fixed-point sequences in 64 bits, whose upper 24 the device gives.
pub(super) fn random(gpu: &Arc<Gpu>) -> Result<(), Failed> {
    let receivers = [0, 1, 2, 77, 65_535, 65_536, 4_000_000_000u32];
    let step = 0x9e37_79b9_7f4a_7c15u64;
    // Whole numbers as two halves that single precision holds.
    let halves = |number: u32| [(number >> 16) as f32, (number & 0xffff) as f32];
    let calls: Vec<(u32, u32)> = receivers.iter().flat_map(|&r| (0..500u32).map(move |i| (r, i * i))).collect();
    let inputs: Vec<[f32; 4]> = (calls.iter())
        .map(|&(receiver, number)| [halves(receiver), halves(number)].concat().try_into().unwrap_or_default())
        .collect();
    let body = "let whole = vec4u(input[0]);
        let shifts = shifts_of((whole.x << 16u) | whole.y);
        let point = (whole.z << 16u) | whole.w;
        let step = vec2u(0x7f4a7c15u, 0x9e3779b9u);
        output[0] = vec4f(
            coordinate(shifts.x, step, point), coordinate(shifts.y, step, point), coordinate(shifts.z, step, point), 0.0);";
    let shader = "ray_traced/random.wgsl";
    let found = Probe { shader, bands: None, constants: &[], rows: [1, 1], body, variables: &[] }.call(gpu, &inputs)?;
    let split_mix = |state: u64| {
        let x = (state ^ (state >> 30)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
        let x = (x ^ (x >> 27)).wrapping_mul(0x94d0_49bb_1331_11eb);
        x ^ (x >> 31)
    };
    let expected: Vec<f64> = (calls.iter())
        .flat_map(|&(receiver, number)| {
            (1..=3u64).map(move |k| {
                let shift = split_mix(u64::from(receiver).wrapping_add(step.wrapping_mul(k)));
                shift.wrapping_add(step.wrapping_mul(u64::from(number))) as f64 * 2f64.powi(-64)
            })
        })
        .collect();
    compare("points", tolerance(shader), &found, &expected, 3)
}
