//! Shadow fields: places around an object, what is stored there, and how it is turned.

use super::{
    CALLS, compare, compare_in_turn, direction, given, numbers, rows,
    shadow_field_world::{OBJECTS, RADII, RESOLUTIONS, SHELLS, World, corners, point, shares, variables},
    single, taken, tolerance,
};
use glam::{DMat3, DVec3};
use halfshade_gpu::{Gpu, probe::Probe};
use halfshade_sh::{basis, wgsl::MAX_WGSL_BANDS};
use halfshade_strategies::shadow_field::arrays::{ObjectPlacement, Storage};
use libtest_mimic::Failed;
use rand::{RngExt, SeedableRng};
use rand_pcg::Pcg64Mcg;
use std::{
    f64::consts::{PI, TAU},
    sync::Arc,
};

/// From here on shaders call it as far.
const FARTHEST: f64 = 1e18;

/// Distance in radii, longitude and latitude as shares of the whole.
fn on_shells(offset: DVec3, inverse_radius: f64) -> [f64; 3] {
    let DVec3 { x, y, z } = offset;
    [(offset.length() * inverse_radius).min(FARTHEST), z.atan2(x) / TAU, x.hypot(z).atan2(y) / PI]
}

/// Relative to the centre, along the axes of an object.
fn object_axes(object: &ObjectPlacement, position: DVec3) -> DVec3 {
    let rows = object.object_from_light.map(|row| row.map(f64::from));
    let offset = position - DVec3::from(object.center.map(f64::from));
    DMat3::from_cols_array_2d(&rows).transpose() * offset
}

/// A point around the origin: there, on axes and next to them, next to the seam, in planes of axes, or anywhere.
fn around_origin(number: usize, random: &mut Pcg64Mcg) -> DVec3 {
    let sign = if number % 16 < 8 { 1.0 } else { -1.0 };
    let any = direction(random) * random.random_range(0.0..3.0);
    let place = match number % 8 {
        0 => DVec3::ZERO,
        1 => sign * DVec3::AXES[number / 16 % 3],
        2 => DVec3::new(1e-5 * any.x, sign, 1e-5 * any.z),
        3 => DVec3::new(-1.0, any.y, 1e-6 * sign),
        4 => any.with_x(0.0),
        5 => any.with_z(0.0),
        _ => any,
    };
    // No zero is negative.
    place + DVec3::ZERO
}

/// Points of any size, and so far out that only that is said.
pub(super) fn shell_coordinates(gpu: &Arc<Gpu>) -> Result<(), Failed> {
    let mut random = Pcg64Mcg::seed_from_u64(10);
    let shader = "shadow_field/shell_coordinates.wgsl";
    let probe = Probe {
        shader,
        bands: None,
        constants: &[],
        rows: [1, 1],
        body: "output[0] = vec4f(shell_coordinates(input[0].xyz, input[0].w), 0.0);",
        variables: &[],
    };
    let radii = [1e-15, 1e-6, 1.0, 1e6, 1e15];
    let points: Vec<(DVec3, f64)> = (0..CALLS)
        .map(|i| {
            let radius = radii[i % radii.len()];
            ((radius * around_origin(i / radii.len(), &mut random)).as_vec3().as_dvec3(), single(1.0 / radius))
        })
        .collect();
    let inputs: Vec<[f32; 4]> = points.iter().map(|(p, inverse)| p.extend(*inverse).as_vec4().to_array()).collect();
    let expected: Vec<f64> = points.iter().flat_map(|(point, inverse)| on_shells(*point, *inverse)).collect();
    let found = probe.call(gpu, &inputs)?;
    compare_in_turn("radius", &radii, tolerance(shader), &found, &expected, 3)?;
    let inputs: Vec<[f32; 4]> = (0..CALLS).map(|i| [1e15, -1e15, 1e15, 10f32.powi(i as i32 % 24)]).collect();
    let expected: Vec<f64> = (inputs.iter())
        .flat_map(|[x, y, z, inverse]| on_shells(DVec3::new((*x).into(), (*y).into(), (*z).into()), (*inverse).into()))
        .collect();
    // Distances as shares of what they are.
    let found: Vec<[f32; 4]> = (probe.call(gpu, &inputs)?.iter().zip(expected.chunks(3)))
        .map(|([distance, u, v, _], expected)| [distance / expected[0] as f32, *u, *v, 0.0])
        .collect();
    let expected: Vec<f64> = expected.chunks(3).flat_map(|place| [1.0, place[1], place[2]]).collect();
    compare("far out", tolerance(shader), &found, &expected, 3)
}

/// Distances in and between shells, at the centre, on the last shell and far beyond it.
fn distances(random: &mut Pcg64Mcg) -> Vec<f64> {
    let at = |i: usize| match i % 8 {
        0 => f64::from(RADII[i / 8 % SHELLS]),
        1 => single(f64::from(RADII[i / 8 % SHELLS]) * (1.0 - 1e-7)),
        2 => 10f64.powi(i as i32 % 19),
        _ => random.random_range(0.0..8.0),
    };
    (0..CALLS).map(at).map(single).collect()
}

