// Light times transfer: twin of `shadow_field/kernel/light_product.rs`.
#import "common/constants.wgsl"
#import "shadow_field/light_order.wgsl"

// A light of radiance 1, as SH: its cap, or all directions where it is around. With s and c the sine and cosine of its
// angular radius, band l is `∫_c^1 2π P_l(x) dx = 2π s² P_l'(c) / (l (l + 1))`, in which nothing cancels; band 0 is
// `2π s² / (1 + c)`.
fn light_cap(light: Light, seen: LightSeen) -> Sh {
    if (seen.is_around) {
        var all = Sh();
        all.h0 = SQRT_4PI;
        return all;
    }
    let squared = max(seen.distance_squared, SMALLEST);
    let sine_squared = min(light.radius * light.radius / squared, 1.0);
    let c = sqrt(1.0 - sine_squared);
    let s = c * c;
    let low = vec4f(2.0 / (1.0 + c), 1.0, c, (5.0 * s - 1.0) * 0.25);
    let high = vec4f(c * (7.0 * s - 3.0) * 0.25, ((21.0 * s - 14.0) * s + 1.0) * 0.125, 0.0, 0.0);
    let scale = sh_bands(low * (PI * sine_squared), high * (PI * sine_squared));
    return sh_add_lobe(seen.offset * inverseSqrt(squared), scale, Sh());
}

// Distant light times transfer, by colour.
fn distant_light(transfer: Sh) -> vec3f {
    var radiance = vec3f(0.0);
    for (var part = 0u; part < SH_PARTS; part++) {
        let first = 3u * part;
        radiance += vec3f(
            dot(frame.light[first], sh_part(transfer, part)),
            dot(frame.light[first + 1u], sh_part(transfer, part)),
            dot(frame.light[first + 2u], sh_part(transfer, part)),
        );
    }
    return radiance;
}
