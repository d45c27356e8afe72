// Directions for one light after another by light times cosine: twin of `ray_traced/shade/product.rs`.
#import "ray_traced/irradiance.wgsl"
#import "ray_traced/light_tree.wgsl"

// The environment, the sun, and then the lamps.
const SUN = 1u;
const FIRST_LAMP = 2u;

// A direction drawn for one light.
struct Drawn {
    direction: vec3f,
    // To what shines.
    distance: f32,
    // Light times cosine over the density.
    arriving: vec3f,
}

fn light_parts() -> u32 {
    return FIRST_LAMP + frame.light_count;
}

// Irradiance of one light if nothing hides it.
fn part_irradiance(part: u32, position: vec3f, normal: vec3f, turned: vec3f) -> vec3f {
    if (part == 0u) {
        return base_irradiance(turned);
    } else if (part == SUN) {
        return sun_irradiance(turned);
    }
    return lamp_irradiance(light_at(part - FIRST_LAMP), position, normal);
}

fn drawn_for(part: u32, position: vec3f, normal: vec3f, turned: vec3f, point: vec2f) -> Drawn {
    if (part >= FIRST_LAMP) {
        let light = light_at(part - FIRST_LAMP);
        let cap = cap_of(light, position);
        let direction = about(cap.axis, point.x * cap.one_minus_cosine, point.y);
        let weight = TAU * cap.one_minus_cosine * max(dot(normal, direction), 0.0);
        return Drawn(direction, distance_to(light, position, direction), light.radiance * weight);
    }
    if (part == SUN) {
        let versine = max(frame.sun.w, 0.0);
        let direction = world_from_environment(about(frame.sun.xyz, point.x * versine, point.y));
        let weight = TAU * versine * max(dot(normal, direction), 0.0);
        return Drawn(direction, 1e30, frame.sun_radiance.xyz * weight);
    }
    if (frame.map_width == 0u) {
        return Drawn(cosine_direction(normal, point.x, point.y), 1e30, PI * frame.constant.xyz);
    }
    let found = map_sample(turned, point);
    let weight = max(dot(turned, found.direction), 0.0) * found.inverse_density;
    let radiance = bitcast<vec4f>(rows[frame.texels + found.texel]).xyz;
    return Drawn(world_from_environment(found.direction), 1e30, radiance * weight);
}
