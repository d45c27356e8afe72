//! Functions of `mask` beside double precision: caps, how far they close directions, meshes, boxes and lamps.

use super::{CALLS, axis_or_any, compare, direction, finite, numbers, single, tolerance};
use glam::{DVec3, Vec3};
use halfshade_gpu::{
    Gpu,
    probe::{MaskFrame, Probe, Variable},
};
use halfshade_scene::spheres::{AdjustRule, FADE_HEIGHT, adjust};
use libtest_mimic::Failed;
use rand::{RngExt, SeedableRng};
use rand_pcg::Pcg64Mcg;
use std::sync::Arc;

const RULE: [(&str, f64); 2] = [("RULE", 0.0), ("FULL_HEIGHT", FADE_HEIGHT)];

fn row(vector: DVec3, last: f64) -> [f32; 4] {
    vector.extend(last).as_vec4().to_array()
}

/// Four directions as the shader takes them.
const FOUR: &str = "Four(vec4f(input[0].x), vec4f(input[0].y), vec4f(input[0].z))";

/// Sums of products.
pub(super) fn four(gpu: &Arc<Gpu>) -> Result<(), Failed> {
    let mut random = Pcg64Mcg::seed_from_u64(31);
    let pairs: Vec<[DVec3; 2]> =
        (0..CALLS).map(|_| [0, 1].map(|_| DVec3::from_slice(&numbers(3, 2.0, &mut random)))).collect();
    let inputs: Vec<[f32; 4]> = pairs.iter().flatten().map(|&vector| row(vector, 0.0)).collect();
    let body = format!("output[0] = along({FOUR}, input[1].xyz);");
    let probe =
        Probe { shader: "mask/four.wgsl", bands: None, constants: &[], rows: [2, 1], body: &body, variables: &[] };
    let expected: Vec<f64> = pairs.iter().flat_map(|[a, b]| [a.dot(*b); 4]).collect();
    compare("products", tolerance("mask/four.wgsl"), &probe.call(gpu, &inputs)?, &expected, 4)
}

/// Sine and tangent of half the angular radius, and the direction, of spheres wherever they are.
pub(super) fn cap(gpu: &Arc<Gpu>) -> Result<(), Failed> {
    let mut random = Pcg64Mcg::seed_from_u64(32);
    let mut inputs = Vec::new();
    let mut expected = Vec::new();
    for number in 0..CALLS {
        let offset = DVec3::from_slice(&numbers(3, 2.0, &mut random));
        let radius = single(10f64.powf(random.random_range(-4.0..0.2)));
        let normal = axis_or_any(number, &mut random);
        inputs.extend([row(offset, radius), row(normal, 0.0)]);
        let seen = adjust(AdjustRule::Continuous, offset, radius, normal.normalize());
        let seen = seen.filter(|sphere| sphere.sin_angular_radius() > 1e-6);
        expected.extend(seen.map_or([0.0; 4], |sphere| {
            let sine = sphere.sin_angular_radius();
            // Where the sphere almost vanishes its direction says nothing.
            let axis = sine * sphere.direction();
            [axis.x, axis.y, axis.z, sine / (1.0 + (1.0 - sine * sine).sqrt())]
        }));
    }
    let body = "let cap = cap_of(input[0].xyz, input[0].w, input[1].xyz);
        let per_sine_squared = max(dot(cap.axis, cap.axis), 1.0);
        output[0] = vec4f(cap.axis / per_sine_squared, cap.half_tangent);";
    let shader = "mask/cap.wgsl";
    let probe = Probe { shader, bands: None, constants: &RULE, rows: [2, 1], body, variables: &[] };
    let found = probe.call(gpu, &inputs)?;
    finite(&found)?;
    // Next to the tangent plane the sine itself is a square root of rounding.
    compare("caps", 10.0 * tolerance(shader), &found, &expected, 4)
}

