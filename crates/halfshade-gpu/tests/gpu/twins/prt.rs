//! Transfer times light.

use super::{CALLS, compare, compare_in_turn, tolerance};
use glam::DVec3;
use halfshade_gpu::{
    Gpu,
    probe::{ClusterBetween, ClusterUniforms, Probe, TransferBetween, TransferFrame, Variable, fit_rows},
};
use halfshade_sh::{
    basis,
    hemisphere::{Weight, fitted},
    wgsl::MAX_WGSL_BANDS,
    zonal,
};
use libtest_mimic::Failed;
use rand::{RngExt, SeedableRng};
use rand_pcg::Pcg64Mcg;
use std::sync::Arc;

/// Between random rows, of one vector and of three, of every number of bands.
pub(super) fn dot(gpu: &Arc<Gpu>) -> Result<(), Failed> {
    let shader = "prt/dot.wgsl";
    let mut random = Pcg64Mcg::seed_from_u64(61);
    for (bands, channels) in [(1, 1), (3, 3), (4, 1), (4, 3), (8, 1), (8, 3)] {
        let (count, parts): (usize, usize) = (bands * bands, (bands * bands).div_ceil(4));
        let mut vector = || -> Vec<f32> { (0..count).map(|_| random.random_range(-1.0..1.0)).collect() };
        let light = [vector(), vector(), vector()];
        let vectors: Vec<Vec<f32>> = (0..20 * channels).map(|_| vector()).collect();
        let fours = |vector: &Vec<f32>| {
            (0..parts)
                .map(|part| std::array::from_fn(|k| vector.get(4 * part + k).copied().unwrap_or(0.0)))
                .collect::<Vec<[f32; 4]>>()
        };
        let rows: Vec<[f32; 4]> = vectors.iter().flat_map(fours).collect();
        let chosen: Vec<[(usize, f32); 3]> = (0..CALLS)
            .map(|_| std::array::from_fn(|_| (random.random_range(0..20), random.random_range(-1.0..1.0))))
            .collect();
        let point = |chosen: &[(usize, f32); 3]| TransferBetween {
            rows: chosen.map(|(row, _)| (row * channels * parts) as u32),
            weights: chosen.map(|(_, weight)| weight),
            ..TransferBetween::default()
        };
        let points: Vec<TransferBetween> = chosen.iter().map(point).collect();
        let inputs: Vec<[f32; 4]> = (0..CALLS).map(|i| [i as f32, 0.0, 0.0, 0.0]).collect();
        let frame = TransferFrame::new(&light);
        let variables = [
            Variable::storage_struct(0, "frame", &frame),
            Variable::storage(1, "rows", &rows),
            Variable::storage(2, "points", &points),
        ];
        let constants = [("PARTS", parts as f64), ("CHANNELS", channels as f64)];
        let body = "output[0] = vec4f(transfer_dot(points[u32(input[0].x)]), 0.0);";
        let probe = Probe { shader, bands: None, constants: &constants, rows: [1, 1], body, variables: &variables };
        let product = |channel: usize, row: usize| -> f64 {
            let vector = &vectors[row * channels + channel.min(channels - 1)];
            vector.iter().zip(&light[channel]).map(|(t, l)| f64::from(*t) * f64::from(*l)).sum()
        };
        let expected: Vec<f64> = (chosen.iter())
            .flat_map(|chosen| {
                (0..3)
                    .map(|channel| chosen.iter().map(|(row, weight)| f64::from(*weight) * product(channel, *row)).sum())
            })
            .collect();
        let found = probe.call(gpu, &inputs)?;
        compare(&format!("{bands} bands, {channels} vectors"), tolerance(shader), &found, &expected, 3)?;
    }
    Ok(())
}

