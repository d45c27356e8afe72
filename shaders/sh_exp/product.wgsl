// Blockers multiplied one after another [Guerrero2007, eq. 4.6]: twin of `sh_exp/kernel/product.rs`.
#import "sh_exp/blocker.wgsl"
#import "sh_exp/exponential.wgsl"

fn product_of_blockers(position: vec3f, normal: vec3f, cut: Cut) -> Sh {
    // V - 1.
    var h = Sh();
    for (var i = cut.first; i < cut.end; i++) {
        let seen = seen_from(blockers[i], position, normal);
        if (seen.sin_squared > 0.0 && hides(blockers[i], cut)) {
            // Factors are those of logarithms.
            let one = vec4f(1.0);
            let minus_cap = sh_add_lobe(seen.direction, zonal(seen.sin_squared, 0u, one, one), Sh());
            // V*(1 - C) - 1 = (V - 1) - C + (V - 1)*(-C)
            h = limit_difference(sh_plus(sh_plus(h, minus_cap), sh_product(h, minus_cap)));
        }
    }
    h.h0 += SQRT_4PI;
    return h;
}
