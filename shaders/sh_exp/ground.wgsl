// Radiance of objects without spheres, as an affine function of the receiver's place: twin of `sh_exp/kernel/ground.rs`.
#import "sh_exp/frame.wgsl"

// A row about where the surroundings of an object are known, w being 1; three of gradients; coefficients at the middle and
// their changes along the gradients, each channel by channel; the same once more of a black ground.
const GROUND_PLACES = 4u;

// Whether an object's surroundings are known.
fn has_ground(object: u32) -> bool {
    return ground_rows() > 0u && radiating[frame.ground + object * ground_rows()].w > 0.0;
}

// Radiance of a white receiver by `weights`, its visible reflectance; if not `is_seen`, that of a black ground.
fn ground_radiance(object: u32, position: vec3f, weights: Sh, is_seen: bool) -> vec3f {
    let row = frame.ground + object * ground_rows();
    let offset = position - radiating[row].xyz;
    let along = vec4f(
        1.0,
        dot(radiating[row + 1u].xyz, offset),
        dot(radiating[row + 2u].xyz, offset),
        dot(radiating[row + 3u].xyz, offset),
    );
    let fields = row + 4u + select(GROUND_PLACES * 3u * SH_PARTS, 0u, is_seen);
    var radiance = vec3f(0.0);
    for (var place = 0u; place < GROUND_PLACES; place++) {
        for (var channel = 0u; channel < 3u; channel++) {
            let first = fields + (place * 3u + channel) * SH_PARTS;
            for (var part = 0u; part < SH_PARTS; part++) {
                radiance[channel] += along[place] * dot(radiating[first + part], sh_part(weights, part));
            }
        }
    }
    return radiance;
}

// ρ_n * V.
fn visible_reflectance(normal: vec3f, visibility: Sh) -> Sh {
    return sh_product(reflectance(normal), visibility);
}

// Clamped cosine about a normal over π: ρ_n.
fn reflectance(normal: vec3f) -> Sh {
    return sh_times_bands(sh_basis(normal), sh_bands(frame.low_reflectance, frame.high_reflectance));
}
