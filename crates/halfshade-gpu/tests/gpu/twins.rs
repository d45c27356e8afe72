//! Functions of the shaders, one by one, beside double precision: random inputs and extremes.

use glam::{DVec3, Vec3};
use halfshade_gpu::{
    Gpu,
    kernels::KERNELS,
    probe::{Probe, Tables},
};
use halfshade_scene::{
    Environment, Scene,
    light::{OctahedralGrid, cap_irradiance},
    progress::Silent,
    spheres::{AdjustRule, COVER_HEIGHT, FADE_HEIGHT, adjust},
};
use halfshade_sh::{
    basis,
    blocker_table::{BlockerTable, Quantity},
    dispatch_bands,
    exponential::{Exponential, MAX_SQUARINGS, Method, SERIES_MAGNITUDE},
    kernel::MAX_BANDS,
    logarithm::DEFAULT_CLIP,
    product,
    wgsl::MAX_WGSL_BANDS,
    zonal,
};
use halfshade_strategies::{ShExp, sh_exp::arrays::FirstPass};
use halfshade_strategy::Strategy;
use libtest_mimic::Failed;
use rand::{RngExt, SeedableRng};
use rand_pcg::Pcg64Mcg;
use std::{f64::consts::PI, sync::Arc};
use wide::f32x8;

type Test = fn(&Arc<Gpu>) -> Result<(), Failed>;

pub(super) const TESTS: [(&str, Test); 8] = [
    ("vectors", vectors),
    ("tangent_plane", tangent_plane),
    ("blocker", blocker),
    ("exponential", exponential),
    ("cap", cap),
    ("octahedral", octahedral),
    ("random", random),
    ("near_zero", near_zero),
];

/// Calls per test.
const CALLS: usize = 4096;

/// Generated code has no file of its own; its functions are straight sums and products.
const GENERATED: f64 = 3e-6;

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
        let off = (found - expected).abs() / largest;
        // NaN is more than any tolerance.
        if off.is_nan() || off > tolerance {
            let (call, element) = (place / width, place % width);
            return Err(format!("{what}: call {call}, element {element}: {found:e}, not {expected:e}").into());
        }
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

fn direction(random: &mut Pcg64Mcg) -> DVec3 {
    let z: f64 = random.random_range(-1.0..1.0);
    let (sin, cos) = random.random_range(0.0..2.0 * PI).sin_cos();
    let across = (1.0 - z * z).sqrt();
    // As the device gets it.
    DVec3::new(across * cos, across * sin, z).as_vec3().as_dvec3()
}

/// Basis, lobes, products, squares at every number of bands.
fn vectors(gpu: &Arc<Gpu>) -> Result<(), Failed> {
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
            Probe { shader: "", bands: Some(bands), constants: &[], rows, body, tables: None }.call(gpu, inputs)
        };
        let directions: Vec<DVec3> = (0..CALLS)
            .map(|i| match i {
                0..6 => DVec3::AXES[i / 2] * if i % 2 == 0 { 1.0 } else { -1.0 },
                _ => direction(&mut random),
            })
            .collect();
        let inputs: Vec<[f32; 4]> = directions.iter().map(|d| d.as_vec3().extend(0.0).to_array()).collect();
        let expected: Vec<f64> = directions.iter().flat_map(|d| basis::evaluate(bands, d.to_array())).collect();
        let found = call(&give("sh_basis(input[0].xyz)"), 1, &inputs)?;
        compare(&format!("basis of {bands} bands"), GENERATED, &found, &expected, count)?;

        let pairs: Vec<[Vec<f64>; 2]> = (0..CALLS)
            .map(|_| std::array::from_fn(|_| (0..count).map(|_| single(random.random_range(-1.0..1.0))).collect()))
            .collect();
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

