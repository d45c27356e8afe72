//! The inner loops: eight receivers side by side, one sphere after another.

use super::{
    blockers::Blocker,
    cuts::{CutOf, Cuts},
    exposed::Exposure,
    prepared::{Combination, Prepared},
    reflections::{Gather, Reflections},
    traced::Traced,
};
use halfshade_scene::{RadianceMut, ReceiverBuffer, Receivers};
use halfshade_sh::kernel::{self, LANES, ShBatch};
use wide::f32x8;

/// Shades all receivers. Each lane's result depends on its own receiver and its cut alone, so that batches may be split
/// anywhere; the last group of a cut is filled up with copies of its last receiver.
pub(super) fn shade<const N: usize>(
    prepared: &Prepared,
    receivers: Receivers<'_>,
    whose: CutOf<'_>,
    mut out: RadianceMut<'_>,
) {
    let cuts = &prepared.cuts;
    let mut batches = Batches::<N>::new(prepared);
    let Some(cut_of) = cuts.of(receivers, whose) else {
        if prepared.ground.is_none() {
            return batches.shade(receivers, cuts.cut(0), &mut out, |place| place);
        }
        let mut first = 0;
        for run in receivers.object.chunk_by(|a, b| a == b) {
            batches.shade(receivers.slice(first..first + run.len()), cuts.cut(0), &mut out, |place| first + place);
            first += run.len();
        }
        return;
    };
    let mut order: Vec<u32> = (0..receivers.len() as u32).collect();
    let group = |i: u32| (cut_of[i as usize], receivers.object[i as usize]);
    order.sort_by_key(|&i| group(i));
    for run in order.chunk_by(|&a, &b| group(a) == group(b)) {
        let cut = cuts.cut(cut_of[run[0] as usize] as usize);
        let gathered = ReceiverBuffer::gathered(receivers, run);
        batches.shade(gathered.view(), cut, &mut out, |place| run[place] as usize);
    }
}

/// Ratios of reflected light for the parents in `cuts`.
pub(super) fn scale_reflections<const N: usize>(prepared: &Prepared, cuts: &mut Cuts) {
    let Some(reflections) = prepared.reflections.as_ref().filter(|reflections| !reflections.is_dark()) else { return };
    let mut gather = Gather::<N>::new(reflections.emitter_count(), cuts.largest());
    cuts.set_reflection_ratios(|cluster, blockers| {
        let normal = cluster.normal.map(f32x8::splat);
        gather.see((prepared, reflections), blockers, &cluster.place.map(f32x8::splat), &normal);
        gather.parts(reflections, &normal)
    });
}

/// What receivers have to be told and what memory they share.
struct Batches<'a, const N: usize> {
    prepared: &'a Prepared,
    exposure: Exposure,
    traced: Option<Traced<N>>,
    reflections: Option<(&'a Reflections, Gather<N>)>,
    rotation: [f32x8; 9],
}

impl<'a, const N: usize> Batches<'a, N> {
    fn new(prepared: &'a Prepared) -> Self {
        let most = prepared.cuts.largest();
        Self {
            prepared,
            exposure: match prepared.combination {
                Combination::Shares { points } => Exposure::new(points, most, prepared.cuts.blockers_from_light),
                _ => Exposure::new(1, 0, prepared.cuts.blockers_from_light),
            },
            traced: match prepared.combination {
                Combination::Traced { directions } => Some(Traced::new(directions, most)),
                _ => None,
            },
            reflections: (prepared.reflections.as_ref())
                .filter(|reflections| !reflections.is_dark())
                .map(|reflections| (reflections, Gather::new(reflections.emitter_count(), most))),
            rotation: prepared.cuts.rotation.transpose().to_cols_array().map(|value| f32x8::splat(value as f32)),
        }
    }

    /// The rotation into light space times a vector.
    fn turn(&self, v: [f32x8; 3]) -> [f32x8; 3] {
        let m = &self.rotation;
        std::array::from_fn(|axis| m[3 * axis].mul_add(v[0], m[3 * axis + 1].mul_add(v[1], m[3 * axis + 2] * v[2])))
    }

