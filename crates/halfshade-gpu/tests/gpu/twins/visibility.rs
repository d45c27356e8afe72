//! Blocking by spheres: the tangent plane's rules, logarithms by angular radius, exponentials of their sums.

use super::{CALLS, compare, direction, given, rows, sh_exp::Frame, single, taken, tolerance};
use glam::DVec3;
use halfshade_gpu::{Gpu, probe::Probe};
use halfshade_scene::spheres::{AdjustRule, COVER_HEIGHT, FADE_HEIGHT, adjust};
use halfshade_sh::{
    blocker_table::{BlockerTable, Quantity},
    dispatch_bands,
    exponential::{Exponential, MAX_SQUARINGS, Method, SERIES_MAGNITUDE},
    kernel::MAX_BANDS,
    logarithm::DEFAULT_CLIP,
    wgsl::MAX_WGSL_BANDS,
    zonal,
};
use libtest_mimic::Failed;
use rand::{RngExt, SeedableRng};
use rand_pcg::Pcg64Mcg;
use std::sync::Arc;
use wide::f32x8;

/// All rules, for spheres around, on and far below the receiver, of any size.
pub(super) fn tangent_plane(gpu: &Arc<Gpu>) -> Result<(), Failed> {
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
                variables: &[],
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

/// Logarithms of blockers by angular radius, from a millionth to all of the hemisphere.
pub(super) fn blocker(gpu: &Arc<Gpu>) -> Result<(), Failed> {
    for bands in 1..=MAX_WGSL_BANDS {
        let frame = Frame::new(&format!("bands={bands},bounces=0"))?;
        let sines: Vec<f64> = (0..CALLS).map(|i| single((i as f64 / (CALLS - 1) as f64).powi(3).max(1e-12))).collect();
        let inputs: Vec<[f32; 4]> = sines.iter().map(|&squared| [squared as f32, 0.0, 0.0, 0.0]).collect();
        let give = |l: usize| format!("output[{}][{}] = found.h{l};", l / 4, l % 4);
        let body: String = std::iter::once("let found = zonal(input[0].x, 0u, vec4f(1.0), vec4f(1.0));".to_owned())
            .chain((0..bands).map(give))
            .collect();
        let found = Probe {
            shader: "sh_exp/blocker.wgsl",
            bands: Some(bands),
            constants: &[],
            rows: [1, bands.div_ceil(4)],
            body: &body,
            variables: &frame.variables(),
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
pub(super) fn exponential(gpu: &Arc<Gpu>) -> Result<(), Failed> {
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
            let frame = Frame::new(&format!("bands={bands},bounces=0,exp={name}"))?;
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
            let body = format!("{} {}", taken("sum", "0u"), given("exponential(sum, shadow_form())", "0u"));
            let found = Probe {
                shader: "sh_exp/exponential.wgsl",
                bands: Some(bands),
                constants: &constants,
                rows: [count.div_ceil(4); 2],
                body: &body,
                variables: &frame.variables(),
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
