// BRDFs as SH vectors: twin of `shadow_field/shade/sh/gloss.rs`.
#import "common/receivers.wgsl"
#import "common/reflectance.wgsl"
#import "shadow_field/cosine_power.wgsl"
#import "shadow_field/frame.wgsl"

// A term of the reflectance of a receiver's object, times what varies over its surface.
fn term_of(receiver: Receiver, number: u32) -> Term {
    let row = object_at(receiver.object).terms + 2u * number;
    let strength = bitcast<vec4f>(tables[row]);
    let kind = tables[row + 1u];
    let factor = bitcast<vec4f>(tables[receiver_row(receiver.group) + 2u]);
    return Term(strength.xyz * factor.xyz, strength.w * factor.w, bitcast<vec3f>(kind.xyz), kind.w);
}

// The tangent that anisotropic lobes are about: horizontal in the space of the object.
fn tangent_of(number: u32, object: u32) -> vec3f {
    let normal = places[number].normal;
    let horizontal = vec3f(normal.z, 0.0, -normal.x);
    let size = length(horizontal);
    let tangent = select(vec3f(1.0, 0.0, 0.0), horizontal / size, size > SMALLEST);
    let turned = placements[object].direction;
    return vec3f(dot(turned[0].xyz, tangent), dot(turned[1].xyz, tangent), dot(turned[2].xyz, tangent));
}

// A lobe of a receiver toward the eye; black if it has none of that number.
fn lobe_of(number: u32, receiver: Receiver, lobe: u32) -> Lobe {
    let offset = frame.eye.xyz - receiver.position;
    let distance = length(offset);
    if (lobe >= object_at(receiver.object).term_count || !(distance > 0.0)) {
        return Lobe(receiver.normal, 0.0, vec3f(0.0), false);
    }
    let tangent = tangent_of(number, receiver.object);
    return lobe_toward(term_of(receiver, lobe), receiver.normal, tangent, offset / distance);
}

// Its power times the cosine, or the horizon.
fn shape_of(lobe: Lobe, normal: vec3f, cosine: Sh) -> Sh {
    var above = cosine_power(normal, 0.0);
    if (lobe.times_cosine) {
        above = sh_scaled(cosine, PI);
    }
    return sh_product(cosine_power(lobe.axis, lobe.exponent), above);
}
