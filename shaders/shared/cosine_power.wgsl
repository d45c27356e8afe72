// Powers of a clamped cosine in spherical harmonics: twin of `shared/cosine_power.rs`.
#import "common/constants.wgsl"

// `max(a·v, 0)^e`: band l is `2π I_l y_l(a)`, `I_l = I_{l-2} (e - l + 2)/(e + l + 1)`.
fn cosine_power(axis: vec3f, exponent: f32) -> Sh {
    let e = exponent;
    let even = TAU / (e + 1.0);
    let odd = TAU / (e + 2.0);
    let second = even * e / (e + 3.0);
    let third = odd * (e - 1.0) / (e + 4.0);
    let low = vec4f(even, odd, second, third);
    let high = vec4f(second * (e - 2.0) / (e + 5.0), third * (e - 3.0) / (e + 6.0), 0.0, 0.0);
    return sh_times_bands(sh_basis(axis), sh_bands(low, high));
}
