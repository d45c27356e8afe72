//! Rays from all rows of the table: once for what is in the way, once per bounce for what reflects.

use super::{chunks::Chunks, hemisphere::Hemisphere, subsurface::Media, surface::Surfaces, table::Transfer};
use glam::{DMat3, Vec3};
use halfshade_scene::cache::CacheKey;
use halfshade_strategy::StrategyError;
use rayon::prelude::*;

/// Rays: where they start, along what, and against which surfaces.
pub(crate) struct Passes<'a> {
    pub(crate) hemisphere: &'a Hemisphere,
    /// Objects that light enters through other hemispheres.
    pub(crate) media: &'a Media,
    pub(crate) surfaces: &'a Surfaces,
    /// Position and normal of each row.
    pub(crate) points: &'a [(Vec3, Vec3)],
    pub(crate) chunks: &'a Chunks<'a>,
}

/// Transfer of light that arrives straight at a row.
#[derive(Debug)]
pub(crate) struct DirectRow {
    pub(crate) values: Vec<f32>,
    /// A bit per direction, 1 where something is in the way; empty if nothing is anywhere.
    pub(crate) blocked: Vec<u64>,
}

impl Passes<'_> {
    /// `T_0` of every row, of translucent objects what enters. What takes rays doesn't depend on the number of bands, and is kept for all of them.
    pub(crate) fn direct(&self, key: &CacheKey) -> Result<Vec<DirectRow>, StrategyError> {
        let words = self.hemisphere.count().div_ceil(64);
        let fits = |blocked: &Vec<u64>| [0, words].contains(&blocked.len());
        let blocked = self.chunks.of(key, self.points.len(), fits, |number| self.blocked(self.points[number]))?;
        let direct = |(number, blocked): (usize, Vec<u64>)| DirectRow {
            values: self.transfer(number, &blocked).into_iter().map(|value| value as f32).collect(),
            blocked,
        };
        Ok(blocked.into_par_iter().enumerate().map(direct).collect())
    }

    /// Bits of the directions in which something is in the way.
    fn blocked(&self, point: (Vec3, Vec3)) -> Vec<u64> {
        let frame = Hemisphere::frame(point.0, point.1);
        let count = self.hemisphere.count();
        let mut blocked = vec![0; count.div_ceil(64)];
        for k in (0..count).filter(|&k| self.surfaces.is_blocked(point, self.along(&frame, k))) {
            blocked[k / 64] |= 1 << (k % 64);
        }
        if blocked.iter().all(|word| *word == 0) {
            blocked.clear();
        }
        blocked
    }

    /// The closed form less what is blocked.
    fn transfer(&self, number: usize, blocked: &[u64]) -> Vec<f64> {
        let (position, normal) = self.points[number];
        let hemisphere = self.media.hemisphere(number, self.hemisphere);
        let mut values = hemisphere.open(normal);
        if !blocked.is_empty() {
            let taken = hemisphere.sum(&Hemisphere::frame(position, normal), set_bits(blocked));
            values.iter_mut().zip(taken).for_each(|(value, taken)| *value -= taken);
        }
        values
    }

    /// `T_b` of every row, given `T_{b-1}`; of translucent objects what enters.
    pub(crate) fn bounce(
        &self,
        key: &CacheKey,
        direct: &[DirectRow],
        before: &Transfer,
        channels: usize,
    ) -> Result<Vec<f32>, StrategyError> {
        let width = channels * self.hemisphere.coefficients();
        let fits = |row: &Vec<f32>| row.len() == width;
        let rows = self.chunks.of(key, self.points.len(), fits, |number| {
            let point = self.points[number];
            let hemisphere = self.media.hemisphere(number, self.hemisphere);
            let frame = Hemisphere::frame(point.0, point.1);
            let mut sum: Vec<f64> =
                direct[number].values.iter().copied().map(f64::from).collect::<Vec<_>>().repeat(channels);
            for k in set_bits(&direct[number].blocked) {
                let Some(reflector) = self.surfaces.reflector(point, self.along(&frame, k)) else { continue };
                let weight = hemisphere.weight(k);
                for (row, share) in reflector.rows {
                    add_row(&mut sum, before, row, weight * share, reflector.albedo);
                }
            }
            sum.into_iter().map(|value| value as f32).collect()
        })?;
        Ok(rows.into_iter().flatten().collect())
    }

    /// Direction k of a row, in the world.
    pub(crate) fn along(&self, frame: &DMat3, k: usize) -> Vec3 {
        (*frame * self.hemisphere.direction(k)).as_vec3()
    }
}

/// Adds `weight · albedo · T` of a row, channel by channel.
pub(crate) fn add_row(sum: &mut [f64], before: &Transfer, row: usize, weight: f64, albedo: Vec3) {
    let count = before.bands * before.bands;
    for (channel, sum) in sum.chunks_exact_mut(count).enumerate() {
        let factor = weight * f64::from(albedo[channel]);
        let vector = before.vector(row, channel);
        sum.iter_mut().zip(vector).for_each(|(sum, &value)| *sum += factor * f64::from(value));
    }
}

/// Numbers of the bits that are 1.
pub(crate) fn set_bits(words: &[u64]) -> impl Iterator<Item = usize> {
    words.iter().enumerate().flat_map(|(place, &word)| {
        let rest = |word: &u64| Some(word & (word - 1)).filter(|rest| *rest != 0);
        let words = std::iter::successors(Some(word).filter(|word| *word != 0), rest);
        words.map(move |word| 64 * place + word.trailing_zeros() as usize)
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn bits_come_one_by_one() {
        let words = [1 | 1 << 5 | 1 << 63, 0, 1 << 7];
        assert_eq!(set_bits(&words).collect::<Vec<_>>(), [0, 5, 63, 135]);
        assert_eq!(set_bits(&[]).count(), 0);
    }
}
