//! Shadow fields: transfer past objects, local and distant light, glossy lobes as vectors.

use super::{
    CALLS, axis_or_any, compare, compare_in_turn, direction, given, numbers,
    receivers::{PlacedReceiver, ReceiverBuffers, lobe_rows, weighed},
    rows,
    shadow_field_world::{OBJECTS, World, point, variables},
    single, taken, tolerance,
};
use glam::{DVec3, Vec3};
use halfshade_gpu::{
    Gpu,
    probe::{Probe, Variable},
};
use halfshade_scene::Lobe;
use halfshade_sh::{basis, product, wgsl::MAX_WGSL_BANDS, zonal};
use halfshade_strategies::shadow_field::arrays::{Containment, Storage};
use libtest_mimic::Failed;
use rand::{RngExt, SeedableRng};
use rand_pcg::Pcg64Mcg;
use std::{
    f64::consts::{PI, TAU},
    sync::Arc,
};

/// Coefficients of the Legendre polynomials by power.
const LEGENDRE: [[f64; 6]; MAX_WGSL_BANDS] = [
    [1.0, 0.0, 0.0, 0.0, 0.0, 0.0],
    [0.0, 1.0, 0.0, 0.0, 0.0, 0.0],
    [-0.5, 0.0, 1.5, 0.0, 0.0, 0.0],
    [0.0, -1.5, 0.0, 2.5, 0.0, 0.0],
    [0.375, 0.0, -3.75, 0.0, 4.375, 0.0],
    [0.0, 1.875, 0.0, -8.75, 0.0, 7.875],
];

/// `max(a·v, 0)^e`: by band `2π ∫_0^1 x^e P_l(x) dx`.
fn power(bands: usize, axis: DVec3, exponent: f64) -> Vec<f64> {
    let mut vector = basis::evaluate(bands, axis.to_array());
    for (i, value) in vector.iter_mut().enumerate() {
        let terms = LEGENDRE[i.isqrt()].iter().zip(1u32..);
        *value *= TAU * terms.map(|(factor, power)| factor / (exponent + f64::from(power))).sum::<f64>();
    }
    vector
}

/// The clamped cosine over π.
fn cosine(bands: usize, normal: DVec3) -> Vec<f64> {
    let factors = zonal::reflectance(bands);
    let values = basis::evaluate(bands, normal.to_array()).into_iter().enumerate();
    values.map(|(i, value)| value * factors[i.isqrt()]).collect()
}

/// A power times the cosine, or times the hemisphere above.
fn shape(bands: usize, lobe: &Lobe, normal: DVec3) -> Vec<f64> {
    let above = match lobe.times_cosine {
        true => cosine(bands, normal).into_iter().map(|value| PI * value).collect(),
        false => power(bands, normal, 0.0),
    };
    product::product(&power(bands, lobe.axis.as_dvec3(), lobe.exponent.into()), &above)
}

/// Exponents from none to the sharpest.
pub(super) fn cosine_power(gpu: &Arc<Gpu>) -> Result<(), Failed> {
    let mut random = Pcg64Mcg::seed_from_u64(20);
    let shader = "shared/cosine_power.wgsl";
    let body = given("cosine_power(input[0].xyz, input[0].w)", "0u");
    for bands in 1..=MAX_WGSL_BANDS {
        let count = bands * bands;
        let probe = Probe {
            shader,
            bands: Some(bands),
            constants: &[],
            rows: [1, count.div_ceil(4)],
            body: &body,
            variables: &[],
        };
        let exponents = [0.0, 0.3, 1.0, 2.0, 3.0, 7.5, 60.0, 1e3, 1e4, 1e5].map(single);
        let calls: Vec<(DVec3, f64)> = (0..CALLS)
            .map(|i| (axis_or_any(i / exponents.len(), &mut random), exponents[i % exponents.len()]))
            .collect();
        let inputs: Vec<[f32; 4]> = calls.iter().map(|(axis, e)| axis.extend(*e).as_vec4().to_array()).collect();
        let found = probe.call(gpu, &inputs)?;
        let expected: Vec<f64> = calls.iter().flat_map(|(axis, exponent)| power(bands, *axis, *exponent)).collect();
        compare_in_turn(&format!("{bands} bands"), &exponents, tolerance(shader), &found, &expected, count)?;
    }
    Ok(())
}

