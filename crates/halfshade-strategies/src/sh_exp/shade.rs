//! The inner loops: eight receivers side by side, one sphere after another.

use super::{Combination, Prepared, exposed::Exposure, reflections::Gather};
use halfshade_scene::{RadianceMut, Receivers};
use halfshade_sh::kernel::{self, LANES, ShBatch};
use wide::f32x8;

/// Shades all receivers. Each lane's result depends on its own receiver alone, so that batches may be split anywhere; the
/// last group is filled up with copies of its last receiver.
pub(super) fn shade<const N: usize>(prepared: &Prepared, receivers: Receivers<'_>, out: RadianceMut<'_>) {
    let count = receivers.len();
    let center = prepared.blockers.center;
    let rotation = prepared.blockers.rotation.transpose().to_cols_array().map(|value| f32x8::splat(value as f32));
    // Row `axis` of the rotation times a vector.
    let turn = |v: [f32x8; 3]| -> [f32x8; 3] {
        std::array::from_fn(|axis| {
            rotation[3 * axis].mul_add(v[0], rotation[3 * axis + 1].mul_add(v[1], rotation[3 * axis + 2] * v[2]))
        })
    };
    let mut exposure = match prepared.combination {
        Combination::Shares { points } => Exposure::new(points, prepared.blockers.spheres.len()),
        _ => Exposure::new(1, 0),
    };
    let reflections = prepared.reflections.as_ref().filter(|reflections| !reflections.is_dark());
    let mut gather = reflections.map(|_| Gather::<N>::new(prepared.blockers.spheres.len()));
    let mut start = 0;
    while start < count {
        let lanes = (count - start).min(LANES);
        let load = |values: &[f32]| -> [f32; LANES] {
            let values = &values[start..start + lanes];
            values.first_chunk().copied().unwrap_or_else(|| std::array::from_fn(|i| values[i.min(lanes - 1)]))
        };
        let position = turn(std::array::from_fn(|axis| {
            // In double precision, because a scene may lie far from the origin.
            f32x8::from(load(receivers.position[axis]).map(|x| (f64::from(x) - center[axis]) as f32))
        }));
        let normal = turn(receivers.normal.map(|axis| f32x8::from(load(axis))));
        let seen = gather.as_mut().zip(reflections).map(|(gather, r)| gather.see(prepared, r, &position, &normal));
        let visibility = match &prepared.combination {
            Combination::Exponential(exponential) => {
                exponential.evaluate(&seen.unwrap_or_else(|| log_sum::<N>(prepared, &position, &normal)))
            }
            Combination::Product => multiplied::<N>(prepared, &position, &normal),
            Combination::Shares { .. } => exposure.visibility::<N>(prepared, &position, &normal),
        };
        let mut radiance = prepared.light.dot(&normal, &visibility, prepared.clamp);
        if let (Some(gather), Some(reflections)) = (&mut gather, reflections) {
            let reflected = gather.radiance(reflections, &normal);
            radiance.iter_mut().zip(reflected).for_each(|(sum, value)| *sum += value);
        }
        for (channel, values) in radiance.into_iter().enumerate() {
            let values = (values * f32x8::from(load(receivers.albedo[channel]))).to_array();
            out.channels[channel][start..start + lanes].copy_from_slice(&values[..lanes]);
        }
        start += lanes;
    }
}

/// Σ log B [Guerrero2007, eq. 4.7].
#[inline(never)]
fn log_sum<const N: usize>(prepared: &Prepared, position: &[f32x8; 3], normal: &[f32x8; 3]) -> ShBatch<N> {
    let mut sum = [f32x8::ZERO; N];
    for blocker in &prepared.blockers.spheres {
        // A sphere that no lane sees adds 0 to all of them: leaving it out changes no bit.
        if let Some(seen) = blocker.seen_from(position, normal, prepared.rule) {
            let share = f32x8::splat(blocker.share);
            let scale = prepared.table.lookup::<N>(seen.sin_squared).map(|value| value * share);
            kernel::accumulate_lobe(seen.direction, &scale, &mut sum);
        }
    }
    sum
}

/// B_1 * B_2 * .. one after another [Guerrero2007, eq. 4.6], held to the range of visibility after each.
#[inline(never)]
fn multiplied<const N: usize>(prepared: &Prepared, position: &[f32x8; 3], normal: &[f32x8; 3]) -> ShBatch<N> {
    let mut visibility = [f32x8::ZERO; N];
    visibility[0] = f32x8::splat((4.0 * std::f32::consts::PI).sqrt());
    for blocker in &prepared.blockers.spheres {
        if let Some(seen) = blocker.seen_from(position, normal, prepared.rule) {
            let scale = prepared.table.lookup::<N>(seen.sin_squared);
            let mut minus_cap = [f32x8::ZERO; N];
            kernel::accumulate_lobe(seen.direction, &scale, &mut minus_cap);
            // V*(1 - C) = V - V*C: a lane that sees nothing keeps its bits.
            let blocked = kernel::product(&visibility, &minus_cap);
            let mut next = visibility;
            next.iter_mut().zip(blocked).for_each(|(value, blocked)| *value += blocked);
            kernel::limit_to_visibility(&mut next);
            let sees = seen.sin_squared.simd_gt(f32x8::ZERO);
            visibility.iter_mut().zip(next).for_each(|(value, next)| *value = sees.select(next, *value));
        }
    }
    visibility
}
