//! Second pass: radiance of all spheres at eight receivers at once [Guerrero2007, 4.3.3].
//!
//! ```text
//! L = Σ_i L̃_i Ṽ_i        Ṽ_i = ρ_n · (exp(S_i) - exp(S_i + log B_i))        S_i = Σ over nearer spheres j of log B_j
//! ```
//!
//! (eq. 4.22, 4.32, 4.33). [`Intersections::Precomputed`] leaves spheres that intersect i out of S_i, as published; their
//! covering is in the surface's colours. [`Intersections::Ordered`] takes them in like any other: then the Ṽ_i add up to
//! all that is blocked, nothing is lost or counted twice, and one exponential per sphere suffices, since what i leaves is
//! what the next sphere finds.
//!
//! Two ways to S_i give the same sums up to rounding. [`Walk::Quadratic`] adds up all nearer spheres for each sphere.
//! [`Walk::Linear`] sorts the spheres once per receiver and keeps a running sum, from which it takes back the intersecting
//! neighbours: O(n·m) with m neighbours instead of O(n²/2), as chapter 6 hopes for.

use super::{Blocker, Blockers, Receivers8, blocker::Seen, dot_shared, traced::Traced};
use crate::{
    sh_exp::settings::{Intersections, Order, Walk},
    shared::vector::dot,
};
use halfshade_sh::{
    form_factor::FormFactorTable,
    kernel::{self, BatchExponential, LANES, ShBatch, times_bands},
    mean_normal::MeanNormalTable,
};
use wide::f32x8;

/// The spheres that radiate, and how they are gathered.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Radiating<'a> {
    pub(crate) vectors: &'a RadianceVectors,
    pub(crate) form: &'a FormFactorTable,
    /// Where on a sphere the average is taken; `None`: where it faces the receiver.
    pub(crate) mean_normal: Option<&'a MeanNormalTable>,
    pub(crate) exponential: &'a BatchExponential,
    /// Clamped cosine over π by band, times the rotation's factor: ρ_n.
    pub(crate) cosine: &'a [f32],
    /// Per sphere those of the same object and level that it intersects.
    pub(crate) neighbours: &'a [Vec<u32>],
    pub(crate) walk: Walk,
    pub(crate) order: Order,
    pub(crate) intersections: Intersections,
}

/// Radiance of every sphere, in light space.
#[derive(Debug, Clone, Default)]
pub(crate) struct RadianceVectors {
    /// Per sphere and channel an SH vector over the directions from its centre.
    pub(crate) vectors: Vec<f32>,
    /// Whether a sphere radiates at all.
    pub(crate) shines: Vec<bool>,
    /// Coefficients of a sphere, all channels.
    pub(crate) stride: usize,
}

impl RadianceVectors {
    /// Whether nothing shines.
    pub(crate) fn is_dark(&self) -> bool {
        !self.shines.contains(&true)
    }

    /// The vectors of a sphere, channel by channel; `None` if it is black.
    pub(crate) fn of(&self, sphere: usize) -> Option<&[f32]> {
        self.shines[sphere].then(|| &self.vectors[sphere * self.stride..][..self.stride])
    }

    pub(crate) fn bytes(&self) -> usize {
        size_of_val(self.vectors.as_slice()) + self.shines.len()
    }
}

/// The view of eight receivers on one sphere.
struct Entry<const N: usize> {
    sphere: u32,
    /// log B.
    log: ShBatch<N>,
    /// The number by which spheres are ordered.
    key: f32x8,
    /// L̃ by channel.
    radiance: [f32x8; 3],
    shines: bool,
}

/// Memory for one batch of receivers.
pub(crate) struct Gather<const N: usize> {
    /// The spheres that any of the eight receivers sees.
    entries: Vec<Entry<N>>,
    /// Place of each sphere in `entries`, or [`UNSEEN`].
    places: Vec<u32>,
    /// Per lane all spheres from near to far: those not seen stand where they stood when they were.
    order: [Vec<u32>; LANES],
    /// The order in the making: (key as a sortable number, sphere).
    keys: Vec<u64>,
    /// Logarithms lane by lane: rows of eight coefficients per lane, entry and part.
    by_lane: Vec<f32x8>,
    /// S_i, in the same layout.
    nearer: Vec<f32x8>,
    own: OwnAverage,
}

