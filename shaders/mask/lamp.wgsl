// Lamps: twin of `mask/kernel/lamp.rs`.
#import "mask/cap.wgsl"
#import "mask/four.wgsl"
#import "mask/frame.wgsl"
#import "shared/placed_lamps.wgsl"

// A lamp as one receiver sees it.
struct LampView {
    axis: vec3f,
    // Two directions across the axis.
    first: vec3f,
    second: vec3f,
    // 1 less the cosine of its angular radius.
    versine: f32,
    // Distance of its centre.
    distance: f32,
    // 1 over the width of an edge.
    sharpness: f32,
    // Chord from its middle up to which a cap may reach its edge and yet hide nothing.
    reach: f32,
}

// `place` is a sphere, or direction and sine.
fn lamp_view(place: vec4f, is_near: bool, position: vec3f, normal: vec3f) -> LampView {
    let seen = seen_lamp(place, is_near, position, normal);
    let axis = seen.axis;
    let versine = seen.sine * seen.sine / (1.0 + sqrt(max(1.0 - seen.sine * seen.sine, 0.0)));
    let radius = max(sqrt(2.0 * versine / frame.lamp_directions), 1e-18f);
    let side = select(1.0, -1.0, axis.z < 0.0);
    let a = -1.0 / (side + axis.z);
    let b = axis.x * axis.y * a;
    return LampView(
        axis,
        vec3f(1.0 + side * axis.x * axis.x * a, side * b, -side * axis.x),
        vec3f(b, side + axis.y * axis.y * a, -axis.y),
        versine,
        seen.distance,
        1.0 / (frame.edge * radius),
        sqrt(2.0 * versine) + frame.edge * radius,
    );
}

// Four directions of a cap of this versine less its axis, along its own three axes.
fn spread(versine: f32, within: vec4f, cosine: vec4f, sine: vec4f) -> Four {
    let fall = within * versine;
    let across = sqrt(max(fall * (2.0 - fall), vec4f(0.0)));
    return Four(across * cosine, across * sine, -fall);
}

// A vector along a lamp's axes, in light space.
fn in_light_space(view: LampView, shift: Four) -> Four {
    return Four(
        shift.x * view.first.x + shift.y * view.second.x + shift.z * view.axis.x,
        shift.x * view.first.y + shift.y * view.second.y + shift.z * view.axis.y,
        shift.x * view.first.z + shift.y * view.second.z + shift.z * view.axis.z,
    );
}

fn moved(four: Four, by: vec3f) -> Four {
    return Four(four.x + by.x, four.y + by.y, four.z + by.z);
}

// A cap before a lamp.
struct LampCap {
    // The lamp's axis less the cap's, along the lamp's axes.
    offset: vec3f,
    versine: f32,
    per_sine: f32,
    rest: f32,
    may_hide: bool,
}

fn lamp_cap(view: LampView, cap: Cap) -> LampCap {
    if (cap.cotangent >= NOTHING || cap.distance >= view.distance) {
        return LampCap(vec3f(0.0), 0.0, 0.0, 1.0, false);
    }
    let per_sine = length(cap.axis);
    let offset = view.axis - cap.axis / per_sine;
    let versine = cap.half_tangent / per_sine;
    return LampCap(
        vec3f(dot(view.first, offset), dot(view.second, offset), dot(view.axis, offset)),
        versine,
        per_sine,
        1.0 - edge_offset(cap.half_tangent, view.sharpness),
        length(offset) <= sqrt(2.0 * versine) + view.reach,
    );
}

// The part of four directions, given by their shifts, that is left behind a cap.
fn closed_before(open: vec4f, shift: Four, view: LampView, cap: LampCap) -> vec4f {
    let chord = moved(shift, cap.offset);
    let chord_squared = fma(chord.x, chord.x, fma(chord.y, chord.y, chord.z * chord.z));
    let inside = cap.versine * cap.per_sine - chord_squared * (0.5 * cap.per_sine);
    return min(open, max(fma(-inside, vec4f(view.sharpness), vec4f(cap.rest)), vec4f(0.0)));
}
