// The lobes that receivers show to the eye: twin of `halfshade_scene::EyeLobes`.
#import "common/receivers.wgsl"
#import "common/reflectance.wgsl"

// The tangent that anisotropic lobes are about, horizontal in the space of the object, for a normal there.
fn horizontal(normal: vec3f) -> vec3f {
    let across = vec3f(normal.z, 0.0, -normal.x);
    let size = length(across);
    return select(vec3f(1.0, 0.0, 0.0), across / size, size > SMALLEST);
}

// The lobe of a term, as it stands in two rows of a table, with the receiver's own gloss; black if the eye doesn't see it.
fn eye_lobe(number: u32, receiver: Receiver, eye: vec3f, strength: vec4u, kind: vec4u) -> Lobe {
    let offset = eye - receiver.position;
    // The square of what is far away would overflow.
    let reach = max(max(abs(offset.x), abs(offset.y)), abs(offset.z));
    if (!(reach > 0.0)) {
        return Lobe(receiver.normal, 0.0, vec3f(0.0), false);
    }
    let own = bitcast<vec4f>(strength) * gloss_of(number);
    let term = Term(own.xyz, own.w, bitcast<vec3f>(kind.xyz), kind.w);
    let tangent = out_of_object(receiver.object, horizontal(places[number].normal));
    return lobe_toward(term, receiver.normal, tangent, normalize(offset / reach));
}