/// All rules, for spheres around, on and far below the receiver, of any size.
fn tangent_plane(gpu: &Arc<Gpu>) -> Result<(), Failed> {
    let mut random = Pcg64Mcg::seed_from_u64(2);
    let rules = [
        (AdjustRule::Continuous, 0.0, FADE_HEIGHT),
        (AdjustRule::Covering, 1.0, COVER_HEIGHT),
        (AdjustRule::Published, 2.0, 1.0),
    ];
    for (rule, number, full_height) in rules {
        for size in [1e-4, 1.0, 1e4] {
            let spheres: Vec<(DVec3, f64, DVec3)> = (0..CALLS)
                .map(|i| {
                    let distance = match i % 8 {
                        0 => 0.0,
                        1 => 1e-6,
                        2 => 1.0 - 1e-6,
                        3 => 1.0,
                        4 => 1e3,
                        _ => random.random_range(0.0..3.0),
                    };
                    let radius = single(size * random.random_range(0.1..1.0));
                    let offset = (direction(&mut random) * radius * distance).as_vec3().as_dvec3();
                    (offset, radius, direction(&mut random))
                })
                .collect();
            let inputs: Vec<[f32; 4]> = (spheres.iter())
                .flat_map(|(offset, radius, normal)| [offset.extend(*radius), normal.extend(0.0)])
                .map(|row| row.as_vec4().to_array())
                .collect();
            // Direction and size as seen are what counts: the squared sine, on the unit sphere.
            let body = "let found = adjusted(input[0].xyz, input[0].w, input[1].xyz);
                let squared = max(dot(found.offset, found.offset), SMALLEST);
                output[0] = vec4f(found.offset * inverseSqrt(squared), 1.0) * min(found.reach * found.reach / squared, 1.0);";
            let probe = Probe {
                shader: "shared/tangent_plane.wgsl",
                bands: None,
                constants: &[("RULE", number), ("FULL_HEIGHT", full_height)],
                rows: [2, 1],
                body,
                tables: None,
            };
            let expected: Vec<f64> = (spheres.iter())
                .flat_map(|&(offset, radius, normal)| {
                    let seen = adjust(rule, offset, radius, normal.normalize());
                    seen.map_or([0.0; 4], |seen| {
                        let squared = seen.sin_angular_radius().powi(2);
                        (seen.direction() * squared).extend(squared).to_array()
                    })
                })
                .collect();
            let found = probe.call(gpu, &inputs)?;
            // On the unit sphere a published sphere jumps where its centre crosses the plane; none of these does.
            compare(&format!("{rule:?}, size {size:e}"), tolerance(probe.shader), &found, &expected, 4)?;
        }
    }
    Ok(())
}

/// The tables of `sh-exp` with some settings.
fn tables(settings: &str) -> Result<Tables, Failed> {
    let scene = Scene::at_rest("empty", Vec::new(), Environment::constant(Vec3::ONE));
    let params = ShExp.info().parse(settings).map_err(|error| Failed::from(error.to_string()))?;
    let mut baked = ShExp::bake_scene(&scene, &params, &Silent).map_err(|error| Failed::from(error.to_string()))?;
    (baked.prepare_frame(&scene.frame(0), FirstPass::Here)).map_err(|error| Failed::from(error.to_string()))?;
    Ok(Tables::new(&baked.scene_arrays(), &baked.frame_arrays()))
}

