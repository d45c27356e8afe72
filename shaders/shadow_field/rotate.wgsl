// SH rotation from object space into light space, and visibility from occlusion: twin of `shadow_field/kernel/rotate.rs`.
#import "common/constants.wgsl"
#import "shadow_field/frame.wgsl"
#import "sh/rotation"

// Four of the blocks' values: band by band, row by row.
fn sh_rotation_part(row: u32) -> vec4f {
    return bitcast<vec4f>(rows[row]);
}

// A vector in the space of an object, turned.
fn rotated(vector: Sh, object: u32) -> Sh {
    return sh_rotated(vector, frame.rotations + object * SH_ROTATION_PARTS);
}

// The visibility that an occlusion leaves.
fn visible_past(blocked: Sh) -> Sh {
    var visible = sh_scaled(blocked, -1.0);
    visible.h0 += SQRT_4PI;
    return visible;
}
