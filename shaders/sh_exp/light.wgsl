// Light times visibility at a white receiver: twin of `sh_exp/kernel/light.rs` and `sh_exp/kernel/sun.rs`.
#import "common/cap.wgsl"
#import "common/constants.wgsl"
#import "common/octahedral.wgsl"
#import "sh_exp/frame.wgsl"

override IS_CLAMPED: bool = false;

// Light that arrives, held between 0 and `most` if that is wanted.
fn held(value: f32, most: f32) -> f32 {
    return select(value, min(max(value, 0.0), most), IS_CLAMPED);
}

fn light(normal: vec3f, visibility: Sh) -> vec3f {
    var radiance = vec3f(0.0);
    if (light_channels() == 0u) {
        radiance = frame.light.xyz * constant_share(normal, visibility);
    } else {
        radiance = tabulated_light(normal, visibility);
    }
    return radiance + sun(normal, visibility);
}

// Share of constant light that is visible, by the cosine.
fn constant_share(normal: vec3f, visibility: Sh) -> f32 {
    let cosine = sh_times_bands(sh_basis(normal), sh_bands(frame.low_cosine, frame.high_cosine));
    return held(sh_dot(cosine, visibility), 1.0);
}

fn tabulated_light(normal: vec3f, visibility: Sh) -> vec3f {
    let found = octahedral_lookup(normal, frame.grid_cells);
    var radiance = vec3f(0.0);
    for (var channel = 0u; channel < light_channels(); channel++) {
        let first = frame.light_table + (found.nodes * light_channels() + channel) * SH_PARTS;
        var sum = 0.0;
        var unshadowed = 0.0;
        for (var part = 0u; part < SH_PARTS; part++) {
            let value = tables[first.x + part] * found.weights.x + tables[first.y + part] * found.weights.y
                + tables[first.z + part] * found.weights.z;
            sum += dot(value, sh_part(visibility, part));
            if (part == 0u) {
                unshadowed = value.x * SQRT_4PI;
            }
        }
        radiance[channel] = held(sum, unshadowed);
    }
    return select(radiance, radiance.xxx, light_channels() == 1u);
}

fn sun(normal: vec3f, visibility: Sh) -> vec3f {
    if (!has_sun()) {
        return vec3f(0.0);
    }
    let sine = frame.sun_perpendicular.w;
    var share = 0.0;
    for (var part = 0u; part < SH_PARTS; part++) {
        share += dot(tables[frame.sun_table + part], sh_part(visibility, part));
    }
    let cosine = dot(frame.sun_direction.xyz, normal);
    var facing = max(cosine, 0.0);
    if (abs(cosine) < sine * 1.000001) {
        facing = cap_irradiance(cosine, sine) / (PI * sine * sine);
    }
    return frame.sun_perpendicular.xyz * (held(share, 1.0) * facing);
}
