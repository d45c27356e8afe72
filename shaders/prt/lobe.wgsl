// Glossy lobes times matrices of transfer: twin of `prt/kernel/lobe.rs`.
#import "common/constants.wgsl"
#import "prt/dot.wgsl"

// Bands of vectors and matrices.
override BANDS: u32 = 4u;

// Bands of a lobe before it is fitted.
const LOBE_BANDS = 8u;

// Light that a row of a matrix is multiplied with, by channel: rows of four numbers, of one matrix for all channels or of one each.
fn matrix_row_dot(matrix: u32, row: u32) -> vec3f {
    var sums = vec3f(0.0);
    let size = BANDS * BANDS * PARTS;
    let first = matrix + row * PARTS;
    for (var part = 0u; part < PARTS; part++) {
        let red = rows[first + part];
        var green = red;
        var blue = red;
        if (CHANNELS > 1u) {
            green = rows[first + size + part];
            blue = rows[first + 2u * size + part];
        }
        sums += vec3f(
            dot(light_part(part), red),
            dot(light_part(16u + part), green),
            dot(light_part(32u + part), blue),
        );
    }
    return sums;
}

// A factor of the fit, of which eight lie in two rows for each degree and order.
fn fit_factor(fit: u32, degree: u32, order: u32, power: u32) -> f32 {
    return rows[fit + 2u * (LOBE_BANDS * degree + order) + power / 4u][power % 4u];
}

// `b^T M l` for b the fit of `max(axis·v, 0)^exponent`, with the axis in the frame of the matrix: order by order, degrees by recurrence.
fn lobe_product(matrix: u32, fit: u32, axis: vec3f, exponent: f32) -> vec3f {
    var integrals = array<f32, 8>();
    integrals[0] = TAU / (exponent + 1.0);
    integrals[1] = TAU / (exponent + 2.0);
    for (var l = 2u; l < LOBE_BANDS; l++) {
        integrals[l] = integrals[l - 2u] * (exponent - f32(l) + 2.0) / (exponent + f32(l) + 1.0);
    }
    var radiance = vec3f(0.0);
    // (x + iy)^m, and the first function of order m without it.
    var turn = vec2f(1.0, 0.0);
    var sectoral = sqrt(0.5 / TAU);
    for (var m = 0u; m < BANDS; m++) {
        let order = f32(m);
        var power = array<f32, 8>();
        var below = 0.0;
        var current = sectoral;
        for (var l = m; l < LOBE_BANDS; l++) {
            if (l > m) {
                let degree = f32(l);
                let less = degree - 1.0;
                let alpha = sqrt((4.0 * degree * degree - 1.0) / (degree * degree - order * order));
                let beta = alpha * sqrt(max(less * less - order * order, 0.0) / (4.0 * less * less - 1.0));
                let next = alpha * axis.z * current - beta * below;
                below = current;
                current = next;
            }
            power[l] = integrals[l] * current;
        }
        for (var l = m; l < BANDS; l++) {
            var fitted = 0.0;
            for (var k = m; k < LOBE_BANDS; k++) {
                fitted = fma(fit_factor(fit, l, m, k), power[k], fitted);
            }
            let middle = l * (l + 1u);
            radiance += fitted * turn.x * matrix_row_dot(matrix, middle + m);
            if (m > 0u) {
                radiance += fitted * turn.y * matrix_row_dot(matrix, middle - m);
            }
        }
        turn = vec2f(axis.x * turn.x - axis.y * turn.y, axis.x * turn.y + axis.y * turn.x);
        sectoral *= -sqrt((2.0 * order + 3.0) / (2.0 * order + 2.0));
        if (m == 0u) {
            sectoral *= sqrt(2.0);
        }
    }
    return radiance;
}
