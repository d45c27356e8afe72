// Light without visibility, one receiver per invocation: twin of `unshadowed.rs`.
#import "common/cap.wgsl"
#import "common/octahedral.wgsl"
#import "common/receivers.wgsl"

struct Frame {
    // Irradiance by constant light; by a map, the table counts.
    constant: vec4f,
    // Direction to the sun's centre, and the sine of its angular radius; 0 without a sun.
    sun_direction: vec4f,
    sun_radiance: vec4f,
    light_count: u32,
    is_tabulated: u32,
    grid_cells: f32,
    padding: u32,
}

struct Light {
    // Centre and radius.
    sphere: vec4f,
    radiance: vec4f,
}

// In storage: numbers of a uniform that decide branches Mesa's driver in software compiles into the kernel, with every dispatch.
@group(1) @binding(0) var<storage, read> frame: Frame;
@group(1) @binding(1) var<storage, read> lights: array<Light>;
// Irradiance at each node of the grid.
@group(1) @binding(2) var<storage, read> table: array<vec4f>;

fn irradiance(receiver: Receiver) -> vec3f {
    var sum = frame.constant.xyz;
    if (frame.is_tabulated != 0u) {
        let found = octahedral_lookup(receiver.normal, frame.grid_cells);
        sum = table[found.nodes.x].xyz * found.weights.x + table[found.nodes.y].xyz * found.weights.y
            + table[found.nodes.z].xyz * found.weights.z;
    }
    let sine = frame.sun_direction.w;
    if (sine > 0.0) {
        sum += frame.sun_radiance.xyz * cap_irradiance(dot(frame.sun_direction.xyz, receiver.normal), sine);
    }
    for (var i = 0u; i < frame.light_count; i++) {
        let sphere = lights[i].sphere;
        sum += lights[i].radiance.xyz * sphere_irradiance(sphere.xyz - receiver.position, sphere.w, receiver.normal);
    }
    return sum;
}

@compute @workgroup_size(64)
fn main(@builtin(global_invocation_id) invocation: vec3u) {
    let number = invocation.x;
    if (number < receiver_count()) {
        reflect(number, irradiance(receiver_at(number)) / PI);
    }
}