/// Logarithms of blockers by angular radius, from a millionth to all of the hemisphere.
fn blocker(gpu: &Arc<Gpu>) -> Result<(), Failed> {
    for bands in 1..=MAX_WGSL_BANDS {
        let tables = tables(&format!("bands={bands}"))?;
        let sines: Vec<f64> = (0..CALLS).map(|i| single((i as f64 / (CALLS - 1) as f64).powi(3).max(1e-12))).collect();
        let inputs: Vec<[f32; 4]> = sines.iter().map(|&squared| [squared as f32, 0.0, 0.0, 0.0]).collect();
        let body = "var blocker = Blocker();
            blocker.low_factors = vec4f(1.0);
            blocker.high_factors = vec4f(1.0);
            let found = zonal(blocker, input[0].x, 0u);
            for (var l = 0u; l < SH_BANDS; l++) { output[l / 4u][l % 4u] = found[l]; }";
        let found = Probe {
            shader: "sh_exp/blocker.wgsl",
            bands: Some(bands),
            constants: &[],
            rows: [1, bands.div_ceil(4)],
            body,
            tables: Some((&tables.uniforms, &tables.rows)),
        }
        .call(gpu, &inputs)?;
        let logarithm = Quantity::Logarithm { clip: DEFAULT_CLIP };
        let expected: Vec<f64> = (sines.iter())
            .flat_map(|squared| {
                let versine = squared / (1.0 + (1.0 - squared).sqrt());
                let zonal = logarithm.zonal(bands, versine).into_iter().enumerate();
                zonal.map(|(l, value)| value * zonal::rotation_scale(l)).collect::<Vec<_>>()
            })
            .collect();
        // Where an eigenvalue meets the clip the logarithm bends within an interval of the table; elsewhere it is exact to 1e-4.
        let largest = expected.iter().fold(0.0f64, |most, value| most.max(value.abs()));
        let found_flat = found.chunks(bands.div_ceil(4)).flat_map(|rows| &rows.as_flattened()[..bands]);
        let is_off = |(found, expected): &(&f32, &f64)| (f64::from(**found) - **expected).abs() > 1e-4 * largest;
        let off = found_flat.zip(&expected).filter(is_off).count();
        if off > expected.len() / 50 {
            return Err(format!("{bands} bands: {off} of {} values are off", expected.len()).into());
        }
        let table = BlockerTable::build(bands, logarithm).ok_or("no table")?;
        let looked_up: Option<Vec<f64>> = dispatch_bands!(bands, N => {
            let lookup = |squared: &f64| table.lookup::<N>(f32x8::splat(*squared as f32));
            let of_bands = |all: [f32x8; MAX_BANDS]| all.into_iter().take(bands).map(|l| f64::from(l.as_array()[0]));
            sines.iter().map(lookup).flat_map(of_bands).collect()
        });
        let looked_up = looked_up.ok_or("no kernel")?;
        compare(&format!("{bands} bands, table"), tolerance("sh_exp/blocker.wgsl"), &found, &looked_up, bands)?;
    }
    Ok(())
}

/// Sums of none to thousands of blockers, and what no blockers give.
fn exponential(gpu: &Arc<Gpu>) -> Result<(), Failed> {
    let mut random = Pcg64Mcg::seed_from_u64(4);
    for bands in 1..=MAX_WGSL_BANDS {
        let count = bands * bands;
        let logarithm = Quantity::Logarithm { clip: DEFAULT_CLIP };
        let mut sums = vec![vec![0.0; count]];
        for number in [1, 2, 7, 60, 700] {
            for radius in [1e-6, 1e-3, 0.1, 0.5, 0.9, 1.57] {
                let lobe = logarithm.zonal(bands, 2.0 * f64::sin(0.5 * radius).powi(2));
                for is_one_place in [true, false] {
                    let mut sum = vec![0.0; count];
                    let place = direction(&mut random);
                    for _ in 0..number {
                        let axis = if is_one_place { place } else { direction(&mut random) };
                        let turned = zonal::rotate_to_axis(&lobe, axis.to_array());
                        sum.iter_mut().zip(turned).for_each(|(sum, value)| *sum += value);
                    }
                    sums.push(sum.into_iter().map(single).collect());
                }
            }
        }
        for magnitude in [1e3, 1e5, 1e6] {
            sums.push((0..count).map(|i| if i % 3 == 1 { magnitude } else { 0.0 }).collect());
        }
        let inputs: Vec<[f32; 4]> = sums.iter().flat_map(|sum| rows(sum)).collect();
        let forms = [
            ("hybrid,squaring=published", 2.0, Method::Hybrid { magnitude_limit: 8.0 / count as f64 }),
            ("hybrid", 2.0, Method::Hybrid { magnitude_limit: 8.0 / count as f64 }),
            ("optimal-linear", 2.0, Method::OptimalLinear),
            ("quadratic", 1.0, Method::Quadratic { magnitude_limit: 1.0 }),
            ("series", 0.0, Method::Series { terms: 9, magnitude_limit: Some(1.0) }),
        ];
        for (name, number, method) in forms {
            let is_blended = !name.ends_with("published");
            let tables = tables(&format!("bands={bands},exp={name}"))?;
            let limit = match method {
                Method::OptimalLinear => -1.0,
                Method::Hybrid { magnitude_limit } | Method::Quadratic { magnitude_limit } => magnitude_limit,
                Method::Series { magnitude_limit, .. } => magnitude_limit.unwrap_or(-1.0),
            };
            let constants = [
                ("METHOD", number),
                ("TERMS", 9.0),
                ("MAGNITUDE_LIMIT", limit),
                ("IS_BLENDED", f64::from(u8::from(is_blended))),
                ("MAX_SQUARINGS", f64::from(MAX_SQUARINGS)),
                ("SERIES_MAGNITUDE", SERIES_MAGNITUDE),
            ];
            let body = "var sum: array<vec4f, SH_PARTS>;
                for (var k = 0u; k < SH_PARTS; k++) { sum[k] = input[k]; }
                let parts = sh_parts(exponential(sh_of_parts(sum), shadow_form()));
                for (var k = 0u; k < SH_PARTS; k++) { output[k] = parts[k]; }";
            let found = Probe {
                shader: "sh_exp/exponential.wgsl",
                bands: Some(bands),
                constants: &constants,
                rows: [count.div_ceil(4); 2],
                body,
                tables: Some((&tables.uniforms, &tables.rows)),
            }
            .call(gpu, &inputs)?;
            let plain = Exponential::new(bands, method, DEFAULT_CLIP);
            let reference = if is_blended { plain.blended() } else { plain };
            let expected: Vec<f64> = sums.iter().flat_map(|sum| reference.evaluate(sum)).collect();
            let most = tolerance("sh_exp/exponential.wgsl");
            compare(&format!("{name} of {bands} bands"), most, &found, &expected, count)?;
        }
    }
    Ok(())
}

