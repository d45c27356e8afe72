// Points of the additive recurrence, shifted anew for each receiver: twin of `ray_traced/shade/points.rs`. Numbers of 64 bits
// are pairs, the lower half first.

fn add64(a: vec2u, b: vec2u) -> vec2u {
    let low = a.x + b.x;
    return vec2u(low, a.y + b.y + select(0u, 1u, low < a.x));
}

// The product of two halves, whole.
fn multiply32(a: u32, b: u32) -> vec2u {
    let low = (a & 0xffffu) * (b & 0xffffu);
    let first = (a >> 16u) * (b & 0xffffu);
    let second = (a & 0xffffu) * (b >> 16u);
    let middle = (low >> 16u) + (first & 0xffffu) + (second & 0xffffu);
    let high = (a >> 16u) * (b >> 16u) + (first >> 16u) + (second >> 16u) + (middle >> 16u);
    return vec2u((middle << 16u) | (low & 0xffffu), high);
}

fn multiply64(a: vec2u, b: vec2u) -> vec2u {
    let low = multiply32(a.x, b.x);
    return vec2u(low.x, low.y + a.x * b.y + a.y * b.x);
}

fn shift_right64(a: vec2u, bits: u32) -> vec2u {
    return vec2u((a.x >> bits) | (a.y << (32u - bits)), a.y >> bits);
}

const GOLDEN = vec2u(0x7f4a7c15u, 0x9e3779b9u);

// SplitMix64 of a state that has been moved on.
fn mixed64(state: vec2u) -> vec2u {
    var x = state;
    x = multiply64(x ^ shift_right64(x, 30u), vec2u(0x1ce4e5b9u, 0xbf58476du));
    x = multiply64(x ^ shift_right64(x, 27u), vec2u(0x133111ebu, 0x94d049bbu));
    return x ^ shift_right64(x, 31u);
}

struct Shifts {
    x: vec2u,
    y: vec2u,
    z: vec2u,
}

fn shifts_of(receiver: u32) -> Shifts {
    let first = add64(vec2u(receiver, 0u), GOLDEN);
    let second = add64(first, GOLDEN);
    return Shifts(mixed64(first), mixed64(second), mixed64(add64(second, GOLDEN)));
}

// Coordinate `shift + number · step`, in [0, 1).
fn coordinate(shift: vec2u, step: vec2u, number: u32) -> f32 {
    let fixed = add64(shift, multiply64(step, vec2u(number, 0u)));
    return f32(fixed.y >> 8u) * 5.9604645e-8f;
}
