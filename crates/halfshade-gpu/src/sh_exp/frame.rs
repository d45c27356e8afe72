//! The data of a frame, as kernels read it.

use super::tables::FrameUniforms;
use crate::{Gpu, GpuError, receivers::KernelSpace, rows::in_fours};
use bytemuck::{Pod, Zeroable};
use glam::Vec3;
use halfshade_strategies::sh_exp::{
    BakedScene,
    arrays::{Blocker, CombinationArrays, FrameArrays, GroundField, Lamp, LampPlace, SceneArrays},
};

/// A sphere, as `sh_exp/frame.wgsl` reads it.
#[repr(C)]
#[derive(Debug, Clone, Copy, Pod, Zeroable)]
#[expect(missing_docs, reason = "fields are told of in `sh_exp/frame.wgsl`")]
pub struct DeviceBlocker {
    pub center: [f32; 3],
    pub radius: f32,
    pub factors: [f32; 8],
    pub emitter: u32,
    pub reflection_factor: f32,
    pub padding: [u32; 2],
}

/// Rounds of loops after which a driver in software ends them, whatever is left to do.
const MOST_SOFTWARE_ROUNDS: usize = 65_535;

/// The space of the light, scaled to the spheres.
pub(super) fn space(baked: &BakedScene, arrays: &FrameArrays<'_>) -> KernelSpace {
    let spheres = baked.cuts().flatten();
    let extent = spheres.flat_map(|b| b.center.iter().map(|c| c.abs() + b.radius)).fold(0.0, f32::max);
    KernelSpace::around(arrays.center, arrays.rotation, f64::from(extent))
}

/// Refuses what a driver in software would leave half done.
pub(super) fn check_rounds(gpu: &Gpu, arrays: &SceneArrays<'_>, spheres: usize) -> Result<(), GpuError> {
    let of_shadows = match arrays.combination {
        // Ends of loops count as rounds, too.
        CombinationArrays::Shares { points } => spheres * (spheres + 2) * points.div_ceil(8) + 2 * spheres,
        _ => spheres,
    };
    let of_reflections = arrays.reflections.map_or(0, |reflections| {
        let order = if reflections.is_quadratic { 0 } else { spheres.div_ceil(8) };
        let nearer = if reflections.is_precomputed || reflections.is_quadratic { spheres } else { 0 };
        // Forty are those of an exponential, with its squarings.
        spheres * (order + nearer + 40)
    });
    if gpu.facts().is_software && of_shadows + of_reflections > MOST_SOFTWARE_ROUNDS {
        return Err(GpuError::Refused(format!(
            "{spheres} spheres are too many for a driver in software, which ends a receiver's loops after \
             {MOST_SOFTWARE_ROUNDS} rounds: take device `cpu`"
        )));
    }
    Ok(())
}

pub(super) fn blockers(baked: &BakedScene, space: &KernelSpace) -> Vec<DeviceBlocker> {
    baked.cuts().flatten().map(|blocker| scaled(blocker, space.scale)).collect()
}

fn scaled(blocker: &Blocker, scale: f64) -> DeviceBlocker {
    DeviceBlocker {
        center: blocker.center.map(|c| (f64::from(c) * scale) as f32),
        radius: (f64::from(blocker.radius) * scale) as f32,
        factors: blocker.factors,
        emitter: blocker.emitter,
        reflection_factor: blocker.reflection_factor,
        padding: [0; 2],
    }
}

