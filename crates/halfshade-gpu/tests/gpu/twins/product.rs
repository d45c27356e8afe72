//! Rays by light times cosine: their numbers, cells of a map, weights between neighbours.

use super::{
    CALLS, compare, direction, finite,
    sampler::{Cap, about, cap_of, position, scenes, sun_cap},
    single, tolerance,
    traverse::ray_variables,
};
use glam::{DVec3, Vec3};
use halfshade_gpu::{
    Gpu,
    probe::{Probe, RayBuffers},
};
use halfshade_scene::{
    Environment, Object, Scene,
    builtin::shapes,
    light::{DistantLight, EnvironmentMap},
};
use halfshade_strategies::{
    RayTraced,
    ray_traced::arrays::{LightSampler, LightTree},
};
use halfshade_strategy::Strategy;
use libtest_mimic::Failed;
use rand::{RngExt, SeedableRng};
use rand_pcg::Pcg64Mcg;
use std::{
    f64::consts::{PI, TAU},
    sync::Arc,
};

/// Scrambled points bit by bit, the second coordinate by the columns of Pascal's triangle.
pub(super) fn sequence(gpu: &Arc<Gpu>) -> Result<(), Failed> {
    let shader = "ray_traced/sequence.wgsl";
    let numbers: Vec<u32> = (0..CALLS as u32).map(|i| if i < 64 { i } else { i.wrapping_mul(0x9e37_79b1) }).collect();
    // Whole numbers as two halves that single precision holds.
    let inputs: Vec<[f32; 4]> = numbers.iter().map(|n| [(n >> 16) as f32, (n & 0xffff) as f32, 0.0, 0.0]).collect();
    let body = "let halves = vec2u(input[0].xy);
        let receiver = (halves.x << 16u) | halves.y;
        output[0] = vec4f(sequence_point(receiver, 1u, 0u), sequence_offset(receiver), 0.0);";
    let found = Probe { shader, bands: None, constants: &[], rows: [1, 1], body, variables: &[] }.call(gpu, &inputs)?;
    let scrambled = |reversed: u32, seed: u32| {
        let hash = |x: u32, factor: u32| x ^ x.wrapping_mul(factor);
        let factors = [0x6c50_b47c, 0xb82f_1e52, 0xc7af_e638, 0x8d22_f6e6];
        factors.into_iter().fold(reversed.wrapping_add(seed), hash).reverse_bits()
    };
    let second = |number: u32| {
        // Column k of Sobol's second matrix, reversed: row k of Pascal's triangle.
        let mut row = 1u32;
        (0..32).fold(0, |sum, k| {
            let next = sum ^ if number >> k & 1 == 1 { row } else { 0 };
            row ^= row << 1;
            next
        })
    };
    let unit = |bits: u32| f64::from(bits >> 8) * 2f64.powi(-24);
    let expected: Vec<f64> = (numbers.iter())
        .flat_map(|&n| [scrambled(n, 0x9e37_79b9), scrambled(second(n), 0x7f4a_7c15), n.wrapping_mul(0x9e37_79b9)])
        .map(unit)
        .collect();
    compare("points", tolerance(shader), &found, &expected, 3)
}

/// Decisions nearer than this are left to rounding.
const DOUBT: f64 = 1e-4;

/// The halves of a number; `None` in doubt.
fn halved(number: f64, first: f64, second: f64) -> Option<(f64, usize, f64)> {
    let share = first / (first + second);
    let is_decided = (number - share).abs() > DOUBT
        && [0.0, 1.0].map(|end| (share - end).abs()).iter().all(|off| *off == 0.0 || *off > 0.01);
    let (half, place, own) =
        if number < share { (0, number / share, share) } else { (1, (number - share) / (1.0 - share), 1.0 - share) };
    is_decided.then_some((place, half, own))
}

