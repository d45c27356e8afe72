// The part of a cap of directions that another cap hides: twin of `analytic/kernel/overlap.rs`.
#import "common/constants.wgsl"

fn versine(angle: f32) -> f32 {
    let half = sin(0.5 * angle);
    return 2.0 * half * half;
}

fn twice_atan(above: f32, below: f32) -> f32 {
    return 2.0 * atan2(sqrt(above), sqrt(max(below, 1e-37f)));
}

// The part of a cap of angular radius `lamp` that one of angular radius `cap` hides, `apart` the angle between their middles.
fn hidden_of_cap(lamp: f32, cap: f32, apart: f32) -> f32 {
    if (apart >= lamp + cap) {
        return 0.0;
    }
    let whole = versine(lamp);
    let hiding = versine(cap);
    let within = min(hiding / whole, 1.0);
    if (apart <= abs(lamp - cap)) {
        return within;
    }
    // Half the sum of the sides, and that less each of them; halves again, for tangents of quarters.
    let half_sum = 0.5 * (lamp + cap + apart);
    let halves = 0.5 * max(vec4f(half_sum, half_sum - lamp, half_sum - cap, half_sum - apart), vec4f(0.0));
    let sine = max(sin(halves), vec4f(0.0));
    let cosine = max(cos(halves), vec4f(0.0));
    // Sines of the whole: all, less the lamp, less the cap, less what they are apart.
    let sines = sine * cosine;
    let alpha = twice_atan(sines.y * sines.w, sines.x * sines.z);
    let beta = twice_atan(sines.z * sines.w, sines.x * sines.y);
    let excess = 2.0 * twice_atan(sine.x * sine.y * sine.z * sine.w, cosine.x * cosine.y * cosine.z * cosine.w);
    let area = (alpha * whole + (beta * hiding - excess)) / PI;
    return clamp(area / whole, 0.0, within);
}