/// Average radiance of the receivers' own object where they know from its mesh what it hides.
#[derive(Debug, Clone, Copy)]
struct OwnAverage {
    /// By channel, times `weight`.
    radiance: [f32x8; 3],
    weight: f32x8,
}

impl OwnAverage {
    const NONE: Self = Self { radiance: [f32x8::ZERO; 3], weight: f32x8::ZERO };

    /// Adds what a sphere radiates, by its solid angle times the receiver's cosine.
    #[inline(always)]
    fn add(&mut self, seen: &Seen, radiance: [f32x8; 3], receivers: &Receivers8) {
        let weight = seen.sin_squared * dot(&seen.direction, &receivers.normal).fast_max(f32x8::ZERO);
        let weight = receivers.knows_own.select(weight, f32x8::ZERO);
        self.radiance.iter_mut().zip(radiance).for_each(|(sum, l)| *sum = l.mul_add(weight, *sum));
        self.weight += weight;
    }

    /// The light of a receiver of which the own object hides this share.
    #[inline(always)]
    fn light(&self, share: f32x8) -> [f32x8; 3] {
        let share = share.fast_max(f32x8::ZERO) / self.weight.fast_max(f32x8::splat(f32::MIN_POSITIVE));
        self.radiance.map(|l| l * share)
    }
}

const UNSEEN: u32 = u32::MAX;

impl<const N: usize> Gather<N> {
    /// Rows of eight that hold N coefficients.
    const PARTS: usize = N.div_ceil(LANES);

    /// For so many spheres, of which a receiver sees at most `most`.
    pub(crate) fn new(spheres: usize, most: usize) -> Self {
        Self {
            entries: Vec::with_capacity(most),
            places: vec![UNSEEN; spheres],
            order: std::array::from_fn(|_| (0..spheres as u32).collect()),
            keys: Vec::with_capacity(most),
            by_lane: vec![f32x8::ZERO; most * Self::PARTS * LANES],
            nearer: vec![f32x8::ZERO; most * Self::PARTS * LANES],
            own: OwnAverage::NONE,
        }
    }

    /// Looks at every sphere; returns Σ log B_i over those that hide the
    /// environment, which the shadows need. The table of `blockers` holds logarithms.
    #[inline(never)]
    pub(crate) fn see(
        &mut self,
        blockers: &Blockers<'_>,
        radiating: &Radiating<'_>,
        receivers: &Receivers8,
    ) -> ShBatch<N> {
        self.entries.clear();
        self.places.fill(UNSEEN);
        let mut log_sum = [f32x8::ZERO; N];
        self.own = OwnAverage::NONE;
        for blocker in blockers.list {
            if blockers.own.contains(blocker.emitter)
                && receivers.knows_own.any()
                && let Some(seen) = blocker.seen_from(receivers, blockers.rule)
            {
                let basis = kernel::basis::<f32x8, N>(seen.direction);
                self.own.add(&seen, radiating.radiance_of(blocker, &seen, &basis, receivers), receivers);
            }
            let Some(seen) = blockers.hiding(blocker, receivers) else { continue };
            let basis = kernel::basis::<f32x8, N>(seen.direction);
            let scale = blocker.times_factors(blockers.table.lookup::<N>(seen.sin_squared));
            let log = times_bands(&basis, &scale);
            log_sum.iter_mut().zip(&log).for_each(|(sum, log)| *sum += *log);
            self.places[blocker.emitter as usize] = self.entries.len() as u32;
            self.entries.push(Entry {
                sphere: blocker.emitter,
                log,
                key: order_key(blocker, &receivers.position, radiating.order),
                radiance: radiating.radiance_of(blocker, &seen, &basis, receivers),
                shines: radiating.vectors.shines[blocker.emitter as usize],
            });
        }
        log_sum
    }

    /// Outgoing radiance of white receivers, by channel, after [`Self::see`]; `past_own` is what they see past their own
    /// object, if they know it from its mesh. That object radiates its average where it hides the rest.
    #[inline(never)]
    pub(crate) fn radiance(
        &mut self,
        radiating: &Radiating<'_>,
        normal: &[f32x8; 3],
        past_own: Option<&ShBatch<N>>,
    ) -> [f32x8; 3] {
        let (brdf, mut radiance) = self.past_own(radiating, normal, past_own);
        if (radiating.walk, radiating.intersections) == (Walk::Linear, Intersections::Ordered) {
            self.walk();
            let others = self.handed_on(radiating.exponential, &brdf);
            return std::array::from_fn(|channel| radiance[channel] + others[channel]);
        }
        self.each_visible(radiating, &brdf, |entry, visible| {
            radiance.iter_mut().zip(entry.radiance).for_each(|(sum, l)| *sum = l.mul_add(visible, *sum));
        });
        radiance
    }

