// Irradiance of a cap of directions of radiance 1 that the horizon may cut: twin of
// `halfshade_scene::light::cap_irradiance`.
#import "common/constants.wgsl"

fn cap_irradiance(cosine: f32, sin_radius: f32) -> f32 {
    let sine = clamp(sin_radius, 0.0, 1.0);
    if (cosine >= sine) {
        return PI * sine * sine * min(cosine, 1.0);
    }
    if (cosine <= -sine) {
        return 0.0;
    }
    let cos_radius = sqrt((1.0 - sine) * (1.0 + sine));
    let rim = sqrt(max((sine - cosine) * (sine + cosine), 0.0));
    let over_rim = angle_less_tangent_share(rim, cos_radius, sine * sine);
    return max(over_rim + sine * sine * cosine * atan2(rim, -cosine * cos_radius), 0.0);
}

// `atan2(q, c) - q·c` where q and c are sine and cosine of about the same angle, at most: for small ones the difference
// of almost equal numbers, so by its series. `sine_squared` is 1 - c², which c itself has lost.
fn angle_less_tangent_share(q: f32, c: f32, sine_squared: f32) -> f32 {
    if (q > 0.2 * c) {
        return atan2(q, c) - q * c;
    }
    // atan t = t - t³/3 + t⁵/5 - .., with t = q/c, and t - q·c = t (1 - c²).
    let t = q / c;
    let squared = t * t;
    return t * (sine_squared - squared * (1.0 / 3.0 - squared * (1.0 / 5.0 - squared * (1.0 / 7.0 - squared / 9.0))));
}

// Irradiance of a sphere of radiance 1 whose centre lies at `offset` from the receiver; within it all directions shine.
fn sphere_irradiance(offset: vec3f, radius: f32, normal: vec3f) -> f32 {
    let distance = length(offset);
    if (distance <= radius) {
        return PI;
    }
    return cap_irradiance(dot(offset, normal) / distance, radius / distance);
}
