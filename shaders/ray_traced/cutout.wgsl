// Holes that masks cut into triangles: twin of `halfshade_scene::Mesh::is_cut_out`, and of `halfshade_scene::Texture::at`.
#import "ray_traced/frame.wgsl"

// Whether there are any.
override HAS_CUTOUTS: bool = false;

// Values beyond a texture's edge: the texture again, or mirrored, or else its edge.
const REPEAT = 0u;
const MIRROR = 1u;

struct Mask {
    cutoff: f32,
    // Row at which the alpha of its texels begins, four in a row; 0 without a texture.
    texels: u32,
    width: u32,
    height: u32,
    wrap: vec2u,
    is_nearest: bool,
}

fn mask_at(row: u32) -> Mask {
    let first = rows[row];
    let second = rows[row + 1u];
    return Mask(bitcast<f32>(first.x), first.y, first.z, first.w, second.xy, second.z == 1u);
}

// The remainder of a division toward minus infinity.
fn remainder(index: i32, count: i32) -> i32 {
    return (index % count + count) % count;
}

// The texel, of `size` in a row, that stands at a whole place.
fn wrapped(place: f32, size: u32, wrap: u32) -> u32 {
    let index = i32(clamp(place, -1e9, 1e9));
    let count = i32(size);
    if (wrap == REPEAT) {
        return u32(remainder(index, count));
    }
    if (wrap == MIRROR) {
        let inside = remainder(index, 2 * count);
        return u32(min(inside, 2 * count - 1 - inside));
    }
    return u32(clamp(index, 0, count - 1));
}

// Alpha of the texel at a whole place.
fn texel_alpha(mask: Mask, place: vec2f) -> f32 {
    let number = wrapped(place.y, mask.height, mask.wrap.y) * mask.width + wrapped(place.x, mask.width, mask.wrap.x);
    return bitcast<f32>(rows[frame.tables + mask.texels + number / 4u][number % 4u]);
}

fn texture_alpha(mask: Mask, coordinate: vec2f) -> f32 {
    let place = coordinate * vec2f(f32(mask.width), f32(mask.height));
    if (mask.is_nearest) {
        return texel_alpha(mask, floor(place));
    }
    let first = floor(place - 0.5);
    let part = place - 0.5 - first;
    let right = vec2f(1.0, 0.0);
    let below = first + vec2f(0.0, 1.0);
    let above_both = mix(texel_alpha(mask, first), texel_alpha(mask, first + right), part.x);
    let below_both = mix(texel_alpha(mask, below), texel_alpha(mask, below + right), part.x);
    return mix(above_both, below_both, part.y);
}

// Whether the point of a triangle that has these weights of its corners lies in a hole. `holes` is the row, of those that
// stay, at which there begin: alpha of the corners, the row of the mask, texture coordinates of the corners.
fn is_cut_out(holes: u32, weights: vec3f) -> bool {
    let row = frame.tables + holes;
    let corners = rows[row];
    let alpha = bitcast<vec3f>(corners.xyz);
    let mask = mask_at(frame.tables + corners.w);
    // Where all corners are opaque so is their mean, to the last bit.
    let of_corners = alpha.x + weights.y * (alpha.y - alpha.x) + weights.z * (alpha.z - alpha.x);
    if (mask.texels == 0u) {
        return of_corners < mask.cutoff;
    }
    let first = bitcast<vec4f>(rows[row + 1u]);
    let last = bitcast<vec2f>(rows[row + 2u].xy);
    let coordinate = weights.x * first.xy + weights.y * first.zw + weights.z * last;
    return of_corners * texture_alpha(mask, coordinate) < mask.cutoff;
}
