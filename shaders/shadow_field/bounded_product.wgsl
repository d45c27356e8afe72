// The triple product of visibility and transfer, held to what such a function can be: twin of
// `shadow_field/kernel/bounded_product.rs`.
#import "common/constants.wgsl"

// The shape ρ of transfer, and how far from a part of it transfer may be.
struct Bound {
    shape: Sh,
    // 1 over the first coefficient, or 0.
    inverse_first: f32,
    room: f32,
    bend: f32,
}

fn inverse_of_first(shape: Sh) -> f32 {
    return select(0.0, 1.0 / shape.h0, abs(shape.h0) > SMALLEST);
}

// Under the clamped cosine over π.
fn diffuse_bound(cosine: Sh) -> Bound {
    return Bound(cosine, inverse_of_first(cosine), 1.0 / PI, 4.0 / 3.0);
}

// Under a lobe, at most 1.
fn lobe_bound(shape: Sh) -> Bound {
    return Bound(shape, inverse_of_first(shape), abs(shape.h0) * SQRT_4PI, 1.0);
}

// Transfer times visibility; never more of it than before.
fn bounded_product(bound: Bound, transfer: Sh, visible: Sh) -> Sh {
    let product = sh_product(visible, transfer);
    let part = product.h0 * bound.inverse_first;
    let held = min(max(part, 0.0), clamp(transfer.h0 * bound.inverse_first, 0.0, 1.0));
    let least = min(held, 1.0 - held);
    let room = bound.room * least * (1.0 - bound.bend * least);
    let away = sh_scaled_plus(bound.shape, -held, product);
    let energy = sh_isolated_energy(away);
    let is_far = energy > room;
    if (!is_far && held == part) {
        return product;
    }
    let shrink = select(1.0, sqrt(room / energy), is_far);
    var limited = sh_scaled_plus(away, shrink, sh_scaled(bound.shape, held));
    limited.h0 = held * bound.shape.h0;
    return limited;
}