    /// Shades receivers that see the same spheres, and lie on the same object if the ground is seen; `place` says where in
    /// `out` each one belongs.
    fn shade(
        &mut self,
        receivers: Receivers<'_>,
        blockers: &[Blocker],
        out: &mut RadianceMut<'_>,
        place: impl Fn(usize) -> usize,
    ) {
        let prepared = self.prepared;
        let center = prepared.cuts.center;
        for start in (0..receivers.len()).step_by(LANES) {
            let lanes = (receivers.len() - start).min(LANES);
            let load = |values: &[f32]| -> [f32; LANES] {
                let values = &values[start..start + lanes];
                values.first_chunk().copied().unwrap_or_else(|| std::array::from_fn(|i| values[i.min(lanes - 1)]))
            };
            let position = self.turn(std::array::from_fn(|axis| {
                // In double precision, because a scene may lie far from the origin.
                f32x8::from(load(receivers.position[axis]).map(|x| (f64::from(x) - center[axis]) as f32))
            }));
            let normal = self.turn(receivers.normal.map(|axis| f32x8::from(load(axis))));
            let seen = self
                .reflections
                .as_mut()
                .map(|(reflections, gather)| gather.see((prepared, reflections), blockers, &position, &normal));
            let visibility = match &prepared.combination {
                Combination::Exponential(exponential) => {
                    exponential.evaluate(&seen.unwrap_or_else(|| log_sum::<N>(prepared, blockers, &position, &normal)))
                }
                Combination::Product => multiplied::<N>(prepared, blockers, &position, &normal),
                Combination::Traced { .. } => self
                    .traced
                    .as_mut()
                    .map_or([f32x8::ZERO; N], |traced| traced.visibility(prepared, blockers, &position, &normal)),
                Combination::Shares { .. } => self.exposure.visibility::<N>(prepared, blockers, &position, &normal),
            };
            let mut radiance = prepared.light.dot(&normal, &visibility, prepared.clamp);
            if let Some(ground) = &prepared.ground {
                let object = receivers.object[start];
                let seen = ground.radiance(object, &position, &normal, &visibility);
                if prepared.clamp {
                    let taken = ground.taken(object, &position, &normal, &visibility);
                    let mut open = [f32x8::ZERO; N];
                    open[0] = f32x8::splat(kernel::FULL);
                    let unshadowed = prepared.light.dot(&normal, &open, false);
                    for (channel, sum) in radiance.iter_mut().enumerate() {
                        let direct = (*sum + taken[channel]).max(f32x8::ZERO).min(unshadowed[channel]);
                        *sum = direct + (seen[channel] - taken[channel]).max(f32x8::ZERO);
                    }
                } else {
                    radiance.iter_mut().zip(seen).for_each(|(sum, value)| *sum += value);
                }
            }
            if let Some((reflections, gather)) = &mut self.reflections {
                let reflected = match &mut self.traced {
                    Some(traced) => gather.radiance_of_traced(reflections, &normal, traced),
                    None => gather.radiance(reflections, &normal),
                };
                let least = f32x8::splat(if prepared.clamp { 0.0 } else { f32::NEG_INFINITY });
                radiance.iter_mut().zip(reflected).for_each(|(sum, value)| *sum += value.max(least));
            }
            for (channel, values) in radiance.into_iter().enumerate() {
                let values = (values * f32x8::from(load(receivers.albedo[channel]))).to_array();
                for (lane, value) in values.into_iter().enumerate().take(lanes) {
                    out.channels[channel][place(start + lane)] = value;
                }
            }
        }
    }
}

/// Σ log B [Guerrero2007, eq. 4.7].
#[inline(never)]
fn log_sum<const N: usize>(
    prepared: &Prepared,
    blockers: &[Blocker],
    position: &[f32x8; 3],
    normal: &[f32x8; 3],
) -> ShBatch<N> {
    let mut sum = [f32x8::ZERO; N];
    for blocker in blockers {
        // A sphere that no lane sees adds 0 to all of them: leaving it out changes no bit.
        if let Some(seen) = blocker.seen_from(position, normal, prepared.rule) {
            let scale = blocker.times_factors(prepared.table.lookup::<N>(seen.sin_squared));
            kernel::accumulate_lobe(seen.direction, &scale, &mut sum);
        }
    }
    sum
}

/// B_1 * B_2 * .. one after another [Guerrero2007, eq. 4.6], held to the range of visibility after each.
#[inline(never)]
fn multiplied<const N: usize>(
    prepared: &Prepared,
    blockers: &[Blocker],
    position: &[f32x8; 3],
    normal: &[f32x8; 3],
) -> ShBatch<N> {
    let mut visibility = [f32x8::ZERO; N];
    visibility[0] = f32x8::splat(kernel::FULL);
    for blocker in blockers {
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
