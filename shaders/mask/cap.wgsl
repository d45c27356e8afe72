// The caps as which receivers see spheres: twin of `mask/kernel/cap.rs`.
#import "common/constants.wgsl"
#import "shared/tangent_plane.wgsl"

// Sines of angular radii below this hide nothing that single precision could tell.
const SMALLEST_SINE = 1e-7f;
// Cotangent of a cap that hides nothing.
const NOTHING = 1e30f;

struct Cap {
    // Unit direction to the middle over the sine of the angular radius.
    axis: vec3f,
    // Cotangent of the angular radius.
    cotangent: f32,
    // Distance of the sphere's centre.
    distance: f32,
    // Tangent of half the angular radius.
    half_tangent: f32,
}

// The cap of a sphere whose centre is at an offset from a receiver.
fn cap_of(offset: vec3f, radius: f32, normal: vec3f) -> Cap {
    let moved = adjusted(offset, radius, normal);
    let distance = length(moved.offset);
    if (!(moved.reach > distance * SMALLEST_SINE)) {
        return Cap(vec3f(0.0), NOTHING, distance, 0.0);
    }
    let axis = moved.offset / moved.reach;
    let per_sine_squared = dot(axis, axis);
    let cotangent = sqrt(max(per_sine_squared - 1.0, 0.0));
    return Cap(axis, cotangent, distance, 1.0 / (sqrt(per_sine_squared) + cotangent));
}

// The part of a cell that a cap's edge closes, so that small caps hide their solid angle.
fn edge_offset(half_tangent: f32, sharpness: f32) -> f32 {
    let widths = min(2.0 * half_tangent * sharpness, 1.0);
    return sqrt(widths) - 0.5 * widths;
}