/// Counts; first blocker and number of blockers of every cut; then, from the place that is returned, the masks of spheres that
/// don't cover each other, if there are any.
pub(super) fn numbers(baked: &BakedScene, arrays: &SceneArrays<'_>, counts: [u32; 8]) -> (Vec<u32>, u32) {
    let mut numbers = counts.to_vec();
    let mut first = 0;
    for cut in baked.cuts() {
        numbers.extend([first, cut.len() as u32]);
        first += cut.len() as u32;
    }
    let masks = numbers.len();
    let Some(reflections) = arrays.reflections.filter(|reflections| reflections.is_precomputed) else {
        return (numbers, masks as u32);
    };
    let neighbours = reflections.neighbours;
    numbers.resize(masks + 3 * neighbours.len(), 0);
    for (sphere, intersecting) in neighbours.iter().enumerate() {
        let (Some(&first), Some(&last)) = (intersecting.iter().min(), intersecting.iter().max()) else { continue };
        let (count, bits) = ((last - first + 1) as usize, numbers.len());
        numbers.resize(bits + count.div_ceil(32), 0);
        for &other in intersecting {
            let bit = (other - first) as usize;
            numbers[bits + bit / 32] |= 1 << (bit % 32);
        }
        numbers[masks + 3 * sphere..][..3].copy_from_slice(&[first, count as u32, bits as u32]);
    }
    (numbers, masks as u32)
}

/// Adds the lamps of a frame to `numbers`; gives the place at which they begin.
pub(super) fn add_lamps(numbers: &mut Vec<u32>, lamps: &[Lamp], space: &KernelSpace) -> u32 {
    let first = numbers.len() as u32;
    for lamp in lamps {
        let (place, size, is_far) = match lamp.place {
            LampPlace::Far { direction, sine } => (direction, sine, 1.0),
            LampPlace::Near { center, radius } => {
                let scaled = |value: f32| (f64::from(value) * space.scale) as f32;
                (center.map(scaled), scaled(radius), 0.0)
            }
        };
        let values = place.into_iter().chain([size]).chain(lamp.radiance.to_array()).chain([is_far]);
        numbers.extend(values.map(f32::to_bits));
    }
    first
}

/// Rows of four that hold a vector.
pub(super) fn rows_of(bands: usize) -> usize {
    (bands * bands).div_ceil(4)
}

/// Rows about the surroundings of an object, if there are any.
pub(super) fn ground_rows(scene: &SceneArrays<'_>, frame: &FrameArrays<'_>) -> u32 {
    if frame.ground[0].is_empty() { 0 } else { 4 + 2 * 12 * rows_of(scene.bands) as u32 }
}

/// The radiance of spheres that the processor has found, and the surroundings of objects, of which `uniforms` are told.
pub(super) fn radiating(
    scene: &SceneArrays<'_>,
    frame: &FrameArrays<'_>,
    space: &KernelSpace,
    uniforms: &mut FrameUniforms,
) -> Vec<[f32; 4]> {
    let count = scene.bands * scene.bands;
    let mut rows: Vec<[f32; 4]> = frame.radiance.chunks_exact(count).flat_map(in_fours).collect();
    let [seen, taken] = frame.ground;
    uniforms.ground = rows.len() as u32;
    let of_object = ground_rows(scene, frame) as usize;
    for (seen, taken) in seen.iter().zip(taken) {
        let end = rows.len() + of_object;
        if let (Some(seen), Some(taken)) = (seen, taken) {
            rows.extend(places_of(seen, space));
            let vectors = [seen, taken].map(|field| field.coefficients.iter().flatten());
            rows.extend(vectors.into_iter().flatten().flat_map(|vector| in_fours(vector)));
        }
        rows.resize(end, [0.0; 4]);
    }
    // Receivers on no object have none either.
    rows.resize(rows.len() + of_object, [0.0; 4]);
    rows
}

/// Where a field is known, and the gradients of its places.
fn places_of(field: &GroundField, space: &KernelSpace) -> [[f32; 4]; 4] {
    let scaled = |v: [f32; 3], scale: f64| (Vec3::from(v).as_dvec3() * scale).as_vec3();
    let [x, y, z] = field.axes.map(|axis| scaled(axis, space.scale.recip()).extend(0.0).to_array());
    [scaled(field.center, space.scale).extend(1.0).to_array(), x, y, z]
}