/// Exponents of lobes; 0 stands for the cosine.
const SHARPNESS: [f32; 5] = [0.0, 1.0, 30.0, 1e3, 1e4];

/// Tolerance of products of which neither nothing nor all is left: a square root of rounding bounds the others.
const IN_PART: f64 = 1e-5;

/// A product of visibility and transfer.
struct Product {
    is_lobe: bool,
    shape: Vec<f64>,
    transfer: Vec<f64>,
    visible: Vec<f64>,
}

impl Product {
    /// Under the cosine, under a lobe, under nothing; of all transfer or of what another product left.
    fn new(number: usize, bands: usize, random: &mut Pcg64Mcg) -> Self {
        let (exponent, turn) = (SHARPNESS[number % SHARPNESS.len()], number / SHARPNESS.len());
        let normal = direction(random);
        let axis = (normal + direction(random)).normalize_or(normal).as_vec3();
        let lobe = Lobe { axis, exponent, scale: Vec3::ONE, times_cosine: turn % 2 == 0 };
        let is_lobe = exponent > 0.0;
        let shape = match turn % 64 {
            63 => vec![0.0; bands * bands],
            _ if is_lobe => shape(bands, &lobe, normal),
            _ => cosine(bands, normal),
        };
        let shape = singles(shape);
        let mut product =
            Self { is_lobe, transfer: shape.clone(), shape, visible: visibility(turn / 6, bands, random) };
        if turn / 6 % 3 > 0 {
            product.transfer = singles(product.bounded());
        }
        product.visible = visibility(turn, bands, random);
        product
    }

    /// The part that is left, before it is bounded.
    fn part(&self) -> f64 {
        let first = self.shape[0];
        if first == 0.0 { 0.0 } else { product::product(&self.visible, &self.transfer)[0] / first }
    }

    fn bounded(&self) -> Vec<f64> {
        let Self { is_lobe, shape, transfer, visible } = self;
        let before = if shape[0] == 0.0 { 0.0 } else { transfer[0] / shape[0] };
        let held = self.part().max(0.0).min(before.clamp(0.0, 1.0));
        let least = held.min(1.0 - held);
        let (room, bend) = if *is_lobe { (shape[0].abs() * (4.0 * PI).sqrt(), 1.0) } else { (1.0 / PI, 4.0 / 3.0) };
        let room = room * least * (1.0 - bend * least);
        let product = product::product(visible, transfer);
        let away: Vec<f64> = product.iter().zip(shape).map(|(product, shape)| product - held * shape).collect();
        let energy: f64 = away[1..].iter().map(|value| value * value).sum();
        let shrink = if energy > room { (room / energy).sqrt() } else { 1.0 };
        let mut limited: Vec<f64> = away.iter().zip(shape).map(|(away, shape)| held * shape + shrink * away).collect();
        limited[0] = held * shape[0];
        limited
    }

    fn rows(&self) -> Vec<[f32; 4]> {
        let vectors = [&self.shape, &self.transfer, &self.visible].into_iter().flat_map(|vector| rows(vector));
        vectors.chain([[f32::from(u8::from(self.is_lobe)), 0.0, 0.0, 0.0]]).collect()
    }
}

fn singles(vector: Vec<f64>) -> Vec<f64> {
    vector.into_iter().map(single).collect()
}

/// Visibility past nothing, everything, a cap, noise that no visibility is.
fn visibility(number: usize, bands: usize, random: &mut Pcg64Mcg) -> Vec<f64> {
    let noise = numbers(bands * bands, 3.0, random);
    let cap = zonal::blocker(bands, random.random_range(-1.0..1.0));
    singles(match number % 6 {
        0 => basis::one(bands),
        1 => vec![0.0; bands * bands],
        2 => noise,
        _ => zonal::rotate_to_axis(&cap, direction(random).to_array()),
    })
}

