// Lights of which a receiver sees a cap: twin of `shared/placed_lamps.rs`.
#import "common/cap.wgsl"
#import "common/constants.wgsl"

// A lamp as a receiver sees it.
struct SeenLamp {
    // Unit direction to its middle.
    axis: vec3f,
    // Sine of its angular radius.
    sine: f32,
    // Distance of its centre; what lies farther hides nothing of it.
    distance: f32,
}

// The lamp at `place`: centre and radius if it `is_near`, else direction and sine. Within a light it is all around: the hemisphere
// above stands for it.
fn seen_lamp(place: vec4f, is_near: bool, position: vec3f, normal: vec3f) -> SeenLamp {
    if (!is_near) {
        return SeenLamp(place.xyz, place.w, ENDLESS);
    }
    let offset = place.xyz - position;
    let distance = length(offset);
    if (distance > place.w) {
        return SeenLamp(offset / distance, place.w / distance, distance);
    }
    return SeenLamp(normal, 1.0, place.w);
}

// Irradiance of a lamp of radiance 1 that nothing hides.
fn lamp_form(place: vec4f, is_near: bool, position: vec3f, normal: vec3f) -> f32 {
    if (!is_near) {
        return cap_irradiance(dot(place.xyz, normal), place.w);
    }
    return sphere_irradiance(place.xyz - position, place.w, normal);
}