/// A direction by the same tree in double precision, and its inverse density.
fn drawn(tree: &LightTree, map: &EnvironmentMap, normal: DVec3, [mut u, mut v]: [f64; 2]) -> Option<(DVec3, f64)> {
    let found = tree.grid.lookup(normal.as_vec3());
    let mut ranked = [0, 1, 2];
    ranked.sort_by(|a, b| found.weights[*b].total_cmp(&found.weights[*a]));
    if f64::from(found.weights[ranked[0]] - found.weights[ranked[1]]) < DOUBT {
        return None;
    }
    let count = tree.order.len();
    let sums: Vec<f64> = tree.sums[found.nodes[ranked[0]] * count..][..count].iter().map(|x| f64::from(*x)).collect();
    let total = sums[count - 1];
    let part = sums.iter().position(|sum| *sum > u * total)?;
    let before = if part == 0 { 0.0 } else { sums[part - 1] };
    let own = sums[part] - before;
    u = (u * total - before) / own;
    if !(DOUBT..1.0 - DOUBT).contains(&u) || own < 1e-3 * total {
        return None;
    }
    let mut chance = own / total;
    let cell = tree.order[part] as usize;
    let mut place = [cell % tree.largest[0], cell / tree.largest[0]];
    for level in 1..=tree.levels.len() {
        let weight = |right: usize, down: usize| {
            let (column, row) = (2 * place[0] + right, 2 * place[1] + down);
            let size = tree.levels.get(level).map_or(tree.size, |level| level.size);
            if column >= size[0] || row >= size[1] {
                return 0.0;
            }
            let Some(level) = tree.levels.get(level) else {
                let texel = map.texels()[row * size[0] + column].as_dvec3().element_sum();
                return texel * map.texel_solid_angle(row);
            };
            let cell = tree.cells[level.first + row * size[0] + column].as_dvec4();
            let (along, slack) = (normal.dot(cell.truncate()), cell.w * f64::from(level.across));
            let above = (along + slack).max(0.0);
            if along >= slack { along } else { above * above / (4.0 * slack) }
        };
        let rows = [[weight(0, 0), weight(1, 0)], [weight(0, 1), weight(1, 1)]];
        let (in_row, row, of_rows) = halved(v, rows[0][0] + rows[0][1], rows[1][0] + rows[1][1])?;
        let (in_column, column, of_columns) = halved(u, rows[row][0], rows[row][1])?;
        (u, v) = (in_column, in_row);
        chance *= of_rows * of_columns;
        place = [2 * place[0] + column, 2 * place[1] + row];
    }
    let edge = |row: usize| (PI * row as f64 / map.height() as f64).cos();
    let y = edge(place[1]) + v * (edge(place[1] + 1) - edge(place[1]));
    let (sin, cos) = (((place[0] as f64 + u) / map.width() as f64 - 0.5) * TAU).sin_cos();
    let across = (1.0 - y * y).max(0.0).sqrt();
    Some((DVec3::new(across * sin, y, -across * cos), map.texel_solid_angle(place[1]) / chance))
}

/// Maps with more texels than the largest cells, and with fewer, of odd sizes; with bright parts and black ones.
pub(super) fn light_tree(gpu: &Arc<Gpu>) -> Result<(), Failed> {
    let shader = "ray_traced/light_tree.wgsl";
    let mut random = Pcg64Mcg::seed_from_u64(42);
    let params = RayTraced.info().parse("").map_err(|error| Failed::from(error.to_string()))?;
    for (width, height) in [(64, 32), (37, 21), (16, 8), (5, 3)] {
        let texel = |i: usize| Vec3::new(0.5, 1.0, 2.0) * if i.is_multiple_of(3) { 0.0 } else { (i * 7 % 11) as f32 };
        let map = EnvironmentMap::new(width, height, (0..width * height).map(texel).collect());
        let map = map.ok_or("as many texels as it is large")?;
        let object = Object::new("box", shapes::cuboid(Vec3::ONE, [1; 3]));
        let scene = Scene::at_rest("light", vec![object], Environment::map(map));
        let frame = scene.frame(0);
        let (DistantLight::Map(map), Some(tree)) =
            (&scene.environment.base, LightSampler::new(&frame, None).with_tree().tree)
        else {
            return Err("no map".into());
        };
        let calls: Vec<(DVec3, [f64; 2])> = (0..CALLS)
            .map(|_| (direction(&mut random), [(); 2].map(|()| single(random.random_range(0.0..1.0)))))
            .collect();
        let inputs: Vec<[f32; 4]> = (calls.iter())
            .flat_map(|(normal, [u, v])| [*normal, DVec3::new(*u, *v, 0.0)])
            .map(|row| row.extend(0.0).as_vec4().to_array())
            .collect();
        let body = "let found = map_sample(input[0].xyz, input[1].xy);
            output[0] = vec4f(found.direction, found.inverse_density / 12.6);";
        let rays = RayBuffers::new(&frame, &params)?;
        let variables = ray_variables(&rays);
        let found = Probe { shader, bands: None, constants: &[], rows: [2, 1], body, variables: &variables }
            .call(gpu, &inputs)?;
        finite(&found)?;
        let (mut kept, mut expected) = (Vec::new(), Vec::new());
        for (found, (normal, point)) in found.iter().zip(&calls) {
            let Some((direction, inverse_density)) = drawn(&tree, map, *normal, *point) else { continue };
            // As shares of a mean, beyond which rounding counts for more.
            let size = inverse_density.max(12.6);
            kept.push([found[0], found[1], found[2], found[3] * (12.6 / size) as f32]);
            expected.extend(direction.extend(inverse_density / size).to_array());
        }
        if kept.len() < CALLS / 2 {
            return Err(format!("{width}: only {} calls are beyond doubt", kept.len()).into());
        }
        compare(&format!("{width} by {height}"), tolerance(shader), &kept, &expected, 4)?;
    }
    Ok(())
}

