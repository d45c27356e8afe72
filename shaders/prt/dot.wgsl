// Transfer times light: twin of `prt/kernel/dot.rs`.

// Rows of four numbers that a vector takes.
override PARTS: u32 = 4u;
// Vectors of a vertex: one for all channels, or one each.
override CHANNELS: u32 = 1u;

// Number of local lights: with any, every receiver has light of its own.
override LAMPS: u32 = 0u;

struct Frame {
    // Light by channel and four coefficients, filled up with zeros: red, green, blue.
    light: array<vec4f, 48>,
    // From the world into the space of the vectors.
    baked_from_world: array<vec4f, 3>,
    // Among the receivers.
    eye: vec4f,
}

// A receiver between vertices: the rows at which their vectors begin, and weights; all 0 where no light arrives. Of a glossy one
// also the rows at which their matrices begin, the fit of lobes, and the terms of reflectance.
struct Between {
    rows: vec3u,
    fit: u32,
    weights: vec3f,
    terms: u32,
    matrices: vec3u,
    term_count: u32,
}

@group(1) @binding(0) var<storage, read> frame: Frame;
// Vectors, each in rows of its own; then fits, terms and matrices where anything is glossy.
@group(1) @binding(1) var<storage, read> rows: array<vec4f>;
@group(1) @binding(2) var<storage, read> points: array<Between>;

// Light of the receiver, as that of the frame, where it has its own.
var<private> receiver_light: array<vec4f, 48>;

// Four coefficients of light.
fn light_part(place: u32) -> vec4f {
    if (LAMPS > 0u) {
        return receiver_light[place];
    }
    return frame.light[place];
}

// Four numbers of the interpolated vector.
fn transfer_part(between: Between, part: u32) -> vec4f {
    return between.weights.x * rows[between.rows.x + part] + between.weights.y * rows[between.rows.y + part]
        + between.weights.z * rows[between.rows.z + part];
}

// Radiance of a white receiver.
fn transfer_dot(between: Between) -> vec3f {
    var radiance = vec3f(0.0);
    for (var part = 0u; part < PARTS; part++) {
        let red = transfer_part(between, part);
        var green = red;
        var blue = red;
        if (CHANNELS > 1u) {
            green = transfer_part(between, PARTS + part);
            blue = transfer_part(between, 2u * PARTS + part);
        }
        radiance += vec3f(
            dot(light_part(part), red),
            dot(light_part(16u + part), green),
            dot(light_part(32u + part), blue),
        );
    }
    return radiance;
}
