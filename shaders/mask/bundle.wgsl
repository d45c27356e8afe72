// Bundles of directions about an axis, told by their difference from it: twin of `mask/kernel/bundle.rs`.
#import "mask/cap.wgsl"
#import "mask/four.wgsl"

struct Bundle {
    axis: vec3f,
    // Two directions across the axis.
    first: vec3f,
    second: vec3f,
    // Distance from which on nothing is hidden.
    distance: f32,
    // Mean of 1 over the width of an edge.
    sharpness: f32,
    // Chord from the axis up to which a cap may reach its edge and yet hide nothing.
    reach: f32,
}

fn bundle_about(axis: vec3f, distance: f32, sharpness: f32, reach: f32) -> Bundle {
    let side = select(1.0, -1.0, axis.z < 0.0);
    let a = -1.0 / (side + axis.z);
    let b = axis.x * axis.y * a;
    let first = vec3f(1.0 + side * axis.x * axis.x * a, side * b, -side * axis.x);
    return Bundle(axis, first, vec3f(b, side + axis.y * axis.y * a, -axis.y), distance, sharpness, reach);
}

// A vector along the bundle's axes, in light space.
fn in_light_space(bundle: Bundle, shift: Four) -> Four {
    return Four(
        shift.x * bundle.first.x + shift.y * bundle.second.x + shift.z * bundle.axis.x,
        shift.x * bundle.first.y + shift.y * bundle.second.y + shift.z * bundle.axis.y,
        shift.x * bundle.first.z + shift.y * bundle.second.z + shift.z * bundle.axis.z,
    );
}

fn moved(four: Four, by: vec3f) -> Four {
    return Four(four.x + by.x, four.y + by.y, four.z + by.z);
}

// Directions that differ so from the axis.
fn directions_of(bundle: Bundle, shift: Four) -> Four {
    return moved(in_light_space(bundle, shift), bundle.axis);
}

// Cosines of directions with a unit normal.
fn cosines_with(bundle: Bundle, normal: vec3f, shift: Four) -> vec4f {
    return along(in_light_space(bundle, shift), normal) + dot(normal, bundle.axis);
}

// A vector of light space along the bundle's axes.
fn along_axes(bundle: Bundle, vector: vec3f) -> vec3f {
    return vec3f(dot(bundle.first, vector), dot(bundle.second, vector), dot(bundle.axis, vector));
}

fn squared(four: Four) -> vec4f {
    return fma(four.x, four.x, fma(four.y, four.y, four.z * four.z));
}

// Half the squared chords from a unit vector to directions: 1 less their cosine.
fn versines_to(bundle: Bundle, unit: vec3f, shift: Four) -> vec4f {
    return 0.5 * squared(moved(shift, along_axes(bundle, bundle.axis - unit)));
}

// A cap before a bundle.
struct CapBefore {
    // The bundle's axis less the cap's, along the bundle's axes.
    offset: vec3f,
    versine: f32,
    per_sine: f32,
    rest: f32,
    may_hide: bool,
}

fn cap_before(bundle: Bundle, cap: Cap) -> CapBefore {
    if (cap.cotangent >= NOTHING || cap.distance >= bundle.distance) {
        return CapBefore(vec3f(0.0), 0.0, 0.0, 1.0, false);
    }
    let per_sine = length(cap.axis);
    let offset = bundle.axis - cap.axis / per_sine;
    let versine = cap.half_tangent / per_sine;
    let rest = 1.0 - edge_offset(cap.half_tangent, bundle.sharpness);
    let may_hide = length(offset) <= sqrt(2.0 * versine) + bundle.reach;
    return CapBefore(along_axes(bundle, offset), versine, per_sine, rest, may_hide);
}

// The part of four directions, given by their shifts and the sharpness of their cells, that is left behind a cap.
fn closed_before(open: vec4f, shift: Four, sharpness: vec4f, cap: CapBefore) -> vec4f {
    let inside = cap.versine * cap.per_sine - squared(moved(shift, cap.offset)) * (0.5 * cap.per_sine);
    return min(open, max(fma(-inside, sharpness, vec4f(cap.rest)), vec4f(0.0)));
}
