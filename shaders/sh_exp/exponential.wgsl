// The SH exponential: twin of `halfshade_sh::kernel::BatchExponential::evaluate`.
#import "common/constants.wgsl"
#import "common/near_zero.wgsl"
#import "sh_exp/frame.wgsl"

override MAX_SQUARINGS: u32 = 24u;
// Magnitude beyond which the series is not to be trusted.
override SERIES_MAGNITUDE: f32 = 64.0;

const SERIES = 0u;
const QUADRATIC = 1u;
const LINEAR = 2u;

// Settings of shadows and of reflections: the method, its powers, the magnitude at which squaring starts (negative: never).
override METHOD: u32 = LINEAR;
override TERMS: u32 = 9u;
override MAGNITUDE_LIMIT: f32 = 0.5;
override REFLECTION_METHOD: u32 = LINEAR;
override REFLECTION_TERMS: u32 = 9u;
override REFLECTION_LIMIT: f32 = 4.8;
// Whether one squaring more sets in continuously.
override IS_BLENDED: bool = true;

// A way to the exponential.
struct Form {
    method: u32,
    terms: u32,
    magnitude_limit: f32,
    table: LinearTable,
}

fn shadow_form() -> Form {
    return Form(METHOD, TERMS, MAGNITUDE_LIMIT, frame.shadow_table);
}

fn reflection_form() -> Form {
    return Form(REFLECTION_METHOD, REFLECTION_TERMS, REFLECTION_LIMIT, frame.reflection_table);
}

// (a - 1, b) of the optimal linear form, by magnitude.
fn linear_coefficients(table: LinearTable, magnitude: f32) -> vec2f {
    let at = min(magnitude, table.limit) * table.per_magnitude;
    let low = min(floor(at), table.last);
    let entry = tables[table.row + u32(low)];
    let t = at - low;
    let found = entry.xy + entry.zw * t;
    if (magnitude > table.limit) {
        return vec2f(found.x, found.y * table.limit / max(magnitude, SMALLEST));
    }
    return found;
}

// Holds h = V - 1 to what a function with values in [0, 1] can be.
fn limit_difference(h: Sh) -> Sh {
    let first = clamp(h.h0, -SQRT_4PI, 0.0);
    let room = -first * (SQRT_4PI + first);
    let energy = sh_isolated_energy(h);
    var limited = h;
    if (energy > room) {
        limited = sh_scaled(h, sqrt(room / energy));
    }
    limited.h0 = first;
    return limited;
}

// V*V - 1 from h = V - 1, limited.
fn square_difference(h: Sh) -> Sh {
    return limit_difference(sh_scaled_plus(h, 2.0, sh_square(h)));
}

fn series(isolated: Sh, terms: u32) -> Sh {
    var sum = sh_scaled(isolated, 1.0 / f32(terms));
    for (var k = terms - 1u; k >= 1u; k--) {
        sum = sh_scaled(sh_plus(isolated, sh_product(isolated, sum)), 1.0 / f32(k));
    }
    return sum;
}

// The inner form of `scale` times a vector, as the difference from 1.
fn inner_form(isolated: Sh, constant: f32, magnitude: f32, scale: f32, form: Form) -> Sh {
    let scaled = magnitude * scale;
    var h = isolated;
    var offset = 0.0;
    if (form.method == LINEAR) {
        let coefficients = linear_coefficients(form.table, scaled);
        offset = coefficients.x;
        h = sh_scaled(h, coefficients.y * scale);
    } else {
        let shorten = select(1.0, SERIES_MAGNITUDE / scaled, scaled > SERIES_MAGNITUDE) * scale;
        h = sh_scaled(h, shorten);
        if (form.method == SERIES) {
            h = series(h, form.terms);
        } else {
            h = sh_scaled_plus(sh_square(h), 0.5, h);
        }
    }
    let difference = exp_minus_one(constant * scale);
    let factor = difference + 1.0;
    h = sh_scaled(h, factor);
    h.h0 += (factor * offset + difference) * SQRT_4PI;
    return limit_difference(h);
}

// Visibility from a sum of log blockers.
fn exponential(f: Sh, form: Form) -> Sh {
    let constant = f.h0 / SQRT_4PI;
    var isolated = f;
    isolated.h0 = 0.0;
    let magnitude = sqrt(sh_isolated_energy(f));
    let limit = form.magnitude_limit;
    var scale = 1.0;
    var squarings = 0u;
    if (limit >= 0.0) {
        while (squarings < MAX_SQUARINGS && magnitude * scale > limit) {
            scale *= 0.5;
            squarings++;
        }
    }
    var h = inner_form(isolated, constant, magnitude, scale, form);
    if (IS_BLENDED && limit > 0.0) {
        let weight = clamp(magnitude * scale * (2.0 / limit) - 1.0, 0.0, 1.0);
        if (weight > 0.0) {
            let finer = square_difference(inner_form(isolated, constant, magnitude, 0.5 * scale, form));
            h = sh_mix(h, finer, weight);
        }
    }
    for (var round = 0u; round < squarings; round++) {
        h = square_difference(h);
    }
    h.h0 += SQRT_4PI;
    return h;
}

// The same times a vector: twin of `BatchExponential::evaluate_dot`. Without a squaring the vector itself isn't needed.
fn exponential_dot(f: Sh, weights: Sh, form: Form) -> f32 {
    let magnitude = sqrt(sh_isolated_energy(f));
    let plain = form.magnitude_limit * select(1.0, 0.5, IS_BLENDED);
    if (form.method != LINEAR || (plain >= 0.0 && magnitude > plain)) {
        return sh_dot(exponential(f, form), weights);
    }
    let coefficients = linear_coefficients(form.table, magnitude);
    let difference = exp_minus_one(f.h0 / SQRT_4PI);
    let factor = difference + 1.0;
    let first = clamp((factor * coefficients.x + difference) * SQRT_4PI, -SQRT_4PI, 0.0);
    let room = -first * (SQRT_4PI + first);
    var scale = coefficients.y * factor;
    let energy = scale * magnitude * scale * magnitude;
    if (energy > room) {
        scale *= sqrt(room / energy);
    }
    var isolated = f;
    isolated.h0 = 0.0;
    return (first + SQRT_4PI) * weights.h0 + scale * sh_dot(isolated, weights);
}
