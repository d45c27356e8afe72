// Lamps: twin of `mask/kernel/lamp.rs`.
#import "mask/bundle.wgsl"
#import "mask/frame.wgsl"
#import "shared/placed_lamps.wgsl"

// A lamp as one receiver sees it.
struct LampView {
    bundle: Bundle,
    // 1 less the cosine of its angular radius, and the sine.
    versine: f32,
    sine: f32,
    // Whether the receiver lies within the light.
    is_all_around: bool,
}

// `place` is a sphere, or direction and sine.
fn lamp_view(place: vec4f, is_near: bool, position: vec3f, normal: vec3f) -> LampView {
    let seen = seen_lamp(place, is_near, position, normal);
    let versine = seen.sine * seen.sine / (1.0 + sqrt(max(1.0 - seen.sine * seen.sine, 0.0)));
    let radius = max(sqrt(2.0 * versine / frame.lamp_directions), 1e-18f);
    let reach = sqrt(2.0 * versine) + frame.edge * radius;
    let bundle = bundle_about(seen.axis, seen.distance, 1.0 / (frame.edge * radius), reach);
    return LampView(bundle, versine, seen.sine, is_near && seen.distance <= place.w);
}

// Four directions of a cap of this versine less its axis, along the bundle's axes.
fn spread(versine: f32, within: vec4f, cosine: vec4f, sine: vec4f) -> Four {
    let fall = within * versine;
    let across = sqrt(max(fall * (2.0 - fall), vec4f(0.0)));
    return Four(across * cosine, across * sine, -fall);
}

// The lamp as a cap that hides what is behind it, at no distance.
fn cap_of_lamp(view: LampView) -> Cap {
    if (view.sine <= SMALLEST_SINE) {
        return Cap(vec3f(0.0), NOTHING, 0.0, 0.0);
    }
    let cosine = sqrt((1.0 - view.sine) * (1.0 + view.sine));
    return Cap(view.bundle.axis / view.sine, cosine / view.sine, 0.0, view.sine / (1.0 + cosine));
}