/// The part of a cell that a cap leaves, for caps from a thousandth of the width of an edge on.
pub(super) fn directions(gpu: &Arc<Gpu>) -> Result<(), Failed> {
    let mut random = Pcg64Mcg::seed_from_u64(33);
    let mut inputs = Vec::new();
    let mut expected = Vec::new();
    for _ in 0..CALLS {
        let sharpness = single(random.random_range(1.0..30.0));
        let sine = single(10f64.powf(random.random_range(-3.0..0.0)));
        let (axis, middle) = (direction(&mut random), direction(&mut random));
        // Near its edge as often as anywhere.
        let along = (axis + random.random_range(0.0..1.5) * sine * middle).normalize().as_vec3().as_dvec3();
        inputs.extend([row(along, sharpness), row(axis, sine)]);
        let cosine = (1.0 - sine * sine).sqrt();
        let widths = (2.0 * sine / (1.0 + cosine) * sharpness).min(1.0);
        let part = widths.sqrt() - 0.5 * widths + sharpness * (along.dot(axis) - cosine) / sine;
        expected.push(1.0 - part.clamp(0.0, 1.0));
    }
    let body = format!(
        "let sine = input[1].w;
        let cosine = sqrt(1.0 - sine * sine);
        let cap = Cap(input[1].xyz / sine, cosine / sine, 1.0, sine / (1.0 + cosine));
        let sharpness = input[0].w;
        let rest = 1.0 - edge_offset(cap.half_tangent, sharpness);
        output[0] = closed(vec4f(1.0), {FOUR}, vec4f(sharpness), cap, rest);"
    );
    let shader = "mask/directions.wgsl";
    let probe = Probe { shader, bands: None, constants: &RULE, rows: [2, 1], body: &body, variables: &[] };
    // Cosines of 6e-8 over a sine of 1e-3 and an edge of a thirtieth.
    compare("parts", 40.0 * tolerance(shader), &probe.call(gpu, &inputs)?, &expected, 1)
}

/// Boxes of any size and turn, by the crossings with the planes of their faces.
pub(super) fn boxes(gpu: &Arc<Gpu>) -> Result<(), Failed> {
    let mut random = Pcg64Mcg::seed_from_u64(34);
    let turn = glam::DQuat::from_axis_angle(direction(&mut random).normalize(), 0.7);
    let half = DVec3::new(1.0, 0.1, 0.6);
    let center = DVec3::new(0.2, -0.1, 0.3);
    let axes = [DVec3::X, DVec3::Y, DVec3::Z].map(|axis| (turn * axis).as_vec3().as_dvec3());
    let mut rows = vec![row(center, 7.0), row(half, 0.0)];
    rows.extend(axes.map(|axis| row(axis, 0.0)));
    let mut inputs = Vec::new();
    let mut expected = Vec::new();
    for _ in 0..CALLS {
        let (place, along) = (DVec3::from_slice(&numbers(3, 1.5, &mut random)), direction(&mut random));
        inputs.extend([row(along, 0.0), row(place, 0.0)]);
        // Any face that is crossed in front.
        let inside =
            |point: DVec3, except: usize| (0..3).all(|k| k == except || axes[k].dot(point - center).abs() < half[k]);
        let is_met = (0..3).any(|k| {
            [-half[k], half[k]].iter().any(|level| {
                let step = (level - axes[k].dot(place - center)) / axes[k].dot(along);
                step > 0.0 && inside(place + step * along, k)
            })
        });
        expected.push(if is_met { 0.0 } else { 1.0 });
    }
    let body = format!("output[0] = open_beside_box(0u, input[1].xyz, {FOUR}, 3e38f);");
    let shader = "mask/boxes.wgsl";
    let variables = [Variable::storage(1, "rows", &rows)];
    let probe = Probe { shader, bands: None, constants: &[], rows: [2, 1], body: &body, variables: &variables };
    let found = probe.call(gpu, &inputs)?;
    let differ = found.iter().zip(&expected).filter(|(found, expected)| f64::from(found[0]) != **expected).count();
    // A direction that grazes an edge.
    if differ > 4 { Err(format!("{differ} of {CALLS} are decided otherwise").into()) } else { Ok(()) }
}

