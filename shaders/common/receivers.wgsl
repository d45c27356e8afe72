// Receivers: where they lie on their objects stays on the device, where the objects are comes with every frame.

// From an object's space to the space of the light, and for directions.
struct Placement {
    position: array<vec4f, 3>,
    direction: array<vec4f, 3>,
}

struct Receiver {
    position: vec3f,
    normal: vec3f,
    object: u32,
    group: u32,
}

// In the space of its object.
struct Place {
    position: vec3f,
    object: u32,
    normal: vec3f,
    // Receivers of a group see the same.
    group: u32,
}

@group(0) @binding(0) var<storage, read> places: array<Place>;
// Albedo, channel by channel; where anything is glossy then factors of gloss: of scales by channel, of exponents.
@group(0) @binding(1) var<storage, read> albedos: array<f32>;
@group(0) @binding(2) var<storage, read> placements: array<Placement>;
// Outgoing radiance, channel by channel; behind it whatever else a kernel keeps of each receiver, likewise.
@group(0) @binding(3) var<storage, read_write> radiances: array<f32>;

fn receiver_count() -> u32 {
    return arrayLength(&places);
}

fn receiver_at(number: u32) -> Receiver {
    let place = places[number];
    let rows = placements[place.object].position;
    let point = vec4f(place.position, 1.0);
    return Receiver(
        vec3f(dot(rows[0], point), dot(rows[1], point), dot(rows[2], point)),
        out_of_object(place.object, place.normal),
        place.object,
        place.group,
    );
}

// A direction that is given in the space of an object.
fn out_of_object(object: u32, direction: vec3f) -> vec3f {
    let rows = placements[object].direction;
    return vec3f(dot(rows[0].xyz, direction), dot(rows[1].xyz, direction), dot(rows[2].xyz, direction));
}

fn albedo_of(number: u32) -> vec3f {
    let count = receiver_count();
    return vec3f(albedos[number], albedos[count + number], albedos[2u * count + number]);
}

// Factors by which a receiver's gloss differs from its material: of scales, and last of exponents.
fn gloss_of(number: u32) -> vec4f {
    let count = receiver_count();
    let first = 3u * count + number;
    return vec4f(albedos[first], albedos[first + count], albedos[first + 2u * count], albedos[first + 3u * count]);
}

// Adds to the light that a receiver reflects, or begins with it; `white` is what it would add if it were white.
fn accumulate(number: u32, white: vec3f, is_first: bool) {
    add_radiance(number, white * albedo_of(number), is_first);
}

// Writes the light that a receiver reflects.
fn reflect(number: u32, white: vec3f) {
    accumulate(number, white, true);
}

// Adds to the light that a receiver sends out, or begins with it.
fn add_radiance(number: u32, radiance: vec3f, is_first: bool) {
    let count = receiver_count();
    for (var channel = 0u; channel < 3u; channel++) {
        let place = channel * count + number;
        radiances[place] = select(radiances[place], 0.0, is_first) + radiance[channel];
    }
}

// Makes less than nothing nothing.
fn clamp_radiance(number: u32) {
    let count = receiver_count();
    for (var channel = 0u; channel < 3u; channel++) {
        let place = channel * count + number;
        radiances[place] = max(radiances[place], 0.0);
    }
}

// A vector that is kept of a receiver from dispatch to dispatch.
fn kept(number: u32, slot: u32) -> vec3f {
    let count = receiver_count();
    let first = 3u * (slot + 1u) * count + number;
    return vec3f(radiances[first], radiances[first + count], radiances[first + 2u * count]);
}

fn keep(number: u32, slot: u32, value: vec3f) {
    let count = receiver_count();
    for (var channel = 0u; channel < 3u; channel++) {
        radiances[(3u * (slot + 1u) + channel) * count + number] = value[channel];
    }
}