/// Products of every kind.
pub(super) fn bounded_product(gpu: &Arc<Gpu>) -> Result<(), Failed> {
    let mut random = Pcg64Mcg::seed_from_u64(21);
    let shader = "shadow_field/bounded_product.wgsl";
    let body = [
        taken("shape", "0u"),
        taken("transfer", "SH_PARTS"),
        taken("visible", "2u * SH_PARTS"),
        "var bound = diffuse_bound(shape); if (input[3u * SH_PARTS].x > 0.0) { bound = lobe_bound(shape); }".to_owned(),
        given("bounded_product(bound, transfer, visible)", "0u"),
    ]
    .concat();
    for bands in 1..=MAX_WGSL_BANDS {
        let (count, parts) = (bands * bands, (bands * bands).div_ceil(4));
        let calls: Vec<Product> = (0..CALLS).map(|i| Product::new(i, bands, &mut random)).collect();
        let inputs: Vec<[f32; 4]> = calls.iter().flat_map(Product::rows).collect();
        let mut found = Probe {
            shader,
            bands: Some(bands),
            constants: &[],
            rows: [3 * parts + 1, parts],
            body: &body,
            variables: &[],
        }
        .call(gpu, &inputs)?;
        let mut expected: Vec<f64> = calls.iter().flat_map(Product::bounded).collect();
        let what = format!("{bands} bands");
        compare_in_turn(&what, &SHARPNESS, tolerance(shader), &found, &expected, count)?;
        for (i, call) in calls.iter().enumerate() {
            if !(1e-3..1.0 - 1e-3).contains(&call.part()) {
                found[i * parts..(i + 1) * parts].fill([0.0; 4]);
                expected[i * count..(i + 1) * count].fill(0.0);
            }
        }
        compare_in_turn(&format!("{what}, in part"), &SHARPNESS, IN_PART, &found, &expected, count)?;
    }
    Ok(())
}

/// Numbers without rounding: lights around receivers, receivers on their surface, objects as far as lights.
pub(super) fn light_order(gpu: &Arc<Gpu>) -> Result<(), Failed> {
    let mut random = Pcg64Mcg::seed_from_u64(22);
    let shader = "shadow_field/light_order.wgsl";
    let world = World::new(1, Storage::U8, 23);
    let calls: Vec<(usize, usize, DVec3)> = (0..8 * CALLS)
        .map(|i| {
            let (light, object) = (i % world.lights.len(), i / 4 % OBJECTS);
            let center = DVec3::from(world.lights[light].center.map(f64::from));
            let position = match i % 5 {
                0 => center,
                1 => center + f64::from(world.lights[light].radius) * DVec3::AXES[i / 5 % 3],
                _ => point(&mut random).as_dvec3(),
            };
            (light, object, position)
        })
        .collect();
    let inputs: Vec<[f32; 4]> = (calls.iter())
        .flat_map(|(light, object, position)| {
            [position.extend(0.0).as_vec4().to_array(), [*light as f32, *object as f32, 0.0, 0.0]]
        })
        .collect();
    let body = "let light = light_at(u32(input[1].x) + 1u);
        let seen = see(light, input[0].xyz);
        let object = u32(input[1].y);
        output[0] = vec4f(
            select(0.0, 1.0, seen.is_around),
            select(0.0, 1.0, is_before(light, object, seen, input[0].xyz)),
            select(0.0, 1.0, is_behind_all(light, object, seen, input[0].xyz)),
            select(0.0, 1.0, light_at(0u).is_distant && !light.is_distant),
        );";
    let found =
        Probe { shader, bands: None, constants: &[], rows: [2, 1], body, variables: &variables(&world.buffers()) }
            .call(gpu, &inputs)?;
    let expected: Vec<f64> = (calls.iter())
        .flat_map(|&(light, object, position)| {
            let light = &world.lights[light];
            let squared = |center: [f32; 3]| (DVec3::from(center.map(f64::from)) - position).length_squared();
            let is_around = squared(light.center) <= f64::from(light.radius).powi(2);
            let is_before = |object: usize| match light.holds[object] {
                Containment::Outside if is_around => false,
                _ if is_around => true,
                Containment::Whole => false,
                _ => squared(world.objects[object].center) < squared(light.center),
            };
            let is_behind_all = (0..world.fields.len()).all(|other| other == object || is_before(other));
            [is_around, is_before(object), is_behind_all, true].map(|yes| f64::from(u8::from(yes)))
        })
        .collect();
    compare("lights", tolerance(shader), &found, &expected, 4)
}

