//! Glossy lobes of `mask` beside double precision: where their directions are, powers and horizons, light over lobes.

use super::{CALLS, compare, direction, finite, single, tolerance};
use glam::DVec3;
use halfshade_gpu::{
    Gpu,
    probe::{MaskFrame, Probe, Variable},
};
use halfshade_scene::{light::OctahedralGrid, spheres::FADE_HEIGHT};
use libtest_mimic::Failed;
use rand::{RngExt, SeedableRng};
use rand_pcg::Pcg64Mcg;
use std::sync::Arc;

const RULE: [(&str, f64); 2] = [("RULE", 0.0), ("FULL_HEIGHT", FADE_HEIGHT)];

fn row(vector: DVec3, last: f64) -> [f32; 4] {
    vector.extend(last).as_vec4().to_array()
}

/// Exponents from 0 to those of mirrors.
fn exponent(number: usize, random: &mut Pcg64Mcg) -> f64 {
    if number.is_multiple_of(16) { 0.0 } else { single(10f64.powf(random.random_range(-1.0..5.0))) }
}

/// Heights of directions in units of the lobe's width, edges in units of the sharpest, powers a lobe's width away.
pub(super) fn lobe(gpu: &Arc<Gpu>) -> Result<(), Failed> {
    let mut random = Pcg64Mcg::seed_from_u64(61);
    let frame = MaskFrame { edge: 1.0, lobe_sixteens: 2, ..MaskFrame::default() };
    let mut inputs = Vec::new();
    let mut expected = Vec::new();
    for number in 0..CALLS {
        let exponent = exponent(number, &mut random);
        let log = single(random.random_range(0.01..5.0));
        let versine = single((random.random_range(0.0..3.0) / (exponent + 1.0)).min(0.999));
        let (axis, above) = (direction(&mut random), single(random.random_range(-1.0..1.0)));
        inputs.extend([row(axis, exponent), [log as f32, versine as f32, above as f32, 0.0]]);
        let fall = -(-log / (exponent + 1.0)).exp_m1();
        let sharpest = (32.0 * (exponent + 1.0) / 2.0).sqrt();
        let narrowing = (-0.5 * exponent * log / (exponent + 1.0)).exp();
        let power = (exponent * (-versine).ln_1p()).exp();
        let horizon = (0.5 + above * narrowing * sharpest).clamp(0.0, 1.0);
        expected.extend([fall * (exponent + 1.0) / 5.0, narrowing, power, horizon]);
    }
    let body = "let view = lobe_view(input[0].xyz, input[0].w, 1.0);
        let logs = vec4f(input[1].x);
        let shift = lobe_shift(view.versine, logs, vec4f(1.0), vec4f(0.0));
        let sharpness = lobe_sharpness(view, logs);
        let lobe = Lobe(input[0].xyz, input[0].w, vec3f(1.0), false);
        output[0] = vec4f(-shift.z.x / (5.0 * view.versine), sharpness.x / view.sharpness,
            powers(input[0].w, vec4f(input[1].y)).x, horizon(lobe, vec4f(input[1].z), sharpness).x);";
    let shader = "mask/lobe.wgsl";
    let variables = [Variable::storage_struct(0, "frame", &frame)];
    let probe = Probe { shader, bands: None, constants: &RULE, rows: [2, 1], body, variables: &variables };
    let found = probe.call(gpu, &inputs)?;
    finite(&found)?;
    compare("lobes", tolerance(shader), &found, &expected, 4)
}

/// Means between nodes and levels, and the nodes next to directions.
pub(super) fn lobe_light(gpu: &Arc<Gpu>) -> Result<(), Failed> {
    let mut random = Pcg64Mcg::seed_from_u64(62);
    let grids = [4, 4, 7, 16].map(OctahedralGrid::new);
    let value = |level: usize, node: usize| {
        (grids[level].direction(node).as_dvec3() + 1.5 + 0.3 * level as f64).as_vec3().as_dvec3()
    };
    let mut table = Vec::new();
    let mut first = grids.len();
    for grid in &grids {
        table.push([first as f32, grid.cells() as f32, 0.0, 0.0]);
        first += grid.node_count();
    }
    for (level, grid) in grids.iter().enumerate() {
        table.extend((0..grid.node_count()).map(|node| row(value(level, node), 0.0)));
    }
    let frame = MaskFrame { level_count: grids.len() as u32, ..MaskFrame::default() };
    let mut inputs = Vec::new();
    let mut means = Vec::new();
    let mut next = Vec::new();
    for number in 0..CALLS {
        let (axis, exponent) = (direction(&mut random), exponent(number, &mut random));
        inputs.push(row(axis, exponent));
        let place = (exponent + 1.0).log2().min(3.0);
        let level = (place as usize).min(2);
        let at = |level: usize| -> DVec3 {
            let found = grids[level].lookup(axis.as_vec3());
            (0..3).map(|k| f64::from(found.weights[k]) * value(level, found.nodes[k])).sum()
        };
        means.extend(at(level).lerp(at(level + 1), place - level as f64).to_array());
        // The octahedron unfolded.
        let p = axis / (axis.x.abs() + axis.y.abs() + axis.z.abs());
        let fold = |a: f64, b: f64| if p.y >= 0.0 { a } else { (1.0 - b.abs()).copysign(a) };
        let node =
            (fold(p.z, p.x) * 16.0 + 16.0).round() as usize * 33 + (fold(p.x, p.z) * 16.0 + 16.0).round() as usize;
        next.extend(value(3, node).to_array());
    }
    let body = "output[0] = vec4f(mean_over_lobe(input[0].xyz, input[0].w), 0.0);
        let four = Four(vec4f(input[0].x), vec4f(input[0].y), vec4f(input[0].z));
        output[1] = tables[next_to(level_of(7.0, 1.0), four).x];";
    let shader = "mask/lobe_light.wgsl";
    let identity = [[1.0f32, 0.0, 0.0, 0.0], [0.0, 1.0, 0.0, 0.0], [0.0, 0.0, 1.0, 0.0]].repeat(2);
    let cells = [0u32; 8];
    let variables = [
        Variable::storage(2, "placements", &identity).of_group(0),
        Variable::storage_struct(0, "frame", &frame),
        Variable::storage(2, "tables", &table),
        Variable::storage(3, "cells", &cells),
    ];
    let probe = Probe { shader, bands: None, constants: &[], rows: [1, 2], body, variables: &variables };
    let found = probe.call(gpu, &inputs)?;
    let [first, second] = [0, 1].map(|k| found.iter().skip(k).step_by(2).copied().collect::<Vec<_>>());
    compare("means", tolerance(shader), &first, &means, 3)?;
    let off =
        |(found, expected): &(&[f32; 4], &[f64])| (0..3).any(|k| (f64::from(found[k]) - expected[k]).abs() > 1e-5);
    let differ = second.iter().zip(next.chunks(3)).filter(off).count();
    // A direction half-way between two nodes.
    if differ > 4 { Err(format!("{differ} of {CALLS} nodes differ").into()) } else { Ok(()) }
}
