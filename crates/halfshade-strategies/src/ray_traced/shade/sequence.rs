//! A scrambled Sobol' sequence that receivers share among themselves.

/// Points in two dimensions whose aligned groups of 2^k each fill every dyadic box of area 2^-k once: Sobol' (1967), scrambled
/// as Owen (1995) does, by hashing \[Burley2020\].
///
/// Receiver r with k samples takes the points from r·k on, all of them: of a part every receiver would leave out the same.
/// Receivers that follow each other then fill the square evenly together, too: where neighbours in a picture have neighbouring
/// numbers, noise is blue, as in \[Ahmed2020\].
#[derive(Debug, Clone, Copy)]
pub(crate) struct Sequence {
    first: u32,
}

/// Seeds of the scrambling of either coordinate.
const SEEDS: [u32; 2] = [0x9e37_79b9, 0x7f4a_7c15];

/// The golden ratio less 1, in fixed point: 2^32 is 1.
const GOLDEN: u32 = 0x9e37_79b9;

impl Sequence {
    pub(crate) fn new(receiver: u32, samples: u32) -> Self {
        Self { first: receiver.wrapping_mul(samples) }
    }

    /// Point `i` of this receiver, in [0, 1)².
    pub(crate) fn at(&self, i: u32) -> [f32; 2] {
        let number = self.first.wrapping_add(i);
        [unit(scrambled(number, SEEDS[0])), unit(scrambled(pascal(number), SEEDS[1]))]
    }
}

/// Place of a receiver's samples between equal steps, in [0, 1): multiples of the golden ratio, which have nothing to do with the
/// binary digits that points come from. Otherwise a light that every other receiver draws would show them half of it.
pub(crate) fn offset_of(receiver: u32) -> f32 {
    unit(receiver.wrapping_mul(GOLDEN))
}

/// The upper 24 bits as a number in [0, 1).
fn unit(bits: u32) -> f32 {
    (bits >> 8) as f32 * (1.0 / 16_777_216.0)
}

/// Bits reversed, each flipped by a hash of those before it.
fn scrambled(reversed: u32, seed: u32) -> u32 {
    let mut x = reversed.wrapping_add(seed);
    x ^= x.wrapping_mul(0x6c50_b47c);
    x ^= x.wrapping_mul(0xb82f_1e52);
    x ^= x.wrapping_mul(0xc7af_e638);
    x ^= x.wrapping_mul(0x8d22_f6e6);
    x.reverse_bits()
}

/// Pascal's triangle modulo 2 times the bits of a number: reversed, the second coordinate of Sobol's points.
fn pascal(number: u32) -> u32 {
    const MASKS: [u32; 5] = [0x5555_5555, 0x3333_3333, 0x0f0f_0f0f, 0x00ff_00ff, 0x0000_ffff];
    (0..5).fold(number, |x, k| x ^ (x >> (1 << k) & MASKS[k]))
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Every box of every shape holds one point, in every aligned group.
    #[test]
    fn aligned_groups_fill_every_dyadic_box_once() {
        for (receiver, samples) in [(0, 16), (5, 16), (3, 64), (77, 4), (1_000_003, 8)] {
            let sequence = Sequence::new(receiver, samples);
            for columns in (0..=samples.ilog2()).map(|k| 1 << k) {
                let rows = samples / columns;
                let mut hits = vec![0; samples as usize];
                for i in 0..samples {
                    let [x, y] = sequence.at(i);
                    hits[((y * rows as f32) as u32 * columns + (x * columns as f32) as u32) as usize] += 1;
                }
                assert!(hits.iter().all(|&count| count == 1), "{receiver} {samples} {columns}: {hits:?}");
            }
        }
    }

    /// Sixteen receivers of four samples each make one group of 64.
    #[test]
    fn neighbours_complete_each_other() {
        let mut hits = [0; 64];
        for receiver in 32..48 {
            let sequence = Sequence::new(receiver, 4);
            for [x, y] in (0..4).map(|i| sequence.at(i)) {
                hits[(y * 8.0) as usize * 8 + (x * 8.0) as usize] += 1;
            }
        }
        assert_eq!(hits, [1; 64]);
    }
}
