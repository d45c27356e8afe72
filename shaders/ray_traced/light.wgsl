// Everything that shines, and directions drawn where it does: twin of `ray_traced/prepare/light_sampler.rs`.
#import "common/constants.wgsl"
#import "ray_traced/frame.wgsl"

struct Cap {
    axis: vec3f,
    one_minus_cosine: f32,
}

struct Light {
    center: vec3f,
    radius: f32,
    radiance: vec3f,
}

fn light_at(number: u32) -> Light {
    let row = frame.lights + 2u * number;
    let place = bitcast<vec4f>(rows[row]);
    return Light(place.xyz, place.w, bitcast<vec4f>(rows[row + 1u]).xyz);
}

fn sum_of(radiance: vec3f) -> f32 {
    return radiance.x + radiance.y + radiance.z;
}

fn cap_of(light: Light, position: vec3f) -> Cap {
    let offset = light.center - position;
    let distance = length(offset);
    if (distance <= light.radius) {
        return Cap(vec3f(0.0, 1.0, 0.0), 2.0);
    }
    let sine = light.radius / distance;
    let squared = sine * sine;
    return Cap(offset / distance, squared / (1.0 + sqrt((1.0 - sine) * (1.0 + sine))));
}

fn contains(cap: Cap, direction: vec3f) -> bool {
    let apart = direction - cap.axis;
    return 0.5 * dot(apart, apart) <= cap.one_minus_cosine;
}

// The unit vector whose cosine to unit `axis` is `1 - one_minus_cosine`, at `turn` of a full turn around it.
fn about(axis: vec3f, one_minus_cosine: f32, turn: f32) -> vec3f {
    let sine = sqrt(max(one_minus_cosine * (2.0 - one_minus_cosine), 0.0));
    let angle = TAU * turn;
    let side = select(1.0, -1.0, axis.z < 0.0);
    let a = -1.0 / (side + axis.z);
    let b = axis.x * axis.y * a;
    let first = vec3f(1.0 + side * axis.x * axis.x * a, side * b, -side * axis.x);
    let second = vec3f(b, side + axis.y * axis.y * a, -axis.y);
    return sine * (cos(angle) * first + sin(angle) * second) + (1.0 - one_minus_cosine) * axis;
}

// A direction around a unit normal with density cosine/π.
fn cosine_direction(normal: vec3f, u: f32, v: f32) -> vec3f {
    return about(normal, u / (1.0 + sqrt(1.0 - u)), v);
}

fn environment_from_world(v: vec3f) -> vec3f {
    return vec3f(dot(frame.environment[0].xyz, v), dot(frame.environment[1].xyz, v), dot(frame.environment[2].xyz, v));
}

fn world_from_environment(v: vec3f) -> vec3f {
    return frame.environment[0].xyz * v.x + frame.environment[1].xyz * v.y + frame.environment[2].xyz * v.z;
}

// Texel of a map along a unit direction of the environment.
fn texel_along(direction: vec3f) -> u32 {
    let column = (atan2(direction.x, -direction.z) / TAU + 0.5) * f32(frame.map_width);
    let row = acos(clamp(direction.y, -1.0, 1.0)) / PI * f32(frame.map_height);
    let x = u32(max(column, 0.0)) % frame.map_width;
    let y = min(u32(max(row, 0.0)), frame.map_height - 1u);
    return y * frame.map_width + x;
}

// Radiance from infinitely far.
fn distant_radiance(direction: vec3f) -> vec3f {
    let turned = normalize(environment_from_world(direction));
    var radiance = frame.constant.xyz;
    if (frame.map_width > 0u) {
        radiance = bitcast<vec4f>(rows[frame.texels + texel_along(turned)]).xyz;
    }
    if (frame.sun.w >= 0.0 && contains(Cap(frame.sun.xyz, frame.sun.w), turned)) {
        radiance += frame.sun_radiance.xyz;
    }
    return radiance;
}

// All radiance along a ray that nothing blocks.
fn arriving_radiance(position: vec3f, direction: vec3f) -> vec3f {
    var sum = distant_radiance(direction);
    for (var i = 0u; i < frame.light_count; i++) {
        let light = light_at(i);
        if (contains(cap_of(light, position), direction)) {
            sum += light.radiance;
        }
    }
    return sum;
}

// Distance along a ray to the surface of a light that it meets.
fn distance_to(light: Light, position: vec3f, direction: vec3f) -> f32 {
    let offset = light.center - position;
    let along = dot(offset, direction);
    let aside = offset - along * direction;
    let half_chord = sqrt(max(light.radius * light.radius - dot(aside, aside), 0.0));
    let near = along - half_chord;
    return select(along + half_chord, near, near > 0.0);
}

// ∫ of all radiance that could arrive, summed over the channels.
fn power_at(position: vec3f) -> f32 {
    var power = frame.base_power + frame.sun_power;
    for (var i = 0u; i < frame.light_count; i++) {
        let light = light_at(i);
        power += sum_of(light.radiance) * TAU * cap_of(light, position).one_minus_cosine;
    }
    return power;
}

// A direction of the map, in proportion to its radiance.
fn map_direction(u: f32, v: f32) -> vec3f {
    let count = frame.map_width * frame.map_height;
    let place = u * f32(count);
    let cell = min(u32(place), count - 1u);
    let rest = min(place - f32(cell), 1.0);
    let stay = bitcast<f32>(rows[frame.texels + cell].w);
    let other = rows[frame.aliases + cell / 4u][cell % 4u];
    let stays = rest < stay;
    let texel = select(other, cell, stays);
    let across_texel = select((rest - stay) / max(1.0 - stay, 1e-20f), rest / max(stay, 1e-20f), stays);
    let row = f32(texel / frame.map_width);
    let column = f32(texel % frame.map_width);
    let first = cos(PI * row / f32(frame.map_height));
    let second = cos(PI * (row + 1.0) / f32(frame.map_height));
    let up = first + v * (second - first);
    let angle = ((column + across_texel) / f32(frame.map_width) - 0.5) * TAU;
    let across = sqrt(max((1.0 - up) * (1.0 + up), 0.0));
    return vec3f(across * sin(angle), up, -across * cos(angle));
}

// A direction in proportion to radiance.
fn light_direction(position: vec3f, normal: vec3f, power: f32, choice: f32, u: f32, v: f32) -> vec3f {
    var left = choice * power;
    if (left < frame.base_power) {
        if (frame.map_width == 0u) {
            return about(normal, u, v);
        }
        return world_from_environment(map_direction(u, v));
    }
    left -= frame.base_power;
    if (frame.sun.w >= 0.0) {
        if (left < frame.sun_power) {
            return world_from_environment(about(frame.sun.xyz, u * frame.sun.w, v));
        }
        left -= frame.sun_power;
    }
    var last = normal;
    for (var i = 0u; i < frame.light_count; i++) {
        let light = light_at(i);
        let cap = cap_of(light, position);
        last = about(cap.axis, u * cap.one_minus_cosine, v);
        left -= sum_of(light.radiance) * TAU * cap.one_minus_cosine;
        if (left < 0.0) {
            break;
        }
    }
    return last;
}