/// Caps above, at and below the horizon, from a millionth of a radian to half of all directions.
fn cap(gpu: &Arc<Gpu>) -> Result<(), Failed> {
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
            Probe { shader, bands: None, constants: &[], rows: [1, 1], body, tables: None }.call(gpu, &inputs)?;
        let expected: Vec<f64> = cosines.iter().map(|&cosine| cap_irradiance(cosine, sine)).collect();
        compare(&format!("sine {sine:e}"), tolerance(shader), &found, &expected, 1)?;
    }
    Ok(())
}

/// A function of the nodes, interpolated: also on axes and edges of cells.
fn octahedral(gpu: &Arc<Gpu>) -> Result<(), Failed> {
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
            Probe { shader, bands: None, constants: &[], rows: [1, 2], body, tables: None }.call(gpu, &inputs)?;
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

/// Fixed-point sequences in 64 bits, whose upper 24 the device gives.
fn random(gpu: &Arc<Gpu>) -> Result<(), Failed> {
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
    let found = Probe { shader, bands: None, constants: &[], rows: [1, 1], body, tables: None }.call(gpu, &inputs)?;
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

/// Quotients by the argument, which are near 1 however small it is.
fn near_zero(gpu: &Arc<Gpu>) -> Result<(), Failed> {
    let mut random = Pcg64Mcg::seed_from_u64(7);
    let numbers: Vec<f64> = (0..CALLS).map(|_| single(0.9 * 10f64.powf(random.random_range(-30.0..0.0)))).collect();
    let inputs: Vec<[f32; 4]> = numbers.iter().map(|&x| [x as f32, 0.0, 0.0, 0.0]).collect();
    let body = "let x = input[0].x;
        output[0] = vec4f(exp_minus_one(x), exp_minus_one(-x), log_one_minus(x), 0.0) / x;";
    let shader = "common/near_zero.wgsl";
    let found = Probe { shader, bands: None, constants: &[], rows: [1, 1], body, tables: None }.call(gpu, &inputs)?;
    let expected: Vec<f64> =
        numbers.iter().flat_map(|x| [x.exp_m1(), (-x).exp_m1(), (-x).ln_1p()].map(|y| y / x)).collect();
    compare("quotients", tolerance(shader), &found, &expected, 3)
}