/// Rays to suns and lamps, those that hold the receiver among them, with light times cosine over their density.
pub(super) fn drawn_for_lights(gpu: &Arc<Gpu>) -> Result<(), Failed> {
    let shader = "ray_traced/product.wgsl";
    let mut random = Pcg64Mcg::seed_from_u64(44);
    let params = RayTraced.info().parse("").map_err(|error| Failed::from(error.to_string()))?;
    for (number, scene) in scenes(&mut random).iter().enumerate() {
        let frame = scene.frame(0);
        let sun = scene.environment.sun.map(|sun| (sun_cap(&sun), sun.radiance));
        let caps = |place: DVec3| -> Vec<Option<(Cap, Vec3)>> {
            let lamps = frame.lights.iter().map(|light| Some((cap_of(light, place), light.radiance)));
            [sun].into_iter().chain(lamps).collect()
        };
        let calls: Vec<([DVec3; 2], usize, [f64; 2])> = (0..CALLS)
            .map(|i| {
                let places = [position(i, &mut random), direction(&mut random)];
                let point = [(); 2].map(|()| single(random.random_range(0.0..1.0)));
                (places, i % (1 + frame.lights.len()), point)
            })
            .collect();
        let inputs: Vec<[f32; 4]> = (calls.iter())
            .flat_map(|([place, normal], light, [u, v])| {
                [place.extend(*light as f64), normal.extend(0.0), DVec3::new(*u, *v, 0.0).extend(0.0)]
            })
            .map(|row| row.as_vec4().to_array())
            .collect();
        let body = "let light = 1u + u32(input[0].w);
            let drawn = drawn_for(light, input[0].xyz, input[1].xyz, input[1].xyz, input[2].xy);
            output[0] = vec4f(drawn.direction, 0.0);
            output[1] = vec4f(drawn.arriving, 0.0);";
        let rays = RayBuffers::new(&frame, &params)?;
        let variables = ray_variables(&rays);
        let found = Probe { shader, bands: None, constants: &[], rows: [3, 2], body, variables: &variables }
            .call(gpu, &inputs)?;
        finite(&found)?;
        let (mut kept, mut expected) = (Vec::new(), Vec::new());
        for ([toward, arriving], ([place, normal], light, [u, v])) in found.as_chunks::<2>().0.iter().zip(&calls) {
            let Some(((axis, versine), radiance)) = caps(*place)[*light] else { continue };
            let Some(direction) = about(axis, u * versine, *v) else { continue };
            // As parts of the most that may arrive.
            let most = radiance.as_dvec3() * TAU * versine;
            let scale = most.max_element().recip();
            kept.extend([*toward, arriving.map(|value| value * scale as f32)]);
            let expected_light = most * normal.dot(direction).max(0.0) * scale;
            expected.extend([direction.extend(0.0), expected_light.extend(0.0)].iter().flat_map(|row| row.to_array()));
        }
        if !kept.is_empty() {
            compare(&format!("light {number}"), tolerance(shader), &kept, &expected, 8)?;
        }
    }
    Ok(())
}

/// Weights of neighbours near and far, on planes and on spheres; the same place twice.
pub(super) fn stops(gpu: &Arc<Gpu>) -> Result<(), Failed> {
    let shader = "ray_traced/stops.wgsl";
    let mut random = Pcg64Mcg::seed_from_u64(43);
    let calls: Vec<[DVec3; 5]> = (0..CALLS)
        .map(|i| {
            let normal = direction(&mut random);
            let bent = (normal + 0.4 * random.random_range(0.0..1.0) * direction(&mut random)).normalize();
            let aside = direction(&mut random);
            let flat = (aside - normal * normal.dot(aside)) + 0.3 * random.random_range(-1.0..1.0) * normal;
            let size = if i % 64 == 0 { 0.0 } else { 10f64.powf(random.random_range(-6.0..3.0)) };
            let shares =
                [(); 2].map(|()| DVec3::new(random.random_range(0.0..1.0), random.random_range(0.0..1.0), 0.5));
            [size * flat, normal, bent, shares[0], shares[1]].map(|vector| vector.as_vec3().as_dvec3())
        })
        .collect();
    let (turn, deviations_squared, variance) = (single(0.134), 9.0, single(0.02));
    let inputs: Vec<[f32; 4]> = calls.iter().flatten().map(|vector| vector.extend(0.0).as_vec4().to_array()).collect();
    let body = "output[0] = vec4f(along_surface(0.134, input[0].xyz, input[1].xyz, input[2].xyz),
        along_shares(9.0, input[3].xyz, input[4].xyz, 0.02), 0.0, 0.0);";
    let found = Probe { shader, bands: None, constants: &[], rows: [5, 1], body, variables: &[] }.call(gpu, &inputs)?;
    finite(&found)?;
    let expected: Vec<f64> = (calls.iter())
        .flat_map(|[offset, normal, other, share, far]| {
            let off = offset.dot(*normal).abs().max(offset.dot(*other).abs());
            let lifted = if off > 0.0 { 2.0 * (off / offset.length()).powi(2) } else { 0.0 };
            let near = (1.0 - (1.0 - normal.dot(*other)).max(lifted) / turn).max(0.0);
            let apart = (share.element_sum() - far.element_sum()) / 3.0;
            [near.powi(2), (1.0 - apart.powi(2) / (deviations_squared * variance + 1e-8)).max(0.0).powi(2)]
        })
        .collect();
    compare("weights", tolerance(shader), &found, &expected, 2)
}
