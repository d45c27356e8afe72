// Light of a frame, one receiver per invocation.
#import "common/receivers.wgsl"
#import "sh_exp/exponential.wgsl"
#import "sh_exp/gather.wgsl"
#import "sh_exp/ground.wgsl"
#import "sh_exp/lamps.wgsl"
#import "sh_exp/light.wgsl"
#import "sh_exp/log_sum.wgsl"
#import "sh_exp/own.wgsl"
#import "sh_exp/product.wgsl"
#import "sh_exp/shares.wgsl"

const EXPONENTIAL = 0u;
const PRODUCT = 1u;
const SHARES = 2u;

// How blockers combine.
override COMBINATION: u32 = EXPONENTIAL;
// Whether spheres radiate.
override REFLECTS: bool = false;

@compute @workgroup_size(64)
fn main(@builtin(global_invocation_id) invocation: vec3u) {
    let number = invocation.x;
    if (number >= receiver_count()) {
        return;
    }
    let receiver = receiver_at(number);
    let cut = cut_of_receiver(receiver);
    var gathered = Gathered(vec3f(0.0), Sh());
    if (REFLECTS) {
        gathered = gather(receiver, cut);
    } else if (COMBINATION == EXPONENTIAL) {
        gathered.log_sum = log_sum(receiver.position, receiver.normal, cut);
    }
    var visibility = Sh();
    if (COMBINATION == PRODUCT) {
        visibility = product_of_blockers(receiver.position, receiver.normal, cut);
    } else if (COMBINATION == SHARES) {
        visibility = shares_of_blockers(receiver.position, receiver.normal, cut);
    } else {
        visibility = exponential(gathered.log_sum, shadow_form());
    }
    visibility = past_own(receiver, visibility);
    var radiance = light(receiver.normal, visibility);
    if (has_ground(receiver.object)) {
        radiance = with_ground(receiver, visibility, radiance);
    }
    radiance += lamp_light(receiver, cut, visibility);
    reflect(number, radiance + select(gathered.radiance, max(gathered.radiance, vec3f(0.0)), IS_CLAMPED));
}

// Adds the light of objects without spheres, and takes away the light that they block.
fn with_ground(receiver: Receiver, visibility: Sh, direct: vec3f) -> vec3f {
    let weights = visible_reflectance(receiver.normal, visibility);
    let seen = ground_radiance(receiver.object, receiver.position, weights, true);
    if (!IS_CLAMPED) {
        return direct + seen;
    }
    let taken = ground_radiance(receiver.object, receiver.position, weights, false);
    var open = Sh();
    open.h0 = SQRT_4PI;
    let most = light(receiver.normal, open);
    return min(max(direct + taken, vec3f(0.0)), most) + max(seen - taken, vec3f(0.0));
}
