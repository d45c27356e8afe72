//! Transfer times light, `Σ_i T_i l_i`, for eight receivers.
//!
//! A row is read once, eight numbers at a time, and multiplied with the light of all channels, which stays in registers; what
//! is left are eight partial sums for each receiver and channel, which a transposition lets be added up side by side. Numbers past
//! the end of a row are multiplied with zeros: they are those of the next row, or the table's padding.

use halfshade_sh::kernel::{LANES, MAX_BANDS};
use wide::f32x8;

/// Numbers past the end of a table, so that eight at a time can be read from anywhere.
pub(crate) const PADDING: usize = LANES - 1;

/// Eights of the longest vector.
pub(super) const MOST_EIGHTS: usize = MAX_BANDS * MAX_BANDS / LANES;

/// Light by channel and eight coefficients; zeros past the last.
pub(crate) type LightVectors = [[f32x8; MOST_EIGHTS]; 3];

/// Partial sums of one receiver, by channel.
pub(crate) type Partial = [f32x8; 3];

/// Rows of the table that a receiver lies between, and their weights; a weight of 0 goes with any row.
pub(crate) type Between = [(usize, f32); 3];

/// `T · l` of eight receivers, channel by channel: `partial` gives the sums of each.
#[inline(always)]
pub(crate) fn added(partial: impl Fn(usize) -> Partial) -> [f32x8; 3] {
    let partials: [Partial; LANES] = std::array::from_fn(partial);
    std::array::from_fn(|channel| {
        let [a, b, c, d, e, f, g, h] = f32x8::transpose(partials.map(|sums| sums[channel]));
        ((a + b) + (c + d)) + ((e + f) + (g + h))
    })
}

/// Partial sums of the row that `table` starts with: C vectors of N numbers.
#[inline(always)]
pub(crate) fn of_row<const N: usize, const C: usize>(table: &[f32], light: &LightVectors) -> Partial {
    let mut sums = [f32x8::ZERO; 3];
    for vector in 0..C {
        for eight in 0..const { N.div_ceil(LANES) } {
            add::<C>(eight_at(table, vector * N + eight * LANES), vector, eight, light, &mut sums);
        }
    }
    sums
}

/// The same between rows of a table: vectors are interpolated first.
#[inline(always)]
pub(crate) fn between_rows<const N: usize, const C: usize>(
    table: &[f32],
    rows: &Between,
    light: &LightVectors,
) -> Partial {
    let mut sums = [f32x8::ZERO; 3];
    for vector in 0..C {
        for eight in 0..const { N.div_ceil(LANES) } {
            let mut values = f32x8::ZERO;
            for &(row, weight) in rows {
                let place = row * C * N + vector * N + eight * LANES;
                values = eight_at(table, place).mul_add(f32x8::splat(weight), values);
            }
            add::<C>(values, vector, eight, light, &mut sums);
        }
    }
    sums
}

#[inline(always)]
pub(super) fn eight_at(table: &[f32], place: usize) -> f32x8 {
    let eight: [f32; LANES] = table[place..place + LANES].try_into().unwrap_or_default();
    f32x8::from(eight)
}

/// Adds eight products of a vector, which is that of all channels or of one.
#[inline(always)]
pub(super) fn add<const C: usize>(
    values: f32x8,
    vector: usize,
    eight: usize,
    light: &LightVectors,
    sums: &mut Partial,
) {
    if C == 1 {
        (0..3).for_each(|channel| sums[channel] = values.mul_add(light[channel][eight], sums[channel]));
    } else {
        sums[vector] = values.mul_add(light[vector][eight], sums[vector]);
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::shared::test_scenes::random;
    use halfshade_sh::dispatch_bands;

    fn check<const N: usize, const C: usize>() {
        let mut random = random(N as u64);
        let rows = 10;
        let mut table: Vec<f32> = (0..rows * N * C).map(|_| random()).collect();
        table.extend([0.0; LANES - 1]);
        let coefficients: [Vec<f32>; 3] = std::array::from_fn(|_| (0..N).map(|_| random()).collect());
        let light: LightVectors = std::array::from_fn(|channel| {
            std::array::from_fn(|eight| {
                let at = |lane| coefficients[channel].get(eight * LANES + lane).copied().unwrap_or(0.0);
                f32x8::from(std::array::from_fn::<_, LANES, _>(at))
            })
        });
        let exact = |row: usize, channel: usize| -> f64 {
            let vector = &table[(row * C + channel.min(C - 1)) * N..][..N];
            vector.iter().zip(&coefficients[channel]).map(|(t, l)| f64::from(*t) * f64::from(*l)).sum()
        };
        let whole = added(|lane| of_row::<N, C>(&table[(lane + 2) * N * C..], &light));
        let same = added(|lane| between_rows::<N, C>(&table, &[(lane + 2, 1.0), (0, 0.0), (0, 0.0)], &light));
        assert_eq!(whole.map(|x| x.to_array()), same.map(|x| x.to_array()));
        let mixed = added(|lane| between_rows::<N, C>(&table, &[(lane, 0.2), (9, 0.5), (lane + 1, 0.3)], &light));
        for lane in 0..LANES {
            for channel in 0..3 {
                let found = |of: &[f32x8; 3]| f64::from(of[channel].to_array()[lane]);
                assert!((found(&whole) - exact(lane + 2, channel)).abs() < 1e-5);
                let at = |row| exact(row, channel);
                let expected = 0.2 * at(lane) + 0.5 * at(9) + 0.3 * at(lane + 1);
                assert!((found(&mixed) - expected).abs() < 1e-5);
            }
        }
    }

    #[test]
    fn sums_are_those_of_plain_loops() {
        for bands in 1..=8 {
            let found = dispatch_bands!(bands, N => {
                check::<N, 1>();
                check::<N, 3>();
            });
            assert!(found.is_some());
        }
    }
}
