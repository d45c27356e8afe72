// BRDFs as SH vectors: twin of `shadow_field/shade/sh/gloss.rs`.
#import "common/eye_lobes.wgsl"
#import "shared/cosine_power.wgsl"
#import "shadow_field/frame.wgsl"

// A lobe of a receiver toward the eye; black if it has none of that number.
fn lobe_of(number: u32, receiver: Receiver, lobe: u32) -> Lobe {
    let object = object_at(receiver.object);
    if (lobe >= object.term_count) {
        return Lobe(receiver.normal, 0.0, vec3f(0.0), false);
    }
    let row = object.terms + 2u * lobe;
    return eye_lobe(number, receiver, frame.eye.xyz, tables[row], tables[row + 1u]);
}

// Its power times the cosine, or the horizon.
fn shape_of(lobe: Lobe, normal: vec3f, cosine: Sh) -> Sh {
    var above = cosine_power(normal, 0.0);
    if (lobe.times_cosine) {
        above = sh_scaled(cosine, PI);
    }
    return sh_product(cosine_power(lobe.axis, lobe.exponent), above);
}
