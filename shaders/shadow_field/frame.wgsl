// The data of a frame of shadow-field. Numbers of both kinds share rows: a whole number in the bits of a float could be
// taken for a denormal one, and be lost.

struct Frame {
    // Distant light, by four coefficients: red, green, blue.
    light: array<vec4f, 27>,
    // Clamped cosine over π by band, times the rotation's factor.
    low_cosine: vec4f,
    high_cosine: vec4f,
    eye: vec4f,
    // Rows of `rows` at which there begin: SH rotations, orders, lights.
    rotations: u32,
    orders: u32,
    lights: u32,
    // Row of `tables` at which receivers begin.
    receivers: u32,
}

@group(1) @binding(0) var<uniform> frame: Frame;
// Data that changes with every frame: in the first row how many objects and lights there are, then objects, and the rest.
// Counts aren't in `frame`: Mesa's driver in software compiles numbers there that bound loops into the kernel, and compiles
// it again for others.
@group(1) @binding(1) var<storage, read> rows: array<vec4u>;
// The samples of all fields, as they are stored.
@group(1) @binding(2) var<storage, read> samples: array<vec4u>;
// Shells, own occlusion at vertices, the vertices around receivers, terms of reflectances.
@group(1) @binding(3) var<storage, read> tables: array<vec4u>;

// Most lobes of a receiver beside the diffuse part.
override LOBES: u32 = 0u;

fn object_count() -> u32 {
    return rows[0].x;
}

// Distant light is one of them.
fn light_count() -> u32 {
    return rows[0].y;
}

// Row of `tables` at which a receiver begins: vertices around it, and their weights.
fn receiver_row(number: u32) -> u32 {
    return frame.receivers + 2u * number;
}

// A number of a list, four in a row.
fn listed(first: u32, number: u32) -> u32 {
    return rows[first + number / 4u][number % 4u];
}

// Rows of a list.
fn list_rows(count: u32) -> u32 {
    return (count + 3u) / 4u;
}

// Where an object is.
struct FieldObject {
    // Centre of its bounding sphere.
    center: vec3f,
    inverse_radius: f32,
    // From light space, without the scale.
    rotation: array<vec3f, 3>,
    // Row of `tables` at which its field begins; `NO_FIELD` if it hides nothing.
    field: u32,
    // Row of `tables` at which the terms of its reflectance begin, and how many they are.
    terms: u32,
    term_count: u32,
}

const NO_FIELD = 0xffffffffu;

fn object_row(number: u32) -> u32 {
    return 1u + 4u * number;
}

fn object_at(number: u32) -> FieldObject {
    let first = object_row(number);
    let place = bitcast<vec4f>(rows[first]);
    let x = rows[first + 1u];
    let y = rows[first + 2u];
    let z = rows[first + 3u];
    let rotation = array<vec3f, 3>(bitcast<vec3f>(x.xyz), bitcast<vec3f>(y.xyz), bitcast<vec3f>(z.xyz));
    return FieldObject(place.xyz, place.w, rotation, x.w, y.w, z.w);
}

// The object of that number from near to far as seen from another one, which is the first.
fn object_in_order(object: u32, number: u32) -> u32 {
    return listed(frame.orders + object * list_rows(object_count()), number);
}
