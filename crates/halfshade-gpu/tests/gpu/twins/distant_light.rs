//! Light times visibility, and the radiance of objects without spheres.

use super::{axis_or_any, compare, direction, given, numbers, rows, sh_exp::Frame, single, taken, tolerance};
use glam::{DVec3, Vec3};
use halfshade_gpu::{Gpu, probe::Probe};
use halfshade_scene::light::{OctahedralGrid, cap_irradiance};
use halfshade_sh::{basis, product, wgsl::MAX_WGSL_BANDS, zonal};
use libtest_mimic::Failed;
use rand::{RngExt, SeedableRng};
use rand_pcg::Pcg64Mcg;
use std::{
    f64::consts::{PI, TAU},
    sync::Arc,
};

/// Receivers per light.
const RECEIVERS: usize = 512;

/// Radiance of a white receiver by normal and visibility; its parts are held between 0 and unshadowed, or not.
type Reflected = dyn Fn(DVec3, &[f64], bool) -> DVec3;

/// A light on the device, and in double precision.
struct Light {
    name: String,
    frame: Frame,
    reflected: Box<Reflected>,
    /// Direction around whose horizon most normals are, and how far from it.
    horizon: (DVec3, f64),
}

fn held(value: f64, most: f64, is_clamped: bool) -> f64 {
    if is_clamped { value.max(0.0).min(most) } else { value }
}

/// Constant light, maps, suns; at four bands also of extreme radiance.
pub(super) fn light(gpu: &Arc<Gpu>) -> Result<(), Failed> {
    let mut random = Pcg64Mcg::seed_from_u64(11);
    for bands in 1..=MAX_WGSL_BANDS {
        let mut lights = vec![
            constant(bands, 1.0)?,
            map(bands, 1, 32, 1.0, &mut random)?,
            map(bands, 3, 2, 1.0, &mut random)?,
            sun(bands, 0.00465, 1.0, &mut random)?,
        ];
        if bands == 4 {
            for scale in [1e-20, 1e20] {
                lights.push(constant(bands, scale)?);
                lights.push(map(bands, 3, 8, scale, &mut random)?);
                lights.push(sun(bands, 0.3, scale, &mut random)?);
            }
            lights.push(sun(bands, 1e-4, 1.0, &mut random)?);
            lights.push(sun(bands, 1.5, 1.0, &mut random)?);
        }
        for light in &lights {
            for is_clamped in [false, true] {
                hold(gpu, bands, light, is_clamped, &mut random)?;
            }
        }
    }
    Ok(())
}

fn hold(gpu: &Arc<Gpu>, bands: usize, light: &Light, is_clamped: bool, random: &mut Pcg64Mcg) -> Result<(), Failed> {
    let receivers: Vec<(Vec3, Vec<f64>)> = (0..RECEIVERS)
        .map(|i| {
            let normal =
                if i % 2 == 0 { axis_or_any(i / 2, random).as_vec3() } else { next_to_horizon(light.horizon, random) };
            (normal, visibility(bands, i, random))
        })
        .collect();
    let inputs: Vec<[f32; 4]> = (receivers.iter())
        .flat_map(|(normal, visibility)| [vec![normal.extend(0.0).to_array()], rows(visibility)].concat())
        .collect();
    let shader = "sh_exp/light.wgsl";
    let found = Probe {
        shader,
        bands: Some(bands),
        constants: &[("IS_CLAMPED", f64::from(u8::from(is_clamped)))],
        rows: [1 + (bands * bands).div_ceil(4), 1],
        body: &format!("{} output[0] = vec4f(light(input[0].xyz, visibility), 0.0);", taken("visibility", "1u")),
        variables: &light.frame.variables(),
    }
    .call(gpu, &inputs)?;
    let expected: Vec<f64> = (receivers.iter())
        .flat_map(|(normal, visibility)| (light.reflected)(normal.as_dvec3(), visibility, is_clamped).to_array())
        .collect();
    let what = format!("{} at {bands} bands, clamped: {is_clamped}", light.name);
    compare(&what, tolerance(shader), &found, &expected, 3)
}