    /// [`Self::radiance`] with the parts of spheres that are visible as `traced` has found them.
    pub(crate) fn radiance_of_traced(
        &self,
        radiating: &Radiating<'_>,
        normal: &[f32x8; 3],
        past_own: Option<&ShBatch<N>>,
        traced: &mut Traced<N>,
    ) -> [f32x8; 3] {
        let (brdf, mut radiance) = self.past_own(radiating, normal, past_own);
        let parts = traced.parts(|place| self.entries[place].key, &brdf);
        for (entry, &visible) in self.entries.iter().zip(parts) {
            radiance.iter_mut().zip(entry.radiance).for_each(|(sum, l)| *sum = l.mul_add(visible, *sum));
        }
        radiance
    }

    /// ρ_n past the own object, and the light of that.
    #[inline(always)]
    fn past_own(
        &self,
        radiating: &Radiating<'_>,
        normal: &[f32x8; 3],
        past_own: Option<&ShBatch<N>>,
    ) -> (ShBatch<N>, [f32x8; 3]) {
        let brdf = radiating.brdf(normal);
        let Some(visibility) = past_own else { return (brdf, [f32x8::ZERO; 3]) };
        let past = kernel::product(&brdf, visibility);
        (past, self.own.light((brdf[0] - past[0]) * f32x8::splat(kernel::FULL)))
    }

    /// Sum over channels of what each sphere radiates to the receiver in the first lane, after [`Self::see`].
    pub(crate) fn parts(&mut self, radiating: &Radiating<'_>, normal: &[f32x8; 3]) -> Vec<(u32, f32)> {
        let mut parts = Vec::with_capacity(self.entries.len());
        self.each_visible(radiating, &radiating.brdf(normal), |entry, visible| {
            let [r, g, b] = entry.radiance;
            parts.push((entry.sphere, ((r + g + b) * visible).as_array()[0]));
        });
        parts
    }

    /// Calls `each` with every sphere that shines and its Ṽ.
    #[inline(always)]
    fn each_visible(&mut self, radiating: &Radiating<'_>, brdf: &ShBatch<N>, mut each: impl FnMut(&Entry<N>, f32x8)) {
        if radiating.walk == Walk::Linear {
            self.walk();
        }
        for (place, entry) in self.entries.iter().enumerate().filter(|(_, entry)| entry.shines) {
            let before = match radiating.walk {
                Walk::Linear => self.running_sum(place, radiating.skipped(entry.sphere)),
                Walk::Quadratic => self.sum_of_nearer(place, radiating),
            };
            let after = plus(&before, &entry.log);
            let exponential = radiating.exponential;
            each(entry, exponential.evaluate_dot(&before, brdf) - exponential.evaluate_dot(&after, brdf));
        }
    }

    /// S_i of an entry, sphere by sphere.
    fn sum_of_nearer(&self, place: usize, radiating: &Radiating<'_>) -> ShBatch<N> {
        let mut sum = [f32x8::ZERO; N];
        let skipped = radiating.skipped(self.entries[place].sphere);
        for (other, nearer) in self.entries.iter().enumerate() {
            if other != place && !skipped.contains(&nearer.sphere) {
                self.add_if_nearer(other, place, f32x8::ONE, &mut sum);
            }
        }
        sum
    }

    /// Adds `sign` times the logarithm of entry `other` in the lanes in which it is nearer than the entry at `place`.
    #[inline(always)]
    fn add_if_nearer(&self, other: usize, place: usize, sign: f32x8, sum: &mut ShBatch<N>) {
        let (a, b) = (&self.entries[other], &self.entries[place]);
        // At equal distances the first of the list comes first.
        let nearer = if other < place { a.key.simd_le(b.key) } else { a.key.simd_lt(b.key) };
        if nearer.any() {
            let factor = nearer.select(sign, f32x8::ZERO);
            sum.iter_mut().zip(&a.log).for_each(|(sum, log)| *sum = log.mul_add(factor, *sum));
        }
    }

