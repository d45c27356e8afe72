//! Caps of directions beside double precision: lamps as receivers see them, what one cap hides of another, light by normal.

use super::{CALLS, compare, direction, finite, single, tolerance};
use glam::DVec3;
use halfshade_gpu::{
    Gpu,
    probe::{AnalyticFrame, Probe, Variable},
};
use halfshade_scene::light::{OctahedralGrid, cap_irradiance};
use libtest_mimic::Failed;
use rand::{RngExt, SeedableRng};
use rand_pcg::Pcg64Mcg;
use std::{
    f64::consts::{FRAC_PI_2, PI},
    sync::Arc,
};

fn row(vector: DVec3, last: f64) -> [f32; 4] {
    vector.extend(last).as_vec4().to_array()
}

/// Axis, sine, distance and irradiance of suns and of spheres, from without and from within.
pub(super) fn placed_lamps(gpu: &Arc<Gpu>) -> Result<(), Failed> {
    let mut random = Pcg64Mcg::seed_from_u64(51);
    let mut inputs = Vec::new();
    let mut expected = Vec::new();
    for number in 0..CALLS {
        let (normal, toward) = (direction(&mut random), direction(&mut random));
        let sine = single(10f64.powf(random.random_range(-4.0..0.0)));
        let near = |position: DVec3, center: DVec3, radius: f64| {
            let offset = center - position;
            let distance = offset.length();
            let is_within = distance <= radius;
            let axis = if is_within { normal } else { offset / distance };
            let sine = if is_within { 1.0 } else { radius / distance };
            let form = if is_within { PI } else { cap_irradiance(axis.dot(normal), sine) };
            [axis.x, axis.y, axis.z, sine, distance.max(radius), form]
        };
        let far = || [toward.x, toward.y, toward.z, sine, 0.0, cap_irradiance(toward.dot(normal), sine)];
        let is_near = number.is_multiple_of(2);
        let position = (0.5 * direction(&mut random)).as_vec3().as_dvec3();
        let center = (single(random.random_range(0.1..1.5)) * toward).as_vec3().as_dvec3();
        inputs.extend([row(if is_near { center } else { toward }, sine), row(normal, f64::from(u8::from(is_near)))]);
        inputs.push(row(position, 0.0));
        expected.extend(if is_near { near(position, center, sine) } else { far() });
    }
    let body = "let is_near = input[1].w > 0.5;
        let seen = seen_lamp(input[0], is_near, input[2].xyz, input[1].xyz);
        output[0] = vec4f(seen.axis, seen.sine);
        output[1] = vec4f(select(0.0, seen.distance, is_near), lamp_form(input[0], is_near, input[2].xyz, input[1].xyz), 0.0, 0.0);";
    let shader = "shared/placed_lamps.wgsl";
    let probe = Probe { shader, bands: None, constants: &[], rows: [3, 2], body, variables: &[] };
    compare("lamps", tolerance(shader), &probe.call(gpu, &inputs)?, &expected, 6)
}

/// The part of a cap that another hides, from specks to hemispheres, by Gauss and Bonnet in double precision.
pub(super) fn overlap(gpu: &Arc<Gpu>) -> Result<(), Failed> {
    let mut random = Pcg64Mcg::seed_from_u64(52);
    let mut inputs = Vec::new();
    let mut expected = Vec::new();
    for number in 0..CALLS {
        let lamp = single((10f64.powf(random.random_range(-3.0..0.2))).min(FRAC_PI_2));
        let cap = single((lamp * 10f64.powf(random.random_range(-1.0..1.0))).min(FRAC_PI_2));
        let apart = match number % 8 {
            0 => lamp + cap,
            1 => (lamp - cap).abs(),
            2 => 0.0,
            _ => random.random_range(0.0..1.1) * (lamp + cap),
        };
        let apart = single(apart.min(PI));
        inputs.push([lamp as f32, cap as f32, apart as f32, 0.0]);
        expected.push(hidden(lamp, cap, apart));
    }
    let body = "output[0].x = hidden_of_cap(input[0].x, input[0].y, input[0].z);";
    let shader = "analytic/overlap.wgsl";
    let probe = Probe { shader, bands: None, constants: &[], rows: [1, 1], body, variables: &[] };
    let found = probe.call(gpu, &inputs)?;
    finite(&found)?;
    compare("overlaps", tolerance(shader), &found, &expected, 1)
}

/// The lens that two circles on the sphere share is bounded by two arcs, whose geodesic curvature and turns at the two
/// crossings add up with its area to 2π; over the area of the lamp.
fn hidden(lamp: f64, cap: f64, apart: f64) -> f64 {
    let whole = 2.0 * (0.5 * lamp).sin().powi(2);
    let within = (2.0 * (0.5 * cap).sin().powi(2) / whole).min(1.0);
    if apart >= lamp + cap {
        return 0.0;
    }
    if apart <= (lamp - cap).abs() {
        return within;
    }
    // The angle of a spherical triangle with these sides that faces the first.
    let facing = |a: f64, b: f64, c: f64| {
        let s = 0.5 * (a + b + c);
        let sine = |x: f64| x.sin().max(0.0);
        2.0 * (sine(s - b) * sine(s - c)).sqrt().atan2((sine(s) * sine(s - a)).sqrt())
    };
    let (at_lamp, at_cap) = (facing(cap, lamp, apart), facing(lamp, cap, apart));
    let at_crossing = facing(apart, lamp, cap);
    // Turns of π less the inner angle, which is π less that of the triangle.
    let area = 2.0 * (PI - at_crossing - at_lamp * lamp.cos() - at_cap * cap.cos());
    (area / (2.0 * PI * whole)).clamp(0.0, within)
}

/// The table over normals, and constant light without one.
pub(super) fn rest_irradiance(gpu: &Arc<Gpu>) -> Result<(), Failed> {
    let mut random = Pcg64Mcg::seed_from_u64(53);
    let grid = OctahedralGrid::new(8);
    let value = |node: usize| (grid.direction(node).as_dvec3() + 1.5).as_vec3().as_dvec3();
    let table: Vec<[f32; 4]> = (0..grid.node_count()).map(|node| row(value(node), 0.0)).collect();
    let normals: Vec<DVec3> = (0..CALLS).map(|_| direction(&mut random)).collect();
    let inputs: Vec<[f32; 4]> = normals.iter().map(|&normal| row(normal, 0.0)).collect();
    let constant = DVec3::new(0.5, 2.0, 1.0);
    for cells in [0.0, 8.0] {
        let frame = AnalyticFrame { constant: row(constant, 0.0), grid_cells: cells, ..AnalyticFrame::default() };
        let variables = [Variable::storage_struct(0, "frame", &frame), Variable::storage(2, "tables", &table)];
        let body = "output[0] = vec4f(rest_irradiance(input[0].xyz), 0.0);";
        // The file has no frame of its own.
        let shader = "analytic/frame.wgsl";
        let probe = Probe { shader, bands: None, constants: &[], rows: [1, 1], body, variables: &variables };
        let expected = |normal: &DVec3| -> DVec3 {
            let found = grid.lookup(normal.as_vec3());
            (0..3).map(|k| f64::from(found.weights[k]) * value(found.nodes[k])).sum()
        };
        let expected = normals.iter().map(|normal| if cells > 0.0 { expected(normal) } else { constant });
        let expected: Vec<f64> = expected.flat_map(|value| value.to_array()).collect();
        let found = probe.call(gpu, &inputs)?;
        compare(&format!("{cells} cells"), tolerance("shared/irradiance.wgsl"), &found, &expected, 3)?;
    }
    Ok(())
}