/// Sines of angular radii; from 1 on a light is around a receiver.
const SINES: [f64; 8] = [1e-6, 1e-3, 0.05, 0.5, 0.9, 0.9999, 1.0, 2.0];

/// Caps of any size.
pub(super) fn light_cap(gpu: &Arc<Gpu>) -> Result<(), Failed> {
    let mut random = Pcg64Mcg::seed_from_u64(24);
    let shader = "shared/light_cap.wgsl";
    for bands in 1..=MAX_WGSL_BANDS {
        let (count, parts) = (bands * bands, (bands * bands).div_ceil(4));
        let probe = |rows, body, variables| Probe { shader, bands: Some(bands), constants: &[], rows, body, variables };
        let body = format!(
            "let squared = dot(input[0].xyz, input[0].xyz); {}",
            given("light_cap(input[0].xyz, squared, squared <= input[0].w * input[0].w, input[0].w)", "0u")
        );
        let calls: Vec<(DVec3, f64)> = (0..CALLS)
            .map(|i| {
                let distance = [1.0, 1e-12, 1e12][i / SINES.len() % 3];
                let sine = SINES[i % SINES.len()];
                let offset = distance * random.random_range(0.5..1.0) * direction(&mut random);
                match i {
                    0 => (DVec3::ZERO, 1.0),
                    // On its surface exactly.
                    _ if sine == 1.0 => (single(offset.x) * DVec3::AXES[i % 3], single(offset.x.abs())),
                    _ => (offset.as_vec3().as_dvec3(), single(offset.length() * sine)),
                }
            })
            .collect();
        let inputs: Vec<[f32; 4]> = calls.iter().map(|(o, radius)| o.extend(*radius).as_vec4().to_array()).collect();
        let found = probe([1, parts], &body, &[]).call(gpu, &inputs)?;
        let expected: Vec<f64> = (calls.iter())
            .flat_map(|(offset, radius)| {
                if offset.length() <= *radius {
                    return basis::one(bands);
                }
                let squared = radius * radius / offset.length_squared();
                let cap = zonal::cap_from_versine(bands, squared / (1.0 + (1.0 - squared).sqrt()));
                zonal::rotate_to_axis(&cap, offset.normalize().to_array())
            })
            .collect();
        compare_in_turn(&format!("{bands} bands"), &SINES, tolerance(shader), &found, &expected, count)?;
    }
    Ok(())
}

/// Distant light times transfer.
pub(super) fn light_product(gpu: &Arc<Gpu>) -> Result<(), Failed> {
    let mut random = Pcg64Mcg::seed_from_u64(28);
    let shader = "shadow_field/light_product.wgsl";
    for bands in 1..=MAX_WGSL_BANDS {
        let (count, parts) = (bands * bands, (bands * bands).div_ceil(4));
        let probe = |rows, body, variables| Probe { shader, bands: Some(bands), constants: &[], rows, body, variables };
        let world = World::new(bands, Storage::U8, 25);
        let vectors: Vec<Vec<f64>> = (0..CALLS).map(|_| numbers(count, 1.0, &mut random)).collect();
        let inputs: Vec<[f32; 4]> = vectors.iter().flat_map(|vector| rows(vector)).collect();
        let body = format!("{} output[0] = vec4f(distant_light(transfer), 0.0);", taken("transfer", "0u"));
        let found = probe([parts, 1], &body, &variables(&world.buffers())).call(gpu, &inputs)?;
        let expected: Vec<f64> = (vectors.iter())
            .flat_map(|vector| {
                [0, 1, 2].map(|channel| {
                    vector.iter().zip(&world.distant).map(|(value, light)| value * f64::from(light[channel])).sum()
                })
            })
            .collect();
        compare(&format!("{bands} bands, distant"), tolerance(shader), &found, &expected, 3)?;
    }
    Ok(())
}