    /// Running sums of all lanes, each in its own order.
    fn walk(&mut self) {
        let count = self.entries.len();
        for (place, entry) in self.entries.iter().enumerate() {
            for part in 0..Self::PARTS {
                let rows = f32x8::transpose(std::array::from_fn(|k| {
                    entry.log.get(part * LANES + k).copied().unwrap_or_default()
                }));
                for (lane, row) in rows.into_iter().enumerate() {
                    self.by_lane[(lane * count + place) * Self::PARTS + part] = row;
                }
            }
        }
        for lane in 0..LANES {
            self.sort(lane);
            let lane_rows = lane * count * Self::PARTS..(lane + 1) * count * Self::PARTS;
            let (logs, nearer) = (&self.by_lane[lane_rows.clone()], &mut self.nearer[lane_rows]);
            let mut sums = [f32x8::ZERO; kernel::MAX_BANDS];
            for &sphere in &self.order[lane] {
                let place = self.places[sphere as usize];
                if place == UNSEEN {
                    continue;
                }
                let rows = place as usize * Self::PARTS..(place as usize + 1) * Self::PARTS;
                for ((sum, log), nearer) in sums.iter_mut().zip(&logs[rows.clone()]).zip(&mut nearer[rows]) {
                    *nearer = *sum;
                    *sum += *log;
                }
            }
        }
    }

    /// Sorts a lane's order, by insertion: the receivers of the batch before had nearly the same.
    fn sort(&mut self, lane: usize) {
        self.keys.clear();
        let order = &mut self.order[lane];
        for &sphere in order.iter() {
            let place = self.places[sphere as usize];
            if place != UNSEEN {
                let key = self.entries[place as usize].key.as_array()[lane];
                self.keys.push(u64::from(sortable(key)) << 32 | u64::from(sphere));
            }
        }
        for end in 1..self.keys.len() {
            let key = self.keys[end];
            let mut hole = end;
            while hole > 0 && self.keys[hole - 1] > key {
                self.keys[hole] = self.keys[hole - 1];
                hole -= 1;
            }
            self.keys[hole] = key;
        }
        let mut sorted = self.keys.iter();
        for sphere in order.iter_mut().filter(|sphere| self.places[**sphere as usize] != UNSEEN) {
            if let Some(&key) = sorted.next() {
                *sphere = key as u32;
            }
        }
    }

    /// S_i of an entry from the running sums, without the spheres `skipped`.
    #[inline(always)]
    fn running_sum(&self, place: usize, skipped: &[u32]) -> ShBatch<N> {
        let mut sum = [f32x8::ZERO; N];
        let count = self.entries.len();
        for (part, values) in sum.chunks_mut(LANES).enumerate() {
            let columns =
                f32x8::transpose(std::array::from_fn(|lane| self.nearer[(lane * count + place) * Self::PARTS + part]));
            values.copy_from_slice(&columns[..values.len()]);
        }
        for &neighbour in skipped {
            let other = self.places[neighbour as usize];
            if other != UNSEEN {
                self.add_if_nearer(other as usize, place, -f32x8::ONE, &mut sum);
            }
        }
        sum
    }

    /// Σ L̃_i Ṽ_i where every sphere finds what the nearer ones leave: one exponential per sphere.
    fn handed_on(&mut self, exponential: &BatchExponential, brdf: &ShBatch<N>) -> [f32x8; 3] {
        // The light left after each entry takes the place of its key, which has done its work.
        for place in 0..self.entries.len() {
            let after = plus(&self.running_sum(place, &[]), &self.entries[place].log);
            self.entries[place].key = exponential.evaluate_dot(&after, brdf);
        }
        let all = brdf[0] * f32x8::splat(kernel::FULL);
        let mut radiance = [[0.0f32; LANES]; 3];
        for (lane, order) in self.order.iter().enumerate() {
            let mut found = all.as_array()[lane];
            for place in order.iter().map(|&sphere| self.places[sphere as usize]).filter(|&place| place != UNSEEN) {
                let entry = &self.entries[place as usize];
                let left = entry.key.as_array()[lane];
                for (sum, l) in radiance.iter_mut().zip(&entry.radiance) {
                    sum[lane] = l.as_array()[lane].mul_add(found - left, sum[lane]);
                }
                found = left;
            }
        }
        radiance.map(f32x8::from)
    }
}

