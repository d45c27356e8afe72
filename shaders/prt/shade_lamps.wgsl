// Precomputed radiance transfer under local lights, one receiver per invocation.
#import "common/receivers.wgsl"
#import "prt/dot.wgsl"
#import "prt/gloss.wgsl"
#import "prt/lamps.wgsl"

// Whether anything is glossy.
override IS_GLOSSY: bool = false;

@compute @workgroup_size(64)
fn main(@builtin(global_invocation_id) invocation: vec3u) {
    let number = invocation.x;
    if (number < receiver_count()) {
        let receiver = receiver_at(number);
        let between = points[receiver.group];
        gather_lamps(receiver.position);
        reflect(number, transfer_dot(between));
        if (IS_GLOSSY) {
            add_radiance(number, gloss_of_receiver(number, receiver, between), false);
        }
    }
}
