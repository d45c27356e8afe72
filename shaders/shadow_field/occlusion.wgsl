// Visibility past a receiver's own object and past each other one: twin of `shadow_field/shade/sh/occlusion.rs`.
#import "common/receivers.wgsl"
#import "shadow_field/reconstruct.wgsl"
#import "shadow_field/rotate.wgsl"
#import "shadow_field/shell_coordinates.wgsl"

// Occlusion of a receiver by its own object, in that object's space.
struct Own {
    blocked: Sh,
    is_known: bool,
}

// Interpolated between the vertices that the receiver lies between.
fn own_of(receiver: Receiver) -> Own {
    let first = receiver_row(receiver.group);
    let vertices = tables[first];
    let weights = bitcast<vec3f>(tables[first + 1u].xyz);
    var sum = ShParts();
    for (var corner = 0u; corner < 3u; corner++) {
        let weight = weights[corner];
        if (weight != 0.0) {
            for (var part = 0u; part < SH_PARTS; part++) {
                sum[part] += bitcast<vec4f>(tables[vertices[corner] + part]) * weight;
            }
        }
    }
    return Own(sh_of_parts(sum), vertices.w != 0u);
}

// Occlusion of a place by another object, in that object's space.
fn blocked_at(object: FieldObject, position: vec3f) -> Sh {
    return blocked_by(object.field, shell_coordinates(object_axes(object, position), object.inverse_radius));
}
