//! Second pass: what all spheres radiate to eight receivers at once [Guerrero2007, 4.3.3].
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

use super::Reflections;
use crate::sh_exp::{Prepared, blockers::Blocker};
use halfshade_sh::kernel::{self, LANES, ShBatch};
use wide::f32x8;

/// In which order spheres cover each other.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Order {
    /// By the distance of their centres [Guerrero2007, 4.3.3].
    Center,
    /// By power distance `d² - r²`: spheres that intersect are cut apart by their radical plane, and this is the order in
    /// which the pieces cover each other.
    Power,
}

/// What of spheres of one object that intersect.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Intersections {
    /// They don't cover each other here: the colours know [Guerrero2007, 4.3.3].
    Precomputed,
    /// The nearer one covers the other.
    Ordered,
}

/// How sums over nearer spheres are found.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Walk {
    /// One by one.
    Quadratic,
    /// From a running sum.
    Linear,
}

/// What eight receivers see of one sphere.
struct Entry<const N: usize> {
    sphere: u32,
    /// log B.
    log: ShBatch<N>,
    /// What the order goes by.
    key: f32x8,
    /// L̃ by channel.
    radiance: [f32x8; 3],
    shines: bool,
}

/// Memory for one batch of receivers.
pub(in crate::sh_exp) struct Gather<const N: usize> {
    entries: Vec<Entry<N>>,
    /// Place of each sphere in `entries`, or `u32::MAX`.
    places: Vec<u32>,
    /// Per lane the entries from near to far.
    order: [Vec<u32>; LANES],
    /// The same in the making: (key as a sortable number, entry).
    keys: Vec<u64>,
    /// Logarithms lane by lane: rows of eight coefficients per entry, part and lane.
    by_lane: Vec<f32x8>,
    /// S_i, in the same layout.
    nearer: Vec<f32x8>,
}

impl<const N: usize> Gather<N> {
    /// Rows of eight that hold N coefficients.
    const PARTS: usize = N.div_ceil(LANES);

    pub(in crate::sh_exp) fn new(spheres: usize) -> Self {
        Self {
            entries: Vec::with_capacity(spheres),
            places: vec![u32::MAX; spheres],
            order: std::array::from_fn(|_| Vec::with_capacity(spheres)),
            keys: Vec::with_capacity(spheres),
            by_lane: vec![f32x8::ZERO; spheres * Self::PARTS * LANES],
            nearer: vec![f32x8::ZERO; spheres * Self::PARTS * LANES],
        }
    }

    /// Outgoing radiance of white receivers, by channel.
    #[inline(never)]
    pub(in crate::sh_exp) fn radiance(
        &mut self,
        prepared: &Prepared,
        reflections: &Reflections,
        position: &[f32x8; 3],
        normal: &[f32x8; 3],
    ) -> [f32x8; 3] {
        self.see(prepared, reflections, position, normal);
        let mut brdf = kernel::basis::<f32x8, N>(*normal);
        brdf.iter_mut().enumerate().for_each(|(i, value)| *value *= f32x8::splat(reflections.cosine[i.isqrt()]));
        let exponential_dot = |sum: &ShBatch<N>| dot(&reflections.exponential.evaluate(sum), &brdf);
        if reflections.walk == Walk::Linear {
            self.walk();
            if reflections.intersections == Intersections::Ordered {
                return self.handed_on(brdf[0] * f32x8::splat(kernel::FULL), exponential_dot);
            }
        }
        let mut radiance = [f32x8::ZERO; 3];
        for (place, entry) in self.entries.iter().enumerate().filter(|(_, entry)| entry.shines) {
            let before = match reflections.walk {
                Walk::Linear => self.running_sum(place, reflections.skipped(entry.sphere)),
                Walk::Quadratic => self.sum_of_nearer(place, reflections),
            };
            let mut after = before;
            after.iter_mut().zip(&entry.log).for_each(|(sum, log)| *sum += *log);
            let visible = exponential_dot(&before) - exponential_dot(&after);
            radiance.iter_mut().zip(entry.radiance).for_each(|(sum, l)| *sum = l.mul_add(visible, *sum));
        }
        radiance
    }

    /// Looks at every sphere.
    #[inline(always)]
    fn see(&mut self, prepared: &Prepared, reflections: &Reflections, position: &[f32x8; 3], normal: &[f32x8; 3]) {
        self.entries.clear();
        self.places.fill(u32::MAX);
        for (number, blocker) in prepared.blockers.spheres.iter().enumerate() {
            let Some(seen) = blocker.seen_from(position, normal, prepared.rule) else { continue };
            let basis = kernel::basis::<f32x8, N>(seen.direction);
            let scale = reflections.table.lookup::<N>(seen.sin_squared);
            let mut log = basis;
            log.iter_mut().enumerate().for_each(|(i, value)| *value *= scale[i.isqrt()]);
            let vectors = reflections.emitters.of(number);
            let radiance = vectors.map_or([f32x8::ZERO; 3], |vectors| {
                let form = reflections.form.lookup(seen.sin_squared.sqrt());
                let mut weights = basis;
                for (i, weight) in weights.iter_mut().enumerate() {
                    let l = i.isqrt();
                    // From the sphere to the receiver: the opposite direction turns the sign of odd bands.
                    *weight *= if l % 2 == 0 { form[l] } else { -form[l] };
                }
                match vectors.as_chunks::<N>().0 {
                    [grey] => [dot_with(&weights, grey); 3],
                    channels => std::array::from_fn(|c| dot_with(&weights, &channels[c])),
                }
            });
            self.places[number] = self.entries.len() as u32;
            self.entries.push(Entry {
                sphere: number as u32,
                log,
                key: order_key(blocker, position, reflections.order),
                radiance,
                shines: vectors.is_some(),
            });
        }
    }

