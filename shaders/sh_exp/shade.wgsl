// Shadows of a frame, one receiver per invocation.
#import "common/receivers.wgsl"
#import "sh_exp/exponential.wgsl"
#import "sh_exp/light.wgsl"
#import "sh_exp/log_sum.wgsl"
#import "sh_exp/product.wgsl"

override IS_PRODUCT: bool = false;

@compute @workgroup_size(64)
fn main(@builtin(global_invocation_id) invocation: vec3u) {
    let number = invocation.x;
    if (number >= receiver_count()) {
        return;
    }
    let receiver = receiver_at(number);
    var visibility = Sh();
    if (IS_PRODUCT) {
        visibility = product_of_blockers(receiver.position, receiver.normal, receiver.group);
    } else {
        visibility = exponential(log_sum(receiver.position, receiver.normal, receiver.group));
    }
    reflect(number, light(receiver.normal, visibility));
}