/// Normals that see some of a cap about a direction above their horizon, or just none.
fn next_to_horizon((center, sine): (DVec3, f64), random: &mut Pcg64Mcg) -> Vec3 {
    let height = (sine * random.random_range(-1.1..1.1)).clamp(-1.0, 1.0);
    let side = center.cross(direction(random)).normalize();
    (center * height + side * (1.0 - height * height).sqrt()).as_vec3()
}

/// All open, nothing, then any.
fn visibility(bands: usize, number: usize, random: &mut Pcg64Mcg) -> Vec<f64> {
    match number % 8 {
        0 => basis::one(bands).into_iter().map(single).collect(),
        1 => vec![0.0; bands * bands],
        _ => numbers(bands * bands, 1.0, random),
    }
}

fn constant(bands: usize, scale: f64) -> Result<Light, Failed> {
    let mut frame = Frame::new(&format!("bands={bands},bounces=0"))?;
    let radiance = (DVec3::new(0.3, 1.0, 2.0) * scale).as_vec3();
    frame.tables.uniforms.light = radiance.extend(0.0).to_array();
    let cosine: Vec<f64> = zonal::clamped_cosine(bands).into_iter().map(|value| value / PI).collect();
    let reflected = move |normal: DVec3, visibility: &[f64], is_clamped: bool| {
        let share = basis::dot(&zonal::rotate_to_axis(&cosine, normal.to_array()), visibility);
        radiance.as_dvec3() * held(share, 1.0, is_clamped)
    };
    let name = format!("constant light times {scale:e}");
    Ok(Light { name, frame, reflected: Box::new(reflected), horizon: (DVec3::Y, 0.1) })
}

/// Any vectors at the nodes, more light than none.
fn map(bands: usize, channels: usize, cells: usize, scale: f64, random: &mut Pcg64Mcg) -> Result<Light, Failed> {
    let mut frame = Frame::new(&format!("bands={bands},bounces=0"))?;
    let nodes = OctahedralGrid::new(cells).node_count();
    let mut vectors: Vec<Vec<f64>> = (0..nodes * channels).map(|_| numbers(bands * bands, scale, random)).collect();
    vectors.iter_mut().for_each(|vector| vector[0] = vector[0].abs());
    frame.numbers[0] = channels as u32;
    frame.tables.uniforms.grid_cells = cells as f32;
    frame.tables.uniforms.light_table = frame.add_rows(vectors.iter().flat_map(|vector| rows(vector)));
    let reflected = move |normal: DVec3, visibility: &[f64], is_clamped: bool| {
        let corners = corners(cells, normal);
        DVec3::from_array(std::array::from_fn(|channel| {
            let vector = |node: usize| &vectors[node * channels + channel % channels];
            let sum = corners.iter().map(|&(node, weight)| weight * basis::dot(vector(node), visibility)).sum();
            let first: f64 = corners.iter().map(|&(node, weight)| weight * vector(node)[0]).sum();
            held(sum, first * (4.0 * PI).sqrt(), is_clamped)
        }))
    };
    let name = format!("a map of {channels} channels and {cells} cells times {scale:e}");
    Ok(Light { name, frame, reflected: Box::new(reflected), horizon: (DVec3::Y, 0.1) })
}

/// The nodes of an octahedral grid around a direction, and their weights.
fn corners(cells: usize, direction: DVec3) -> [(usize, f64); 3] {
    let on_octahedron = direction.abs() / direction.abs().element_sum();
    let (x, z) = (on_octahedron.x, on_octahedron.z);
    let (a, b) = if direction.y >= 0.0 { (x, z) } else { (1.0 - z, 1.0 - x) };
    let (a, b) = (a * cells as f64, b * cells as f64);
    let (i, j) = ((a as usize).min(cells - 1), (b as usize).min(cells - 1));
    let (s, t) = (a - i as f64, b - j as f64);
    let node = |i: usize, j: usize| {
        let from_middle = |i: usize, along: f64| if along < 0.0 { cells - i } else { cells + i };
        from_middle(j, direction.z) * (2 * cells + 1) + from_middle(i, direction.x)
    };
    if s + t <= 1.0 {
        [(node(i, j), 1.0 - s - t), (node(i + 1, j), s), (node(i, j + 1), t)]
    } else {
        [(node(i + 1, j + 1), s + t - 1.0), (node(i + 1, j), 1.0 - t), (node(i, j + 1), 1.0 - s)]
    }
}

