// A scrambled Sobol' sequence that receivers share among themselves: twin of `ray_traced/shade/sequence.rs`.

// Seeds of the scrambling of either coordinate.
const FIRST_SEED = 0x9e3779b9u;
const SECOND_SEED = 0x7f4a7c15u;

// The upper 24 bits as a number in [0, 1).
fn unit_of(bits: u32) -> f32 {
    return f32(bits >> 8u) * 5.9604645e-8f;
}

// Bits reversed, each flipped by a hash of those before it.
fn scrambled(reversed: u32, seed: u32) -> u32 {
    var x = reversed + seed;
    x ^= x * 0x6c50b47cu;
    x ^= x * 0xb82f1e52u;
    x ^= x * 0xc7afe638u;
    x ^= x * 0x8d22f6e6u;
    return reverseBits(x);
}

// Pascal's triangle modulo 2 times the bits of a number.
fn pascal(number: u32) -> u32 {
    var x = number;
    x ^= (x >> 1u) & 0x55555555u;
    x ^= (x >> 2u) & 0x33333333u;
    x ^= (x >> 4u) & 0x0f0f0f0fu;
    x ^= (x >> 8u) & 0x00ff00ffu;
    x ^= (x >> 16u) & 0x0000ffffu;
    return x;
}

fn sequence_point(receiver: u32, samples: u32, number: u32) -> vec2f {
    let place = receiver * samples + number;
    return vec2f(unit_of(scrambled(place, FIRST_SEED)), unit_of(scrambled(pascal(place), SECOND_SEED)));
}

// Place of a receiver's samples between equal steps.
fn sequence_offset(receiver: u32) -> f32 {
    // The golden ratio less 1.
    return unit_of(receiver * 0x9e3779b9u);
}