/// Between random rows of a compressed table, with as many weights as there may be, and with none.
pub(super) fn decode(gpu: &Arc<Gpu>) -> Result<(), Failed> {
    let shader = "prt/decode.wgsl";
    let mut random = Pcg64Mcg::seed_from_u64(62);
    for components in [0_usize, 1, 8, 192] {
        let scale = 1.0 / (components + 1) as f32;
        let mut number = || random.random_range(-1.0_f32..1.0);
        let products: Vec<[f32; 4]> = (0..6 * (components + 1)).map(|_| [number(), number(), number(), 0.0]).collect();
        let weights: Vec<f32> = (0..20 * components.max(1)).map(|_| scale * number()).collect();
        let shares: Vec<[f32; 3]> = (0..CALLS).map(|_| [number(), number(), number()]).collect();
        let mut chosen = |count: usize| -> [usize; 3] { std::array::from_fn(|_| random.random_range(0..count)) };
        let chosen: Vec<([usize; 3], [usize; 3])> = (0..CALLS).map(|_| (chosen(20), chosen(6))).collect();
        let point = |((rows, clusters), &weights): (&([usize; 3], [usize; 3]), &[f32; 3])| ClusterBetween {
            rows: rows.map(|row| (row * components) as u32),
            clusters: clusters.map(|cluster| (cluster * (components + 1)) as u32),
            weights,
            ..ClusterBetween::default()
        };
        let points: Vec<ClusterBetween> = chosen.iter().zip(&shares).map(point).collect();
        let inputs: Vec<[f32; 4]> = (0..CALLS).map(|i| [i as f32, 0.0, 0.0, 0.0]).collect();
        let frame = ClusterUniforms { components: components as u32, padding: [0; 3] };
        let variables = [
            Variable::storage_struct(0, "frame", &frame),
            Variable::storage(1, "row_weights", &weights),
            Variable::storage(2, "points", &points),
            Variable::storage(3, "products", &products),
        ];
        let body = "output[0] = vec4f(decoded_between(points[u32(input[0].x)]), 0.0);";
        let probe = Probe { shader, bands: None, constants: &[], rows: [1, 1], body, variables: &variables };
        let radiance = |row: usize, cluster: usize, channel: usize| -> f64 {
            let product = |k: usize| f64::from(products[cluster * (components + 1) + k][channel]);
            let terms = (0..components).map(|k| f64::from(weights[row * components + k]) * product(k + 1));
            product(0) + terms.sum::<f64>()
        };
        let expected: Vec<f64> = (chosen.iter().zip(&shares))
            .flat_map(|((rows, clusters), shares)| {
                (0..3).map(move |channel| {
                    (0..3).map(|k| f64::from(shares[k]) * radiance(rows[k], clusters[k], channel)).sum()
                })
            })
            .collect();
        let found = probe.call(gpu, &inputs)?;
        compare(&format!("{components} components"), tolerance(shader), &found, &expected, 3)?;
    }
    Ok(())
}

/// `max(axis·v, 0)^exponent` in eight bands, by the recurrence over degrees in double precision.
fn power(axis: DVec3, exponent: f64) -> Vec<f64> {
    let mut integrals = vec![1.0 / (exponent + 1.0), 1.0 / (exponent + 2.0)];
    for l in 2..8 {
        let degree = l as f64;
        integrals.push(integrals[l - 2] * (exponent - degree + 2.0) / (exponent + degree + 1.0));
    }
    let y = basis::evaluate(8, axis.to_array()).into_iter().enumerate();
    y.map(|(i, y)| std::f64::consts::TAU * integrals[i.isqrt()] * y).collect()
}

/// Lobes of every sharpness times a random matrix, of one channel and of three.
pub(super) fn lobe(gpu: &Arc<Gpu>) -> Result<(), Failed> {
    let shader = "prt/lobe.wgsl";
    let mut random = Pcg64Mcg::seed_from_u64(62);
    let exponents = [0.0_f32, 1.0, 7.5, 60.0, 1e3, 1e5];
    for (bands, channels, weight) in
        [(1, 1, Weight::Cosine), (3, 3, Weight::Equal), (4, 1, Weight::Cosine), (8, 3, Weight::Cosine)]
    {
        let (count, parts): (usize, usize) = (bands * bands, (bands * bands).div_ceil(4));
        let mut vector = || -> Vec<f32> { (0..count).map(|_| random.random_range(-1.0..1.0)).collect() };
        let light = [vector(), vector(), vector()];
        let matrix: Vec<Vec<f32>> = (0..channels * count).map(|_| vector()).collect();
        let fours = |vector: &Vec<f32>| -> Vec<[f32; 4]> {
            (0..parts).map(|part| std::array::from_fn(|k| vector.get(4 * part + k).copied().unwrap_or(0.0))).collect()
        };
        let fit = weight.fit(bands, 8);
        let single: Vec<f32> = fit.iter().map(|value| *value as f32).collect();
        let mut rows: Vec<[f32; 4]> = fit_rows(bands, &single);
        let first = rows.len();
        rows.extend(matrix.iter().flat_map(fours));
        let calls: Vec<(DVec3, f32)> = (0..CALLS)
            .map(|i| {
                let [x, y, z] = [(); 3].map(|()| random.random_range(-1.0..1.0));
                (DVec3::new(x, y, z).normalize_or(DVec3::Z).as_vec3().as_dvec3(), exponents[i % exponents.len()])
            })
            .collect();
        let inputs: Vec<[f32; 4]> = calls.iter().map(|(axis, e)| axis.as_vec3().extend(*e).to_array()).collect();
        let frame = TransferFrame::new(&light);
        let points = [TransferBetween::default()];
        let variables = [
            Variable::storage_struct(0, "frame", &frame),
            Variable::storage(1, "rows", &rows),
            Variable::storage(2, "points", &points),
        ];
        let constants = [("PARTS", parts as f64), ("CHANNELS", channels as f64), ("BANDS", bands as f64)];
        let body = format!("output[0] = vec4f(lobe_product({first}u, 0u, input[0].xyz, input[0].w), 0.0);");
        let probe =
            Probe { shader, bands: None, constants: &constants, rows: [1, 1], body: &body, variables: &variables };
        let expected: Vec<f64> = calls
            .iter()
            .flat_map(|(axis, exponent)| {
                let lobe = fitted(&fit, bands, 8, &power(*axis, f64::from(*exponent)));
                (0..3).map(move |channel| (channel, lobe.clone())).collect::<Vec<_>>()
            })
            .map(|(channel, lobe)| {
                let rows = matrix[count * channel.min(channels - 1)..].iter().zip(&lobe);
                let dot = |row: &Vec<f32>| -> f64 {
                    row.iter().zip(&light[channel]).map(|(m, l)| f64::from(*m) * f64::from(*l)).sum()
                };
                rows.map(|(row, b)| b * dot(row)).sum()
            })
            .collect();
        let found = probe.call(gpu, &inputs)?;
        let what = format!("{bands} bands, {channels} matrices");
        compare_in_turn(&what, &exponents, tolerance(shader), &found, &expected, 3)?;
    }
    Ok(())
}

