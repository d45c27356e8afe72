// The SH exponential: twin of `halfshade_sh::kernel::BatchExponential::evaluate`.
#import "common/constants.wgsl"
#import "sh_exp/frame.wgsl"

override MAX_SQUARINGS: u32 = 24u;
// Magnitude beyond which the series is not to be trusted.
override SERIES_MAGNITUDE: f32 = 64.0;

const SERIES = 0u;
const QUADRATIC = 1u;
const LINEAR = 2u;

override METHOD: u32 = LINEAR;
override TERMS: u32 = 9u;
// At which squaring starts; negative: never.
override MAGNITUDE_LIMIT: f32 = 0.5;
override IS_BLENDED: bool = true;

// exp(x) - 1 without cancellation.
fn exp_minus_one(x: f32) -> f32 {
    if (abs(x) > 0.5) {
        return exp(x) - 1.0;
    }
    var sum = 1.0 + x / 9.0;
    for (var k = 8.0; k > 1.5; k -= 1.0) {
        sum = 1.0 + x / k * sum;
    }
    return x * sum;
}

// (a - 1, b) of the optimal linear form, by magnitude.
fn linear_coefficients(magnitude: f32) -> vec2f {
    let at = min(magnitude, frame.exponential_limit) * frame.exponential_per_magnitude;
    let low = min(floor(at), frame.exponential_last);
    let entry = tables[frame.exponential_table + u32(low)];
    let t = at - low;
    let found = entry.xy + entry.zw * t;
    if (magnitude > frame.exponential_limit) {
        return vec2f(found.x, found.y * frame.exponential_limit / max(magnitude, SMALLEST));
    }
    return found;
}

// Holds h = V - 1 to what a function with values in [0, 1] can be.
fn limit_difference(h: Sh) -> Sh {
    let first = clamp(h[0], -SQRT_4PI, 0.0);
    let room = -first * (SQRT_4PI + first);
    let energy = sh_isolated_energy(h);
    var limited = h;
    if (energy > room) {
        limited = sh_scaled(h, sqrt(room / energy));
    }
    limited[0] = first;
    return limited;
}

// V*V - 1 from h = V - 1, limited.
fn square_difference(h: Sh) -> Sh {
    return limit_difference(sh_scaled_plus(h, 2.0, sh_square(h)));
}

fn series(isolated: Sh) -> Sh {
    var sum = sh_scaled(isolated, 1.0 / f32(TERMS));
    for (var k = TERMS - 1u; k >= 1u; k--) {
        sum = sh_scaled(sh_plus(isolated, sh_product(isolated, sum)), 1.0 / f32(k));
    }
    return sum;
}

// The inner form of `scale` times a vector, as the difference from 1.
fn inner_form(isolated: Sh, constant: f32, magnitude: f32, scale: f32) -> Sh {
    let scaled = magnitude * scale;
    var h = isolated;
    var offset = 0.0;
    if (METHOD == LINEAR) {
        let coefficients = linear_coefficients(scaled);
        offset = coefficients.x;
        h = sh_scaled(h, coefficients.y * scale);
    } else {
        let shorten = select(1.0, SERIES_MAGNITUDE / scaled, scaled > SERIES_MAGNITUDE) * scale;
        h = sh_scaled(h, shorten);
        if (METHOD == SERIES) {
            h = series(h);
        } else {
            h = sh_scaled_plus(sh_square(h), 0.5, h);
        }
    }
    let difference = exp_minus_one(constant * scale);
    let factor = difference + 1.0;
    h = sh_scaled(h, factor);
    h[0] += (factor * offset + difference) * SQRT_4PI;
    return limit_difference(h);
}

// Visibility from a sum of log blockers.
fn exponential(f: Sh) -> Sh {
    let constant = f[0] / SQRT_4PI;
    var isolated = f;
    isolated[0] = 0.0;
    let magnitude = sqrt(sh_isolated_energy(f));
    var scale = 1.0;
    var squarings = 0u;
    if (MAGNITUDE_LIMIT >= 0.0) {
        while (squarings < MAX_SQUARINGS && magnitude * scale > MAGNITUDE_LIMIT) {
            scale *= 0.5;
            squarings++;
        }
    }
    var h = inner_form(isolated, constant, magnitude, scale);
    if (IS_BLENDED && MAGNITUDE_LIMIT > 0.0) {
        let weight = clamp(magnitude * scale * (2.0 / MAGNITUDE_LIMIT) - 1.0, 0.0, 1.0);
        if (weight > 0.0) {
            h = sh_mix(h, square_difference(inner_form(isolated, constant, magnitude, 0.5 * scale)), weight);
        }
    }
    for (var round = 0u; round < squarings; round++) {
        h = square_difference(h);
    }
    h[0] += SQRT_4PI;
    return h;
}