/// Weights of a sphere's radiance in its average over what lies above the receivers' horizon, by their cosine: those of the
/// form factor about the mean normal p̄, the bands from 1 on scaled so that the first has its length.
#[inline(always)]
fn weights_at_mean<const N: usize>(
    blocker: &Blocker,
    form: &FormFactorTable,
    table: &MeanNormalTable,
    Receivers8 { position, normal, .. }: &Receivers8,
) -> ShBatch<N> {
    let least = f32x8::splat(f32::MIN_POSITIVE);
    let offset: [f32x8; 3] = std::array::from_fn(|axis| f32x8::splat(blocker.center[axis]) - position[axis]);
    let per_distance = f32x8::ONE / dot(&offset, &offset).fast_max(least).sqrt();
    let toward = offset.map(|axis| axis * per_distance);
    let sine = (f32x8::splat(blocker.radius) * per_distance).fast_min(f32x8::ONE);
    let cosine = dot(&toward, normal);
    let [along, aside] = table.lookup(sine, cosine);
    // A d + B (n - (n·d) d)/|n - (n·d) d|
    let across = (f32x8::ONE - cosine * cosine).fast_max(f32x8::splat(1e-12)).sqrt();
    let of_normal = aside / across;
    let of_toward = of_normal.mul_neg_add(cosine, along);
    let mean: [f32x8; 3] = std::array::from_fn(|axis| of_toward.mul_add(toward[axis], of_normal * normal[axis]));
    let length = dot(&mean, &mean).fast_max(least).sqrt();
    let mut factors = form.lookup(sine);
    let scale = length / factors[1].fast_max(f32x8::splat(0.5));
    factors.iter_mut().skip(1).for_each(|factor| *factor *= scale);
    times_bands(&kernel::basis::<f32x8, N>(mean.map(|axis| axis / length)), &factors)
}

impl Radiating<'_> {
    /// The spheres that don't cover `sphere`, though they may be nearer.
    fn skipped(&self, sphere: u32) -> &[u32] {
        match self.intersections {
            Intersections::Precomputed => &self.neighbours[sphere as usize],
            Intersections::Ordered => &[],
        }
    }

    /// L̃ of a sphere by channel.
    #[inline(always)]
    fn radiance_of<const N: usize>(
        &self,
        blocker: &Blocker,
        seen: &Seen,
        basis: &ShBatch<N>,
        receivers: &Receivers8,
    ) -> [f32x8; 3] {
        let Some(vectors) = self.vectors.of(blocker.emitter as usize) else { return [f32x8::ZERO; 3] };
        let weights = match self.mean_normal {
            None => {
                let mut form = self.form.lookup(seen.sin_squared.sqrt());
                // From the sphere to the receiver: the opposite direction turns the sign of odd bands.
                form.iter_mut().skip(1).step_by(2).for_each(|f| *f = -*f);
                times_bands(basis, &form)
            }
            Some(table) => weights_at_mean(blocker, self.form, table, receivers),
        };
        let radiance = match vectors.as_chunks::<N>().0 {
            [grey] => [dot_shared(&weights, grey); 3],
            channels => std::array::from_fn(|c| dot_shared(&weights, &channels[c])),
        };
        radiance.map(|l| l * f32x8::splat(blocker.reflection_factor))
    }

    /// ρ_n of eight normals.
    #[inline(always)]
    fn brdf<const N: usize>(&self, normal: &[f32x8; 3]) -> ShBatch<N> {
        times_bands(&kernel::basis::<f32x8, N>(*normal), self.cosine)
    }
}

fn plus<const N: usize>(a: &ShBatch<N>, b: &ShBatch<N>) -> ShBatch<N> {
    let mut sum = *a;
    sum.iter_mut().zip(b).for_each(|(sum, b)| *sum += *b);
    sum
}

/// Bits that sort as numbers do, -0 before 0.
fn sortable(x: f32) -> u32 {
    let bits = x.to_bits();
    if x.is_sign_negative() { !bits } else { bits | 1 << 31 }
}

fn order_key(blocker: &Blocker, position: &[f32x8; 3], order: Order) -> f32x8 {
    let squared = (0..3).fold(f32x8::ZERO, |sum, axis| {
        let offset = f32x8::splat(blocker.center[axis]) - position[axis];
        offset.mul_add(offset, sum)
    });
    match order {
        Order::Center => squared,
        Order::Power => squared - f32x8::splat(blocker.radius * blocker.radius),
    }
}