fn sun(bands: usize, radius: f64, scale: f64, random: &mut Pcg64Mcg) -> Result<Light, Failed> {
    let mut frame = Frame::new(&format!("bands={bands},bounces=0"))?;
    let center = direction(random);
    let sine = single(radius.sin());
    let perpendicular = (DVec3::new(3.0, 2.0, 1.0) * scale).as_vec3();
    let versine = 2.0 * (0.5 * radius).sin().powi(2);
    let mean: Vec<f64> = zonal::cap_from_versine(bands, versine).iter().map(|g| g / (TAU * versine)).collect();
    let mean = zonal::rotate_to_axis(&mean, center.to_array());
    frame.numbers[3] = 1;
    frame.tables.uniforms.light = [0.0; 4];
    frame.tables.uniforms.sun_table = frame.add_rows(rows(&mean));
    frame.tables.uniforms.sun_direction = center.as_vec3().extend(0.0).to_array();
    frame.tables.uniforms.sun_perpendicular = perpendicular.extend(sine as f32).to_array();
    let reflected = move |normal: DVec3, visibility: &[f64], is_clamped: bool| {
        let cosine = center.dot(normal);
        let is_cut = cosine.abs() < sine;
        let facing = if is_cut { cap_irradiance(cosine, sine) / (PI * sine * sine) } else { cosine.max(0.0) };
        perpendicular.as_dvec3() * held(basis::dot(&mean, visibility), 1.0, is_clamped) * facing
    };
    let name = format!("a sun of {radius} times {scale:e}");
    Ok(Light { name, frame, reflected: Box::new(reflected), horizon: (center, sine) })
}

/// Objects of any size whose surroundings are known, and one whose aren't.
pub(super) fn ground(gpu: &Arc<Gpu>) -> Result<(), Failed> {
    let mut random = Pcg64Mcg::seed_from_u64(12);
    for bands in 1..=MAX_WGSL_BANDS {
        surroundings(gpu, bands, &mut random)?;
        visible_reflectance(gpu, bands, &mut random)?;
    }
    Ok(())
}

/// Surroundings of an object as they are known: radiance and its changes along three gradients, each channel by channel.
struct Surroundings {
    center: Vec3,
    gradients: [Vec3; 3],
    /// With the ground, and with a black one.
    fields: [[[Vec<f64>; 3]; 4]; 2],
}

impl Surroundings {
    fn new(bands: usize, [size, radiance]: [f64; 2], random: &mut Pcg64Mcg) -> Self {
        let mut vector = || numbers(bands * bands, radiance, random);
        let fields = std::array::from_fn(|_| std::array::from_fn(|_| std::array::from_fn(|_| vector())));
        let center = (direction(random) * size).as_vec3();
        Self { center, gradients: std::array::from_fn(|_| (direction(random) / size).as_vec3()), fields }
    }

    fn rows(&self) -> Vec<[f32; 4]> {
        let places = [self.center.extend(1.0)].into_iter().chain(self.gradients.map(|gradient| gradient.extend(0.0)));
        let vectors = self.fields.as_flattened().as_flattened();
        places.map(|row| row.to_array()).chain(vectors.iter().flat_map(|vector| rows(vector))).collect()
    }

    /// With the ground, then with a black one.
    fn radiance(&self, position: Vec3, weights: &[f64]) -> [DVec3; 2] {
        let offset = position.as_dvec3() - self.center.as_dvec3();
        let [x, y, z] = self.gradients.map(|gradient| gradient.as_dvec3().dot(offset));
        self.fields.each_ref().map(|field| {
            let places = field.iter().zip([1.0, x, y, z]);
            let radiance = places.map(|(channels, along)| {
                DVec3::from_array(channels.each_ref().map(|vector| along * basis::dot(vector, weights)))
            });
            radiance.sum()
        })
    }
}

