// Precomputed radiance transfer, one receiver per invocation.
#import "common/receivers.wgsl"
#import "prt/dot.wgsl"

@compute @workgroup_size(64)
fn main(@builtin(global_invocation_id) invocation: vec3u) {
    let number = invocation.x;
    if (number < receiver_count()) {
        reflect(number, transfer_dot(points[receiver_at(number).group]));
    }
}
