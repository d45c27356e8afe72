// Compressed radiance transfer, one receiver per invocation.
#import "common/receivers.wgsl"
#import "prt/decode.wgsl"

@compute @workgroup_size(64)
fn main(@builtin(global_invocation_id) invocation: vec3u) {
    let number = invocation.x;
    if (number < receiver_count()) {
        reflect(number, decoded_between(points[receiver_at(number).group]));
    }
}
