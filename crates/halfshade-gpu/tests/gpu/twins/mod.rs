//! Functions of the shaders, one by one, beside double precision: random inputs and extremes.

mod caps;
mod combinations;
mod distant_light;
mod fields;
mod irradiance;
mod light;
mod mask;
mod mask_gloss;
mod product;
mod prt;
mod rays;
mod receivers;
mod reflectance;
mod reflections;
mod sampler;
mod sh_exp;
mod shadow_field_world;
mod transfer;
mod traverse;
mod vectors;
mod visibility;

use glam::DVec3;
use halfshade_gpu::{Gpu, kernels::KERNELS};
use libtest_mimic::Failed;
use rand::RngExt;
use rand_pcg::Pcg64Mcg;
use std::{f64::consts::PI, fmt::Debug, sync::Arc};

type Test = fn(&Arc<Gpu>) -> Result<(), Failed>;

pub(super) const TESTS: &[(&str, Test)] = &[
    ("vectors", vectors::vectors),
    ("tangent_plane", visibility::tangent_plane),
    ("blocker", visibility::blocker),
    ("exponential", visibility::exponential),
    ("cap", light::cap),
    ("octahedral", light::octahedral),
    ("random", rays::random),
    ("near_zero", light::near_zero),
    ("log_sum", combinations::log_sum),
    ("product", combinations::product),
    ("shares", combinations::shares),
    ("distant_light", distant_light::light),
    ("ground", distant_light::ground),
    ("gather", reflections::gather),
    ("emit", reflections::emit),
    ("shell_coordinates", fields::shell_coordinates),
    ("shell_grid", fields::shell_grid),
    ("reconstruct", fields::reconstruct),
    ("rotate", fields::rotate),
    ("occlusion", fields::occlusion),
    ("cosine_power", transfer::cosine_power),
    ("bounded_product", transfer::bounded_product),
    ("light_order", transfer::light_order),
    ("light_cap", transfer::light_cap),
    ("light_product", transfer::light_product),
    ("gloss", transfer::gloss),
    ("reflectance", reflectance::lobes),
    ("eye_lobes", reflectance::eye_lobes),
    ("reflector", reflectance::reflector),
    ("light", sampler::light),
    ("irradiance", irradiance::irradiance),
    ("sequence", product::sequence),
    ("light_tree", product::light_tree),
    ("drawn_for_lights", product::drawn_for_lights),
    ("stops", product::stops),
    ("traverse", traverse::traverse),
    ("cutout", traverse::cutout),
    ("placed_lamps", caps::placed_lamps),
    ("overlap", caps::overlap),
    ("rest_irradiance", caps::rest_irradiance),
    ("transfer_dot", prt::dot),
    ("decoded_between", prt::decode),
    ("transfer_lobe", prt::lobe),
    ("transfer_lamps", prt::lamps),
    ("mask_four", mask::four),
    ("mask_cap", mask::cap),
    ("mask_directions", mask::directions),
    ("mask_boxes", mask::boxes),
    ("mask_own", mask::own),
    ("mask_lamp", mask::lamp),
    ("mask_lobe", mask_gloss::lobe),
    ("mask_lobe_light", mask_gloss::lobe_light),
];

/// Calls per test.
const CALLS: usize = 4096;

/// The tolerance that the table of kernels gives a file.
fn tolerance(shader: &str) -> f64 {
    let twin = KERNELS.iter().flat_map(|kernel| kernel.twins).find(|twin| twin.shader == shader);
    twin.expect("in the table").tolerance
}

/// All found are finite and differ by at most `tolerance` times the largest that is expected.
fn compare(what: &str, tolerance: f64, found: &[[f32; 4]], expected: &[f64], width: usize) -> Result<(), Failed> {
    let rows = width.div_ceil(4);
    let found: Vec<f64> = (found.chunks(rows))
        .flat_map(|rows| rows.as_flattened()[..width].iter().map(|&value| f64::from(value)))
        .collect();
    if found.len() != expected.len() {
        return Err(format!("{what}: {} values, not {}", found.len(), expected.len()).into());
    }
    let largest = expected.iter().fold(0.0f64, |most, value| most.max(value.abs()));
    for (place, (found, expected)) in found.iter().zip(expected).enumerate() {
        let off = (found - expected).abs();
        // NaN is more than any tolerance.
        if off.is_nan() || off > tolerance * largest {
            let (call, element) = (place / width, place % width);
            return Err(format!("{what}: call {call}, element {element}: {found:e}, not {expected:e}").into());
        }
    }
    Ok(())
}

/// Nothing is infinite or NaN, of calls that aren't compared either.
fn finite(found: &[[f32; 4]]) -> Result<(), Failed> {
    let off = found.iter().position(|row| row.iter().any(|value| !value.is_finite()));
    off.map_or(Ok(()), |row| Err(format!("row {row}: {:?}", found[row]).into()))
}

/// Compares calls that are of several kinds in turn, kind by kind: what one kind gives may be small beside another's.
fn compare_in_turn<K: Debug>(
    what: &str,
    kinds: &[K],
    tolerance: f64,
    found: &[[f32; 4]],
    expected: &[f64],
    width: usize,
) -> Result<(), Failed> {
    for (number, kind) in kinds.iter().enumerate() {
        let calls = found.chunks(width.div_ceil(4)).skip(number).step_by(kinds.len());
        let found: Vec<[f32; 4]> = calls.flatten().copied().collect();
        let calls = expected.chunks(width).skip(number).step_by(kinds.len());
        let expected: Vec<f64> = calls.flatten().copied().collect();
        compare(&format!("{what}, {kind:?}"), tolerance, &found, &expected, width)?;
    }
    Ok(())
}

/// A vector in rows of four.
fn rows(values: &[f64]) -> Vec<[f32; 4]> {
    values.chunks(4).map(|four| std::array::from_fn(|k| four.get(k).copied().unwrap_or(0.0) as f32)).collect()
}

/// The number that single precision makes of a number.
fn single(value: f64) -> f64 {
    f64::from(value as f32)
}

/// Numbers of either sign up to some magnitude, as the device gets them.
fn numbers(count: usize, most: f64, random: &mut Pcg64Mcg) -> Vec<f64> {
    (0..count).map(|_| single(most * random.random_range(-1.0..1.0))).collect()
}

/// Directions along all axes, then any.
fn axis_or_any(number: usize, random: &mut Pcg64Mcg) -> DVec3 {
    match number {
        0..6 => DVec3::AXES[number / 2] * if number.is_multiple_of(2) { 1.0 } else { -1.0 },
        _ => direction(random),
    }
}

fn direction(random: &mut Pcg64Mcg) -> DVec3 {
    let z: f64 = random.random_range(-1.0..1.0);
    let (sin, cos) = random.random_range(0.0..2.0 * PI).sin_cos();
    let across = (1.0 - z * z).sqrt();
    // As the device gets it.
    DVec3::new(across * cos, across * sin, z).as_vec3().as_dvec3()
}

/// Statements that make a vector of rows of the input.
fn taken(name: &str, first: &str) -> String {
    format!(
        "var {name}_parts: array<vec4f, SH_PARTS>;
        for (var k = 0u; k < SH_PARTS; k++) {{ {name}_parts[k] = input[{first} + k]; }}
        let {name} = sh_of_parts({name}_parts);"
    )
}

/// Statements that write a vector into rows of the output.
fn given(vector: &str, first: &str) -> String {
    format!(
        "{{ let parts = sh_parts({vector}); for (var k = 0u; k < SH_PARTS; k++) {{ output[{first} + k] = parts[k]; }} }}"
    )
}
