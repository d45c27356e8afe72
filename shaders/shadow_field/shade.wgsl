// Shadows of a frame, one receiver per invocation [Tamura2006, figure 3].
#import "common/receivers.wgsl"
#import "shadow_field/bounded_product.wgsl"
#import "shadow_field/gloss.wgsl"
#import "shadow_field/light_order.wgsl"
#import "shadow_field/light_product.wgsl"
#import "shadow_field/occlusion.wgsl"
#import "shared/light_cap.wgsl"

// Whether own occlusion holds the cosine.
override OWN_IS_PROJECTED: bool = false;
// Whether there are local lights.
override HAS_LIGHTS: bool = false;

// Transfer past the objects that are before a light, from near to far. The receiver's own object is one of them, and distant
// light one of the lights, so that products are one place in the code: unrolled, they are most of it.
fn transfer_toward(light: Light, seen: LightSeen, receiver: Receiver, bound: Bound) -> Sh {
    var transfer = bound.shape;
    for (var i = 0u; i < object_count(); i++) {
        let number = object_in_order(receiver.object, i);
        let is_own = number == receiver.object;
        var blocked = Sh();
        if (is_own) {
            let own = own_of(receiver);
            if (OWN_IS_PROJECTED && !own.is_known) {
                continue;
            }
            blocked = own.blocked;
        } else {
            let object = object_at(number);
            if (object.field == NO_FIELD || !(light.is_distant || is_before(light, number, seen, receiver.position))) {
                continue;
            }
            blocked = blocked_at(object, receiver.position);
        }
        let turned = rotated(blocked, number);
        if (OWN_IS_PROJECTED && is_own) {
            transfer = turned;
        } else {
            transfer = bounded_product(bound, transfer, visible_past(turned));
        }
    }
    return transfer;
}

// Light times transfer, over all lights.
fn gathered(receiver: Receiver, bound: Bound) -> vec3f {
    var radiance = vec3f(0.0);
    var past_all = Sh();
    let count = select(1u, light_count(), HAS_LIGHTS);
    for (var i = 0u; i < count; i++) {
        let light = light_at(i);
        let seen = see(light, receiver.position);
        var transfer = past_all;
        if (light.is_distant || !is_behind_all(light, receiver.object, seen, receiver.position)) {
            transfer = transfer_toward(light, seen, receiver, bound);
        }
        if (light.is_distant) {
            past_all = transfer;
            radiance += distant_light(transfer);
        } else {
            let cap = light_cap(seen.offset, seen.distance_squared, seen.is_around, light.radius);
            radiance += light.radiance * sh_dot(cap, transfer);
        }
    }
    return radiance;
}

@compute @workgroup_size(64)
fn main(@builtin(global_invocation_id) invocation: vec3u) {
    let number = invocation.x;
    if (number >= receiver_count()) {
        return;
    }
    let receiver = receiver_at(number);
    if (receiver.object >= object_count()) {
        reflect(number, vec3f(0.0));
        return;
    }
    let cosine = sh_times_bands(sh_basis(receiver.normal), sh_bands(frame.low_cosine, frame.high_cosine));
    var white = vec3f(0.0);
    var glossy = vec3f(0.0);
    for (var i = 0u; i <= LOBES; i++) {
        // The first is the diffuse part.
        var bound = diffuse_bound(cosine);
        var scale = vec3f(0.0);
        if (i > 0u) {
            let lobe = lobe_of(number, receiver, i - 1u);
            scale = lobe.scale;
            if (all(scale == vec3f(0.0))) {
                continue;
            }
            bound = lobe_bound(shape_of(lobe, receiver.normal, cosine));
        }
        let radiance = gathered(receiver, bound);
        if (i == 0u) {
            white = radiance;
        } else {
            glossy += radiance * scale;
        }
    }
    reflect(number, white);
    if (LOBES > 0u) {
        add_radiance(number, glossy, false);
    }
}
