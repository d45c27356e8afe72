// The order of an object and a local light from a receiver [Tamura2006, figure 3]: twin of
// `shadow_field/kernel/light_order.rs`.
#import "shadow_field/frame.wgsl"

const OUTSIDE = 0u;
const CENTER = 1u;
const WHOLE = 2u;

// A local light, or all that is distant, which has none of what follows.
struct Light {
    is_distant: bool,
    center: vec3f,
    radius: f32,
    radiance: vec3f,
    // Row of `rows` at which it is told how much of each object lies within.
    holds: u32,
}

// The first is distant.
fn light_at(number: u32) -> Light {
    let first = frame.lights + number * (2u + list_rows(object_count()));
    let sphere = bitcast<vec4f>(rows[first]);
    let color = rows[first + 1u];
    return Light(color.w != 0u, sphere.xyz, sphere.w, bitcast<vec3f>(color.xyz), first + 2u);
}

// Where a receiver sees a light.
struct LightSeen {
    offset: vec3f,
    distance_squared: f32,
    // Whether it is all around, on its surface too.
    is_around: bool,
}

fn see(light: Light, position: vec3f) -> LightSeen {
    let offset = light.center - position;
    let distance_squared = dot(offset, offset);
    return LightSeen(offset, distance_squared, distance_squared <= light.radius * light.radius);
}

// Whether an object is before a light.
fn is_before(light: Light, object: u32, seen: LightSeen, position: vec3f) -> bool {
    let containment = listed(light.holds, object);
    if (seen.is_around) {
        return containment != OUTSIDE;
    }
    let offset = bitcast<vec3f>(rows[object_row(object)].xyz) - position;
    return containment != WHOLE && dot(offset, offset) < seen.distance_squared;
}

// Whether no object is behind a local light.
fn is_behind_all(light: Light, receiver_object: u32, seen: LightSeen, position: vec3f) -> bool {
    for (var i = 1u; i < object_count(); i++) {
        let other = object_in_order(receiver_object, i);
        if (object_at(other).field != NO_FIELD && !is_before(light, other, seen, position)) {
            return false;
        }
    }
    return true;
}