/// Bits of the cell next to each direction, between three vertices.
pub(super) fn own(gpu: &Arc<Gpu>) -> Result<(), Failed> {
    let mut random = Pcg64Mcg::seed_from_u64(35);
    let side = 8;
    let words: Vec<u32> = (0..6).map(|_| random.random_range(0..=u32::MAX)).collect();
    let frame = MaskFrame { own_side: side as u32, ..MaskFrame::default() };
    let placement = [[1.0f32, 0.0, 0.0, 0.0], [0.0, 1.0, 0.0, 0.0], [0.0, 0.0, 1.0, 0.0]].repeat(2);
    let weights = [0.5, 0.3, 0.2];
    let mut inputs = Vec::new();
    let mut expected = Vec::new();
    for _ in 0..CALLS {
        let along = direction(&mut random);
        inputs.push(row(along, 0.0));
        // The octahedron unfolded.
        let p = along / (along.x.abs() + along.y.abs() + along.z.abs());
        let fold = |a: f64, b: f64| if p.y >= 0.0 { a } else { (1.0 - b.abs()).copysign(a) };
        let place = |at: f64| ((0.5 * (at + 1.0) * side as f64) as usize).min(side - 1);
        let cell = place(fold(p.z, p.x)) * side + place(fold(p.x, p.z));
        let bit = |vertex: usize| f64::from(words[2 * vertex + cell / 32] >> (cell % 32) & 1);
        expected.push((0..3).map(|vertex| weights[vertex] * bit(vertex)).sum());
    }
    let body = format!(
        "let point = OwnPoint(vec3u(0u, 2u, 4u), vec3f(0.5, 0.3, 0.2), true, false);
        output[0] = own_open(point, 0u, {FOUR});"
    );
    let shader = "mask/own.wgsl";
    let variables = [
        Variable::storage(2, "placements", &placement).of_group(0),
        Variable::storage_struct(0, "frame", &frame),
        Variable::storage(3, "cells", &words),
    ];
    let probe = Probe { shader, bands: None, constants: &[], rows: [1, 1], body: &body, variables: &variables };
    let found = probe.call(gpu, &inputs)?;
    let off = |(found, expected): &(&[f32; 4], &f64)| (f64::from(found[0]) - **expected).abs() > tolerance(shader);
    let differ = found.iter().zip(&expected).filter(off).count();
    // A direction between two cells.
    if differ > 4 { Err(format!("{differ} of {CALLS} differ").into()) } else { Ok(()) }
}

/// Directions into suns and spheres, and the part of them that a cap leaves, from specks to hemispheres.
pub(super) fn lamp(gpu: &Arc<Gpu>) -> Result<(), Failed> {
    let mut random = Pcg64Mcg::seed_from_u64(36);
    let (edge, count) = (1.2, 64.0);
    let frame = MaskFrame { edge: edge as f32, lamp_directions: count as f32, ..MaskFrame::default() };
    let mut inputs = Vec::new();
    let mut expected = Vec::new();
    for _ in 0..CALLS {
        let axis = direction(&mut random);
        let sine = single(10f64.powf(random.random_range(-3.0..0.0)));
        let (within, turn) = (single(random.random_range(0.0..1.0)), single(random.random_range(0.0..6.0)));
        let cap_sine = single((sine * 10f64.powf(random.random_range(-1.0..1.0))).min(1.0));
        let cap_axis = (axis + 2.0 * sine * direction(&mut random)).normalize().as_vec3().as_dvec3();
        inputs.extend([row(axis, sine), [within as f32, turn as f32, 0.0, 0.0], row(cap_axis, cap_sine)]);
        let versine = sine * sine / (1.0 + (1.0 - sine * sine).sqrt());
        let fall = within * versine;
        let across = (fall * (2.0 - fall)).sqrt();
        let (a, b) = axis.as_vec3().any_orthonormal_pair();
        let [a, b]: [DVec3; 2] = [a, b].map(|v: Vec3| v.as_dvec3());
        let shift = across * (turn.cos() * a + turn.sin() * b) - fall * axis;
        let cosine = (1.0 - cap_sine * cap_sine).sqrt();
        let sharpness = 1.0 / (edge * (2.0 * versine / count).sqrt());
        let widths = (2.0 * cap_sine / (1.0 + cosine) * sharpness).min(1.0);
        let cap_versine = cap_sine * cap_sine / (1.0 + cosine);
        let chord_squared = (axis - cap_axis + shift).length_squared();
        let part = widths.sqrt() - 0.5 * widths + sharpness * (cap_versine - 0.5 * chord_squared) / cap_sine;
        expected.push(1.0 - part.clamp(0.0, 1.0));
    }
    let body = "let view = lamp_view(input[0], false, vec3f(0.0), vec3f(0.0, 1.0, 0.0));
        let turn = input[1].y;
        let shift = spread(view.versine, vec4f(input[1].x), vec4f(cos(turn)), vec4f(sin(turn)));
        let sine = input[2].w;
        let cosine = sqrt((1.0 - sine) * (1.0 + sine));
        let cap = Cap(input[2].xyz / sine, cosine / sine, 1.0, sine / (1.0 + cosine));
        let before = cap_before(view.bundle, cap);
        let sharpness = vec4f(view.bundle.sharpness);
        output[0] = select(vec4f(1.0), closed_before(vec4f(1.0), shift, sharpness, before), before.may_hide);";
    let shader = "mask/lamp.wgsl";
    let variables = [Variable::storage_struct(0, "frame", &frame)];
    let probe = Probe { shader, bands: None, constants: &RULE, rows: [3, 1], body, variables: &variables };
    // Directions differ by 6e-8, the narrowest edge is 2e-4 wide.
    compare("parts", 10.0 * tolerance(shader), &probe.call(gpu, &inputs)?, &expected, 1)
}