    /// S_i of an entry, sphere by sphere.
    fn sum_of_nearer(&self, place: usize, reflections: &Reflections) -> ShBatch<N> {
        let entry = &self.entries[place];
        let mut sum = [f32x8::ZERO; N];
        let skipped = reflections.skipped(entry.sphere);
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

    /// Σ L̃_i Ṽ_i where every sphere finds what the nearer ones leave, at first `all` that is reflected: one exponential per
    /// sphere.
    fn handed_on(&self, all: f32x8, exponential_dot: impl Fn(&ShBatch<N>) -> f32x8) -> [f32x8; 3] {
        let left: Vec<[f32; LANES]> = (self.entries.iter().enumerate())
            .map(|(place, entry)| {
                let mut after = self.running_sum(place, &[]);
                after.iter_mut().zip(&entry.log).for_each(|(sum, log)| *sum += *log);
                exponential_dot(&after).to_array()
            })
            .collect();
        let mut radiance = [[0.0f32; LANES]; 3];
        for (lane, order) in self.order.iter().enumerate() {
            let mut found = all.as_array()[lane];
            for &place in order {
                let (entry, leaves) = (&self.entries[place as usize], left[place as usize][lane]);
                for (sum, l) in radiance.iter_mut().zip(&entry.radiance) {
                    sum[lane] = l.as_array()[lane].mul_add(found - leaves, sum[lane]);
                }
                found = leaves;
            }
        }
        radiance.map(f32x8::from)
    }

    /// Running sums of all lanes, each in its own order.
    fn walk(&mut self) {
        for (place, entry) in self.entries.iter().enumerate() {
            for part in 0..Self::PARTS {
                let rows = f32x8::transpose(std::array::from_fn(|k| {
                    entry.log.get(part * LANES + k).copied().unwrap_or_default()
                }));
                self.by_lane[(place * Self::PARTS + part) * LANES..][..LANES].copy_from_slice(&rows);
            }
        }
        for lane in 0..LANES {
            self.keys.clear();
            self.keys.extend(
                self.entries
                    .iter()
                    .enumerate()
                    .map(|(place, entry)| u64::from(sortable(entry.key.as_array()[lane])) << 32 | place as u64),
            );
            self.keys.sort_unstable();
            self.order[lane].clear();
            self.order[lane].extend(self.keys.iter().map(|&key| key as u32));
            let mut sums = [f32x8::ZERO; kernel::MAX_BANDS];
            for &place in &self.order[lane] {
                let place = place as usize;
                for (part, sum) in sums.iter_mut().enumerate().take(Self::PARTS) {
                    let row = (place * Self::PARTS + part) * LANES + lane;
                    self.nearer[row] = *sum;
                    *sum += self.by_lane[row];
                }
            }
        }
    }

    /// S_i of an entry from the running sums, without the spheres `skipped`.
    fn running_sum(&self, place: usize, skipped: &[u32]) -> ShBatch<N> {
        let mut sum = [f32x8::ZERO; N];
        for (part, values) in sum.chunks_mut(LANES).enumerate() {
            let rows: &[f32x8] = &self.nearer[(place * Self::PARTS + part) * LANES..][..LANES];
            let columns = f32x8::transpose(std::array::from_fn(|lane| rows[lane]));
            values.copy_from_slice(&columns[..values.len()]);
        }
        for &neighbour in skipped {
            let other = self.places[neighbour as usize];
            if other != u32::MAX {
                self.add_if_nearer(other as usize, place, -f32x8::ONE, &mut sum);
            }
        }
        sum
    }
}

fn dot<const N: usize>(a: &ShBatch<N>, b: &ShBatch<N>) -> f32x8 {
    a.iter().zip(b).fold(f32x8::ZERO, |sum, (a, b)| a.mul_add(*b, sum))
}

/// Bits that sort as numbers do, -0 before 0.
fn sortable(x: f32) -> u32 {
    let bits = x.to_bits();
    if x.is_sign_negative() { !bits } else { bits | 1 << 31 }
}

fn dot_with<const N: usize>(a: &ShBatch<N>, b: &[f32; N]) -> f32x8 {
    a.iter().zip(b).fold(f32x8::ZERO, |sum, (a, &b)| a.mul_add(f32x8::splat(b), sum))
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
