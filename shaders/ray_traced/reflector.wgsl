// Directions drawn where a glossy receiver reflects: twin of `ray_traced/shade/reflector.rs`.
#import "common/eye_lobes.wgsl"
#import "common/near_zero.wgsl"
#import "ray_traced/light.wgsl"

// Whether anything is glossy.
override IS_GLOSSY: bool = false;

// As many as a surface has at most, and the diffuse one.
const MOST_LOBES = 5u;

// Lobes of a receiver, each drawn by its power and as often as it reflects.
struct Reflector {
    // The last is the diffuse one.
    lobes: array<Lobe, MOST_LOBES>,
    // 0 where a receiver is diffuse, or turned away from the eye.
    count: u32,
    total: f32,
}

// Reflectance along a direction with its cosines, 1/steradian, and the density of drawn directions there.
struct Reflected {
    reflectance: vec3f,
    density: f32,
}

// Its scale · 2π/(e + 1), summed over the channels.
fn lobe_strength(lobe: Lobe) -> f32 {
    return sum_of(lobe.scale) * TAU / (lobe.exponent + 1.0);
}

// `max(axis·v, 0)^exponent` for unit v. The cosine is had from the distance of the two vectors: a length that is off by
// rounding would change a power of 10^5 by a percent.
fn lobe_power(lobe: Lobe, direction: vec3f) -> f32 {
    let apart = direction - lobe.axis;
    let below_one = 0.5 * dot(apart, apart);
    if (below_one >= 1.0) {
        return 0.0;
    }
    return exp(lobe.exponent * log_one_minus(below_one));
}

fn add_lobe(reflector: ptr<function, Reflector>, lobe: Lobe) {
    let strength = lobe_strength(lobe);
    // Neither black nor beyond all numbers.
    if (strength > 0.0 && strength < 3e38 && (*reflector).count < MOST_LOBES) {
        (*reflector).lobes[(*reflector).count] = lobe;
        (*reflector).count++;
        (*reflector).total += strength;
    }
}

fn reflector_of(number: u32, receiver: Receiver) -> Reflector {
    var reflector = Reflector();
    let object = rows[frame.tables + receiver.object];
    for (var term = 0u; term < object.y; term++) {
        let row = frame.tables + object.x + 2u * term;
        add_lobe(&reflector, eye_lobe(number, receiver, frame.eye.xyz, rows[row], rows[row + 1u]));
    }
    if (reflector.count > 0u) {
        add_lobe(&reflector, Lobe(receiver.normal, 1.0, albedo_of(number) / PI, false));
    }
    return reflector;
}

// A direction; it may lie below the horizon.
fn reflected_direction(reflector: ptr<function, Reflector>, choice: f32, u: f32, v: f32) -> vec3f {
    var left = choice * (*reflector).total;
    var chosen = 0u;
    for (var k = 0u; k < (*reflector).count; k++) {
        chosen = k;
        left -= lobe_strength((*reflector).lobes[k]);
        if (left < 0.0) {
            break;
        }
    }
    let lobe = (*reflector).lobes[chosen];
    // The cosine is (1 - u)^(1/(e + 1)).
    return about(lobe.axis, -exp_minus_one(log_one_minus(u) / (lobe.exponent + 1.0)), v);
}

// Along a unit direction above the horizon.
fn reflected_along(reflector: ptr<function, Reflector>, normal: vec3f, direction: vec3f) -> Reflected {
    let cosine = dot(normal, direction);
    var reflected = Reflected(vec3f(0.0), 0.0);
    for (var k = 0u; k < (*reflector).count; k++) {
        let lobe = (*reflector).lobes[k];
        let power = lobe_power(lobe, direction);
        reflected.reflectance += power * select(1.0, cosine, lobe.times_cosine) * lobe.scale;
        reflected.density += power * sum_of(lobe.scale);
    }
    reflected.density /= (*reflector).total;
    return reflected;
}
