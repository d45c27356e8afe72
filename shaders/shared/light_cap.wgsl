// A local light in spherical harmonics, as a receiver sees it: twin of `shared/light_cap.rs`.
#import "common/constants.wgsl"

// A light of radiance 1: its cap, or all directions where it is around. Its centre is at `offset`. With s and c the sine and cosine
// of its angular radius, band l is `∫_c^1 2π P_l(x) dx = 2π s² P_l'(c) / (l (l + 1))`, in which nothing cancels; band 0 is
// `2π s² / (1 + c)`.
fn light_cap(offset: vec3f, distance_squared: f32, is_around: bool, radius: f32) -> Sh {
    if (is_around) {
        var all = Sh();
        all.h0 = SQRT_4PI;
        return all;
    }
    let squared = max(distance_squared, SMALLEST);
    let sine_squared = min(radius * radius / squared, 1.0);
    let c = sqrt(1.0 - sine_squared);
    let s = c * c;
    let low = vec4f(2.0 / (1.0 + c), 1.0, c, (5.0 * s - 1.0) * 0.25);
    let high = vec4f(c * (7.0 * s - 3.0) * 0.25, ((21.0 * s - 14.0) * s + 1.0) * 0.125, 0.0, 0.0);
    let scale = sh_bands(low * (PI * sine_squared), high * (PI * sine_squared));
    return sh_add_lobe(offset * inverseSqrt(squared), scale, Sh());
}
