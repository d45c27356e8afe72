// Reflection of receivers beside their diffuse part: twin of `prt/shade/gloss.rs`.
#import "common/eye_lobes.wgsl"
#import "prt/dot.wgsl"
#import "prt/lobe.wgsl"

fn in_baked_space(direction: vec3f) -> vec3f {
    let turn = frame.baked_from_world;
    return vec3f(dot(turn[0].xyz, direction), dot(turn[1].xyz, direction), dot(turn[2].xyz, direction));
}

// White light that a lobe gets between up to three matrices, before each of which its frame stands: normal and tangent.
fn lobe_light(between: Between, lobe: Lobe) -> vec3f {
    let axis = in_baked_space(lobe.axis);
    var white = vec3f(0.0);
    for (var corner = 0u; corner < 3u; corner++) {
        let weight = between.weights[corner];
        if (weight == 0.0) {
            continue;
        }
        let first = between.matrices[corner];
        let normal = rows[first].xyz;
        let tangent = rows[first + 1u].xyz;
        let own = vec3f(dot(axis, tangent), dot(axis, cross(normal, tangent)), dot(axis, normal));
        white += weight * lobe_product(first + 2u, between.fit, own, lobe.exponent);
    }
    return white;
}

// Radiance toward the eye beside the diffuse part.
fn gloss_of_receiver(number: u32, receiver: Receiver, between: Between) -> vec3f {
    var radiance = vec3f(0.0);
    for (var term = 0u; term < between.term_count; term++) {
        let row = between.terms + 2u * term;
        let kind = rows[row + 1u];
        let words = vec4u(bitcast<vec3u>(kind.xyz), u32(kind.w));
        let lobe = eye_lobe(number, receiver, frame.eye.xyz, bitcast<vec4u>(rows[row]), words);
        if (any(lobe.scale != vec3f(0.0))) {
            radiance += lobe.scale * lobe_light(between, lobe);
        }
    }
    return radiance;
}