fn surroundings(gpu: &Arc<Gpu>, bands: usize, random: &mut Pcg64Mcg) -> Result<(), Failed> {
    let shader = "sh_exp/ground.wgsl";
    let parts = (bands * bands).div_ceil(4);
    for [size, radiance] in [[1.0, 1.0], [1e-4, 1e20], [1e4, 1e-20]] {
        let mut frame = Frame::new(&format!("bands={bands},bounces=0"))?;
        let objects: [Surroundings; 3] = std::array::from_fn(|_| Surroundings::new(bands, [size, radiance], random));
        // Something that is in the buffer before, and an object of which nothing is known after.
        frame.radiating = vec![[7.0; 4]; 5];
        frame.tables.uniforms.ground = 5;
        frame.radiating.extend(objects.iter().flat_map(Surroundings::rows));
        let of_object = 4 + 24 * parts;
        frame.numbers[2] = of_object as u32;
        frame.radiating.resize(5 + 4 * of_object, [0.0; 4]);
        let calls: Vec<(usize, Vec3, Vec<f64>)> = (0..RECEIVERS)
            .map(|i| {
                let position = (direction(random) * size * random.random_range(0.0..3.0)).as_vec3();
                (i % 4, position, visibility(bands, i / 4, random))
            })
            .collect();
        let inputs: Vec<[f32; 4]> = (calls.iter())
            .flat_map(|(object, position, weights)| {
                [vec![position.extend(*object as f32).to_array()], rows(weights)].concat()
            })
            .collect();
        let body = taken("weights", "1u")
            + "let object = u32(input[0].w);
            if (has_ground(object)) {
                let position = input[0].xyz;
                output[0] = vec4f(ground_radiance(object, position, weights, true), 0.0);
                output[1] = vec4f(ground_radiance(object, position, weights, false), 0.0);
            }";
        let variables = frame.variables();
        let found = Probe {
            shader,
            bands: Some(bands),
            constants: &[],
            rows: [1 + parts, 2],
            body: &body,
            variables: &variables,
        }
        .call(gpu, &inputs)?;
        let expected: Vec<f64> = (calls.iter())
            .flat_map(|(object, position, weights)| {
                let known = objects.get(*object).map(|known| known.radiance(*position, weights));
                known.unwrap_or_default().map(|radiance| radiance.extend(0.0).to_array()).concat()
            })
            .collect();
        compare(&format!("{bands} bands, size {size:e}"), tolerance(shader), &found, &expected, 8)?;
    }
    Ok(())
}

fn visible_reflectance(gpu: &Arc<Gpu>, bands: usize, random: &mut Pcg64Mcg) -> Result<(), Failed> {
    let shader = "sh_exp/ground.wgsl";
    let count = bands * bands;
    let frame = Frame::new(&format!("bands={bands}"))?;
    let receivers: Vec<(Vec3, Vec<f64>)> =
        (0..RECEIVERS).map(|i| (axis_or_any(i, random).as_vec3(), visibility(bands, i, random))).collect();
    let inputs: Vec<[f32; 4]> = (receivers.iter())
        .flat_map(|(normal, visibility)| [vec![normal.extend(0.0).to_array()], rows(visibility)].concat())
        .collect();
    let found = Probe {
        shader,
        bands: Some(bands),
        constants: &[],
        rows: [1 + count.div_ceil(4), count.div_ceil(4)],
        body: &(taken("visibility", "1u") + &given("visible_reflectance(input[0].xyz, visibility)", "0u")),
        variables: &frame.variables(),
    }
    .call(gpu, &inputs)?;
    let cosine: Vec<f64> = zonal::clamped_cosine(bands).into_iter().map(|value| value / PI).collect();
    let expected: Vec<f64> = (receivers.iter())
        .flat_map(|(normal, visibility)| {
            product::product(&zonal::rotate_to_axis(&cosine, normal.as_dvec3().to_array()), visibility)
        })
        .collect();
    compare(&format!("visible reflectance of {bands} bands"), tolerance(shader), &found, &expected, count)
}
