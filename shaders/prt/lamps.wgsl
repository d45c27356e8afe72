// Light that arrives from local lights at a receiver: twin of `prt/kernel/lamps.rs`, without points to interpolate between.
#import "prt/dot.wgsl"
#import "shared/light_cap.wgsl"

// Two rows for each local light: centre and radius among the receivers, whose axes are those of the vectors; radiance.
@group(1) @binding(3) var<storage, read> lamps: array<vec4f>;

// Makes the receiver's light that from infinitely far and from all local lights.
fn gather_lamps(position: vec3f) {
    receiver_light = frame.light;
    for (var number = 0u; number < LAMPS; number++) {
        let sphere = lamps[2u * number];
        let radiance = lamps[2u * number + 1u].xyz;
        let offset = sphere.xyz - position;
        let squared = dot(offset, offset);
        let cap = light_cap(offset, squared, squared <= sphere.w * sphere.w, sphere.w);
        for (var part = 0u; part < PARTS; part++) {
            let four = sh_part(cap, part);
            receiver_light[part] += radiance.x * four;
            receiver_light[16u + part] += radiance.y * four;
            receiver_light[32u + part] += radiance.z * four;
        }
    }
}
