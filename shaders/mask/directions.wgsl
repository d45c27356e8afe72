// How far caps close directions: twin of `mask/kernel/directions.rs`.
#import "mask/cap.wgsl"
#import "mask/four.wgsl"

// The part of four directions that is left behind a cap; `rest` is 1 less the part that is closed at the edge.
fn closed(open: vec4f, four: Four, sharpness: vec4f, cap: Cap, rest: f32) -> vec4f {
    let inside = along(four, cap.axis) - cap.cotangent;
    return min(open, max(fma(-inside, sharpness, vec4f(rest)), vec4f(0.0)));
}