/// Light of local lights at random places, within some, and what is infinitely far.
pub(super) fn lamps(gpu: &Arc<Gpu>) -> Result<(), Failed> {
    let shader = "prt/lamps.wgsl";
    let mut random = Pcg64Mcg::seed_from_u64(63);
    for bands in 1..=MAX_WGSL_BANDS {
        let (count, parts): (usize, usize) = (bands * bands, (bands * bands).div_ceil(4));
        let mut number = || random.random_range(-1.0_f32..1.0);
        let distant: [Vec<f32>; 3] = std::array::from_fn(|_| (0..count).map(|_| number()).collect());
        let lamps: Vec<[f32; 4]> = [0.02, 0.3, 1.1]
            .into_iter()
            .flat_map(|radius| [[number(), number(), number(), radius], [number(), number(), number(), 0.0]])
            .collect();
        let inputs: Vec<[f32; 4]> = (0..CALLS).map(|_| [2.0 * number(), 2.0 * number(), 2.0 * number(), 0.0]).collect();
        let frame = TransferFrame::new(&distant);
        let variables = [Variable::storage_struct(0, "frame", &frame), Variable::storage(3, "lamps", &lamps)];
        let constants = [("PARTS", parts as f64), ("LAMPS", 3.0)];
        let copies = (0..3 * parts).map(|row| {
            let place = 16 * (row / parts) + row % parts;
            format!("output[{row}] = light_part({place}u);")
        });
        let body = format!("gather_lamps(input[0].xyz); {}", copies.collect::<String>());
        let probe = Probe {
            shader,
            bands: Some(bands),
            constants: &constants,
            rows: [1, 3 * parts],
            body: &body,
            variables: &variables,
        };
        let found = probe.call(gpu, &inputs)?;
        let place = |row: &[f32; 4]| DVec3::new(row[0].into(), row[1].into(), row[2].into());
        let caps = |input: &[f32; 4]| {
            let of_lamp = |lamp: &[[f32; 4]]| {
                let offset = place(&lamp[0]) - place(input);
                let sine = f64::from(lamp[0][3]) / offset.length();
                let versine = if sine >= 1.0 { 2.0 } else { sine * sine / (1.0 + (1.0 - sine * sine).sqrt()) };
                zonal::rotate_to_axis(&zonal::cap_from_versine(bands, versine), offset.normalize().to_array())
            };
            lamps.chunks(2).map(of_lamp).collect::<Vec<_>>()
        };
        let expected: Vec<f64> = (inputs.iter())
            .flat_map(|input| {
                let caps = caps(input);
                let light = |channel: usize, i: usize| {
                    let lit = caps.iter().zip(lamps.chunks(2)).map(|(cap, lamp)| cap[i] * f64::from(lamp[1][channel]));
                    f64::from(distant[channel][i]) + lit.sum::<f64>()
                };
                // Rows of four, filled up with zeros.
                let padded = move |channel: usize, i: usize| if i < count { light(channel, i) } else { 0.0 };
                (0..12 * parts).map(move |k| padded(k / (4 * parts), k % (4 * parts))).collect::<Vec<_>>()
            })
            .collect();
        compare(&format!("{bands} bands"), tolerance(shader), &found, &expected, 12 * parts)?;
    }
    Ok(())
}