/// Longitudes and latitudes: at the seam, the poles, points of grids, or anywhere.
fn longitude_and_latitude(number: usize, random: &mut Pcg64Mcg) -> [f64; 2] {
    let (u, v) = (random.random_range(-0.5..0.5), random.random_range(0.0..1.0));
    let place = match number % 8 {
        0 => [0.5, v],
        1 => [-0.5, v],
        2 => [u, 0.0],
        3 => [u, 1.0],
        4 => [(number / 8 % 33) as f64 / 32.0 - 0.5, (number / 264 % 33) as f64 / 32.0],
        _ => [u, v],
    };
    place.map(single)
}

/// Shares of shells and of points of their grids.
pub(super) fn shell_grid(gpu: &Arc<Gpu>) -> Result<(), Failed> {
    let mut random = Pcg64Mcg::seed_from_u64(11);
    let shader = "shadow_field/shell_grid.wgsl";
    let world = World::new(1, Storage::F32, 12);
    let buffers = world.buffers();
    let variables = variables(&buffers);
    let probe = |rows, body| Probe { shader, bands: None, constants: &[], rows, body, variables: &variables };
    let distances = distances(&mut random);
    let inputs: Vec<[f32; 4]> = (distances.iter().enumerate())
        .map(|(i, distance)| [*distance as f32, buffers.field(i % world.fields.len()) as f32, 0.0, 0.0])
        .collect();
    let body = "let pair = between_shells(field_at(u32(input[0].y)), input[0].x);
        for (var shell = 0u; shell < 8u; shell++) {
            let share = select(0.0, pair.without, shell == pair.outer) + select(0.0, pair.within, shell + 1u == pair.outer);
            output[shell / 4u][shell % 4u] = share;
        }";
    let found = probe([1, 2], body).call(gpu, &inputs)?;
    let expected: Vec<f64> = distances.iter().flat_map(|distance| shares(*distance)).collect();
    compare("shells", tolerance(shader), &found, &expected, SHELLS)?;

    let places: Vec<(usize, [f64; 2])> =
        (0..CALLS).map(|i| (RESOLUTIONS[i % SHELLS], longitude_and_latitude(i, &mut random))).collect();
    let inputs: Vec<[f32; 4]> =
        places.iter().map(|(resolution, [u, v])| [*u as f32, *v as f32, *resolution as f32, 0.0]).collect();
    let body = "let found = corners(u32(input[0].z), input[0].x, input[0].y);
        output[0] = vec4f(found.places);
        output[1] = found.weights;";
    let found = probe([1, 2], body).call(gpu, &inputs)?;
    // A function of the points, interpolated.
    let value = |place: usize| (place as f64 * 0.7).sin();
    let sum = |corners: [(usize, f64); 4]| corners.map(|(place, weight)| weight * value(place)).iter().sum::<f64>();
    let interpolated: Vec<[f32; 4]> = (found.as_chunks::<2>().0.iter())
        .map(|[places, weights]| {
            let corners = std::array::from_fn(|k| (places[k] as usize, f64::from(weights[k])));
            [sum(corners) as f32, 0.0, 0.0, 0.0]
        })
        .collect();
    let expected: Vec<f64> = places.iter().map(|(resolution, [u, v])| sum(corners(*resolution, *u, *v))).collect();
    compare("points", tolerance(shader), &interpolated, &expected, 1)
}

const STORAGES: [(Storage, f64); 3] = [(Storage::U8, 0.0), (Storage::F16, 1.0), (Storage::F32, 2.0)];

/// Every way of storing at every number of bands.
pub(super) fn reconstruct(gpu: &Arc<Gpu>) -> Result<(), Failed> {
    let mut random = Pcg64Mcg::seed_from_u64(13);
    let shader = "shadow_field/reconstruct.wgsl";
    let body = given("blocked_by(u32(input[0].w), input[0].xyz)", "0u");
    for bands in 1..=MAX_WGSL_BANDS {
        let count = bands * bands;
        for (storage, number) in STORAGES {
            let world = World::new(bands, storage, 14);
            let buffers = world.buffers();
            let places: Vec<(usize, [f64; 3])> = (distances(&mut random).into_iter().enumerate())
                .map(|(i, distance)| {
                    let [u, v] = longitude_and_latitude(i, &mut random);
                    (i % world.fields.len(), [distance, u, v])
                })
                .collect();
            let inputs: Vec<[f32; 4]> = (places.iter())
                .map(|(object, place)| {
                    let [distance, u, v] = place.map(|x| x as f32);
                    [distance, u, v, buffers.field(*object) as f32]
                })
                .collect();
            let found = Probe {
                shader,
                bands: Some(bands),
                constants: &[("STORAGE", number)],
                rows: [1, count.div_ceil(4)],
                body: &body,
                variables: &variables(&buffers),
            }
            .call(gpu, &inputs)?;
            let expected: Vec<f64> =
                places.iter().flat_map(|(object, place)| world.fields[*object].at(*place)).collect();
            compare(&format!("{storage:?}, {bands} bands"), tolerance(shader), &found, &expected, count)?;
        }
    }
    Ok(())
}

