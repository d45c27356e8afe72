// All of the light of a receiver that nothing hides: twin of `shared/irradiance.rs`.
#import "common/cap.wgsl"
#import "common/octahedral.wgsl"
#import "ray_traced/light.wgsl"

// Irradiance from afar without the sun, by a normal of the environment.
fn base_irradiance(normal: vec3f) -> vec3f {
    if (frame.map_width == 0u) {
        return PI * frame.constant.xyz;
    }
    let found = octahedral_lookup(normal, frame.grid_cells);
    let table = frame.irradiances;
    return bitcast<vec4f>(rows[table + found.nodes.x]).xyz * found.weights.x
        + bitcast<vec4f>(rows[table + found.nodes.y]).xyz * found.weights.y
        + bitcast<vec4f>(rows[table + found.nodes.z]).xyz * found.weights.z;
}

// Irradiance of the sun, by a normal of the environment.
fn sun_irradiance(normal: vec3f) -> vec3f {
    let versine = frame.sun.w;
    if (versine < 0.0) {
        return vec3f(0.0);
    }
    return frame.sun_radiance.xyz * cap_irradiance(dot(frame.sun.xyz, normal), sqrt(versine * (2.0 - versine)));
}

fn lamp_irradiance(light: Light, position: vec3f, normal: vec3f) -> vec3f {
    return light.radiance * sphere_irradiance(light.center - position, light.radius, normal);
}

fn irradiance_at(position: vec3f, normal: vec3f) -> vec3f {
    let turned = environment_from_world(normal);
    var sum = base_irradiance(turned) + sun_irradiance(turned);
    for (var i = 0u; i < frame.light_count; i++) {
        sum += lamp_irradiance(light_at(i), position, normal);
    }
    return sum;
}
