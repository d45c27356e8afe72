// Products of closed forms, one receiver per invocation: twin of `analytic/shade`.
#import "analytic/frame.wgsl"
#import "analytic/overlap.wgsl"
#import "common/cap.wgsl"
#import "common/receivers.wgsl"
#import "shared/placed_lamps.wgsl"

// Whether receivers see the spheres of their own object.
override SEES_OWN: bool = false;

@compute @workgroup_size(64)
fn main(@builtin(global_invocation_id) invocation: vec3u) {
    let number = invocation.x;
    if (number >= receiver_count()) {
        return;
    }
    let receiver = receiver_at(number);
    var irradiance = rest_irradiance(receiver.normal);
    if (any(irradiance != vec3f(0.0))) {
        irradiance *= open_sky(receiver);
    }
    for (var lamp = 0u; lamp < frame.lamp_count; lamp++) {
        irradiance += light_of_lamp(2u * (frame.sphere_count + lamp), receiver);
    }
    reflect(number, irradiance / PI);
}

// A sphere as a receiver sees it.
struct SphereView {
    axis: vec3f,
    // Sine of its angular radius; 0 if it hides nothing.
    sine: f32,
    distance: f32,
}

fn sphere_view(number: u32, receiver: Receiver) -> SphereView {
    let sphere = rows[2u * number];
    let offset = sphere.xyz - receiver.position;
    let distance = length(offset);
    let per_distance = 1.0 / max(distance, SMALLEST);
    let is_seen = SEES_OWN || u32(rows[2u * number + 1u].x) != receiver.object;
    return SphereView(offset * per_distance, select(0.0, min(sphere.w * per_distance, 1.0), is_seen), distance);
}

// The part of the sky that is left.
fn open_sky(receiver: Receiver) -> f32 {
    var open = 1.0;
    for (var number = 0u; number < frame.sphere_count; number++) {
        let view = sphere_view(number, receiver);
        open *= 1.0 - min(cap_irradiance(dot(view.axis, receiver.normal), view.sine) / PI, 1.0);
    }
    return open;
}

// Irradiance of what is left of the lamp whose rows begin there.
fn light_of_lamp(first: u32, receiver: Receiver) -> vec3f {
    let place = rows[first];
    let is_near = rows[first + 1u].w > 0.5;
    let whole = rows[first + 1u].xyz * lamp_form(place, is_near, receiver.position, receiver.normal);
    if (all(whole == vec3f(0.0))) {
        return whole;
    }
    let lamp = seen_lamp(place, is_near, receiver.position, receiver.normal);
    let lamp_radius = angle_of_sine(lamp.sine);
    var open = 1.0;
    for (var number = 0u; number < frame.sphere_count; number++) {
        let view = sphere_view(number, receiver);
        if (view.sine > 0.0 && view.distance < lamp.distance) {
            // The angle between unit vectors, small or large.
            let apart = 2.0 * atan2(length(lamp.axis - view.axis), length(lamp.axis + view.axis));
            open *= 1.0 - hidden_of_cap(lamp_radius, angle_of_sine(view.sine), apart);
        }
    }
    return whole * open;
}

fn angle_of_sine(sine: f32) -> f32 {
    return atan2(sine, sqrt((1.0 - sine) * (1.0 + sine)));
}