/// Vectors of any object turned into light space, and the visibility that they leave.
pub(super) fn rotate(gpu: &Arc<Gpu>) -> Result<(), Failed> {
    let mut random = Pcg64Mcg::seed_from_u64(15);
    let shader = "shadow_field/rotate.wgsl";
    for bands in 1..=MAX_WGSL_BANDS {
        let (count, parts) = (bands * bands, (bands * bands).div_ceil(4));
        let world = World::new(bands, Storage::U8, 16);
        let vectors: Vec<Vec<f64>> = (0..CALLS)
            .map(|i| {
                // Each object begins with nothing.
                let most = if i < OBJECTS { 0.0 } else { 1.0 };
                numbers(count, most, &mut random)
            })
            .collect();
        let inputs: Vec<[f32; 4]> = (vectors.iter().enumerate())
            .flat_map(|(i, vector)| rows(vector).into_iter().chain([[(i % OBJECTS) as f32, 0.0, 0.0, 0.0]]))
            .collect();
        let body = format!(
            "{} let turned = rotated(vector, u32(input[SH_PARTS].x)); {} {}",
            taken("vector", "0u"),
            given("turned", "0u"),
            given("visible_past(turned)", "SH_PARTS")
        );
        let found = Probe {
            shader,
            bands: Some(bands),
            constants: &[],
            rows: [parts + 1, 2 * parts],
            body: &body,
            variables: &variables(&world.buffers()),
        }
        .call(gpu, &inputs)?;
        let rotations: Vec<_> = world.turns.iter().map(|turn| world.sh_rotation(turn)).collect();
        let padded = |vector: Vec<f64>| vector.into_iter().chain(std::iter::repeat(0.0)).take(4 * parts);
        let expected: Vec<f64> = (vectors.iter().enumerate())
            .flat_map(|(i, vector)| {
                let turned = rotations[i % OBJECTS].apply(vector);
                let visible = basis::one(bands).iter().zip(&turned).map(|(one, blocked)| one - blocked).collect();
                padded(turned).chain(padded(visible)).collect::<Vec<_>>()
            })
            .collect();
        compare(&format!("{bands} bands"), tolerance(shader), &found, &expected, 8 * parts)?;
    }
    Ok(())
}

/// Occlusion by other objects around receivers, and by their own one between vertices.
pub(super) fn occlusion(gpu: &Arc<Gpu>) -> Result<(), Failed> {
    let mut random = Pcg64Mcg::seed_from_u64(17);
    let shader = "shadow_field/occlusion.wgsl";
    for bands in 1..=MAX_WGSL_BANDS {
        let (count, parts) = (bands * bands, (bands * bands).div_ceil(4));
        let world = World::new(bands, Storage::F32, 18);
        let others = world.fields.len();
        let positions: Vec<DVec3> = (0..CALLS)
            .map(|i| match i % 8 {
                0 => DVec3::from(world.objects[i % others].center.map(f64::from)),
                1 => 1e10 * direction(&mut random),
                _ => point(&mut random).as_dvec3(),
            })
            .collect();
        let inputs: Vec<[f32; 4]> = (positions.iter().enumerate())
            .map(|(i, position)| position.extend((i % others) as f64).as_vec4().to_array())
            .collect();
        let body = format!(
            "let own = own_of(Receiver(vec3f(0.0), vec3f(0.0), 0u, number)); {} {}
            output[2u * SH_PARTS].x = select(0.0, 1.0, own.is_known);",
            given("blocked_at(object_at(u32(input[0].w)), input[0].xyz)", "0u"),
            given("own.blocked", "SH_PARTS"),
        );
        let found = Probe {
            shader,
            bands: Some(bands),
            constants: &[("STORAGE", 2.0)],
            rows: [1, 2 * parts + 1],
            body: &body,
            variables: &variables(&world.buffers()),
        }
        .call(gpu, &inputs)?;
        let mesh = &world.scene.objects[0].mesh;
        let padded = |vector: Vec<f64>| vector.into_iter().chain(std::iter::repeat(0.0)).take(4 * parts);
        let expected: Vec<f64> = (positions.iter().zip(&world.receivers).enumerate())
            .flat_map(|(i, (position, (own, place)))| {
                let object = &world.objects[i % others];
                let on_shells = on_shells(object_axes(object, *position), object.inverse_radius.into());
                let around = place.weights_in_front(mesh);
                let mut sum = vec![0.0; count];
                for (vertex, weight) in around.iter().flat_map(|around| around.parts()) {
                    let values = &world.own[*own][vertex];
                    sum.iter_mut().zip(values).for_each(|(sum, value)| *sum += f64::from(weight) * value);
                }
                let is_known = f64::from(u8::from(around.is_some()));
                padded(world.fields[i % others].at(on_shells))
                    .chain(padded(sum))
                    .chain([is_known, 0.0, 0.0, 0.0])
                    .collect::<Vec<_>>()
            })
            .collect();
        compare(&format!("{bands} bands"), tolerance(shader), &found, &expected, 8 * parts + 4)?;
    }
    Ok(())
}
