// Light times transfer: twin of `shadow_field/kernel/light_product.rs`.
#import "shadow_field/frame.wgsl"

// Distant light times transfer, by colour.
fn distant_light(transfer: Sh) -> vec3f {
    var radiance = vec3f(0.0);
    for (var part = 0u; part < SH_PARTS; part++) {
        let first = 3u * part;
        radiance += vec3f(
            dot(frame.light[first], sh_part(transfer, part)),
            dot(frame.light[first + 1u], sh_part(transfer, part)),
            dot(frame.light[first + 2u], sh_part(transfer, part)),
        );
    }
    return radiance;
}