/// Lobes of all models by their objects' tables, and their shapes.
pub(super) fn gloss(gpu: &Arc<Gpu>) -> Result<(), Failed> {
    let mut random = Pcg64Mcg::seed_from_u64(26);
    let shader = "shadow_field/gloss.wgsl";
    for bands in 1..=MAX_WGSL_BANDS {
        let (count, parts) = (bands * bands, (bands * bands).div_ceil(4));
        let world = World::new(bands, Storage::U8, 27);
        let buffers = world.buffers();
        let receivers: Vec<PlacedReceiver> =
            (0..CALLS / 4).map(|i| PlacedReceiver::random(i % OBJECTS, i, &mut random)).collect();
        let placed = ReceiverBuffers::new(&receivers, &world.scene);
        let variables: Vec<Variable<'_>> = variables(&buffers).into_iter().chain(placed.variables()).collect();
        let inputs: Vec<[f32; 4]> =
            (0..receivers.len()).map(|i| [i as f32, (i / OBJECTS % 3) as f32, 0.0, 0.0]).collect();
        let body = format!(
            "let receiver = receiver_at(u32(input[0].x));
            let lobe = lobe_of(u32(input[0].x), receiver, u32(input[0].y));
            let cosine = sh_times_bands(sh_basis(receiver.normal), sh_bands(frame.low_cosine, frame.high_cosine));
            output[0] = vec4f(lobe.axis, select(0.0, 1.0, lobe.times_cosine));
            output[1] = vec4f(lobe.scale, lobe.exponent);
            {}",
            given("sh_scaled(shape_of(lobe, receiver.normal, cosine), lobe.exponent + 1.0)", "2u")
        );
        let found = Probe {
            shader,
            bands: Some(bands),
            constants: &[],
            rows: [1, 2 + parts],
            body: &body,
            variables: &variables,
        }
        .call(gpu, &inputs)?;
        let (mut shown, mut expected) = (Vec::new(), Vec::new());
        for (i, (rows, receiver)) in found.chunks(2 + parts).zip(&receivers).enumerate() {
            let lobes = receiver.lobes(&world.scene);
            let (lobe, peak) = lobes.get(i / OBJECTS % 3).copied().unwrap_or((None, 1.0));
            shown.extend(weighed([rows[0], rows[1]], peak));
            expected
                .extend(weighed(lobe_rows(lobe.as_ref()), peak).as_flattened().iter().map(|&value| f64::from(value)));
            // A black lobe may have any shape.
            let lobe = lobe.filter(|lobe| f64::from(lobe.scale.max_element()) > 1e-6 * peak);
            let shape = lobe.map(|lobe| {
                let values = shape(bands, &lobe, receiver.normal(&world.scene));
                values.into_iter().map(|value| value * (f64::from(lobe.exponent) + 1.0)).collect()
            });
            shown.extend(rows[2..].iter().map(|row| if shape.is_some() { *row } else { row.map(|value| 0.0 * value) }));
            expected
                .extend(shape.unwrap_or(vec![0.0; count]).into_iter().chain(std::iter::repeat(0.0)).take(4 * parts));
        }
        compare(&format!("{bands} bands"), tolerance(shader), &shown, &expected, 8 + 4 * parts)?;
    }
    Ok(())
}
