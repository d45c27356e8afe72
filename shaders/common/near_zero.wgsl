// Functions that cancel next to zero: twins of `f64::exp_m1` and `f64::ln_1p`.

// exp(x) - 1.
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

// log(1 - x) for x in [-1/4, 1).
fn log_one_minus(x: f32) -> f32 {
    if (x > 0.25) {
        return log(1.0 - x);
    }
    // log((1 - z)/(1 + z)) = -2 (z + z³/3 + z⁵/5 + ..), with z = x/(2 - x).
    let z = x / (2.0 - x);
    let squared = z * z;
    return -2.0 * z * (1.0 + squared * (1.0 / 3.0 + squared * (1.0 / 5.0 + squared / 7.0)));
}
