// Lobes of glossy reflectance, each looked along in directions of its own: twin of `mask/kernel/lobe.rs`.
#import "common/near_zero.wgsl"
#import "common/reflectance.wgsl"
#import "mask/bundle.wgsl"
#import "mask/frame.wgsl"

struct LobeView {
    bundle: Bundle,
    exponent: f32,
    // 1 / (e + 1): the versine of a cap of as many steradians.
    versine: f32,
    // Sharpness along the axis.
    sharpness: f32,
}

// Spheres as far as `distance` hide nothing.
fn lobe_view(axis: vec3f, exponent: f32, distance: f32) -> LobeView {
    let count = 16.0 * f32(frame.lobe_sixteens);
    let versine = 1.0 / (exponent + 1.0);
    let sharpness = 1.0 / (frame.edge * sqrt(2.0 * versine / count));
    // The outermost has half a direction's part without.
    let log_without = log(2.0 * count);
    let outermost = sqrt(-2.0 * exp_minus_one(-log_without * versine));
    let narrowest = sharpness * exp(-0.5 * exponent * versine * log_without);
    let mean = sharpness * (2.0 / 3.0 * exponent + 1.0) * versine;
    return LobeView(bundle_about(axis, distance, mean, outermost + 1.0 / narrowest), exponent, versine, sharpness);
}

// 1 - exp(-x) for x from 0 on.
fn lacking(x: vec4f) -> vec4f {
    return -vec4f(exp_minus_one(-x.x), exp_minus_one(-x.y), exp_minus_one(-x.z), exp_minus_one(-x.w));
}

// Four directions less the axis, along the bundle's axes.
fn lobe_shift(versine: f32, logs: vec4f, cosine: vec4f, sine: vec4f) -> Four {
    let fall = lacking(logs * versine);
    let across = sqrt(max(fall * (2.0 - fall), vec4f(0.0)));
    return Four(across * cosine, across * sine, -fall);
}

// 1 over the width of the edges of four directions.
fn lobe_sharpness(view: LobeView, logs: vec4f) -> vec4f {
    return view.sharpness * exp(-0.5 * view.exponent * view.versine * logs);
}

fn power_of(exponent: f32, versine: f32) -> f32 {
    if (versine >= 1.0) {
        return 0.0;
    }
    return exp(exponent * log_one_minus(versine));
}

// The power of a lobe in directions by 1 less their cosine with its axis.
fn powers(exponent: f32, versine: vec4f) -> vec4f {
    return vec4f(power_of(exponent, versine.x), power_of(exponent, versine.y), power_of(exponent, versine.z),
        power_of(exponent, versine.w));
}

// The factor of a lobe beside its power in directions with cosine `above`: the cosine, or how much of their cells is above the horizon.
fn horizon(lobe: Lobe, above: vec4f, sharpness: vec4f) -> vec4f {
    if (lobe.times_cosine) {
        return max(above, vec4f(0.0));
    }
    return clamp(fma(above, sharpness, vec4f(0.5)), vec4f(0.0), vec4f(1.0));
}
