// Coefficients of a field at a place [Tamura2006, 5.1]: twin of `shadow_field/kernel/reconstruct.rs` and of
// `bake::field::Field::add_at`.
#import "shadow_field/shell_grid.wgsl"

const U8 = 0u;
const F16 = 1u;
const F32 = 2u;

override STORAGE: u32 = U8;

alias ShParts = array<vec4f, SH_PARTS>;

// Rows of one sample.
fn sample_rows() -> u32 {
    if (STORAGE == U8) {
        return (SH_PARTS + 3u) / 4u;
    }
    return select(SH_PARTS, (SH_PARTS + 1u) / 2u, STORAGE == F16);
}

// Four values of a sample, as they are stored.
fn stored(first: u32, part: u32) -> vec4f {
    if (STORAGE == U8) {
        return vec4f(unpack4xU8(samples[first + part / 4u][part % 4u]));
    }
    if (STORAGE == F16) {
        let four = samples[first + part / 2u];
        let two = select(four.xy, four.zw, part % 2u == 1u);
        return vec4f(unpack2x16float(two.x), unpack2x16float(two.y));
    }
    return bitcast<vec4f>(samples[first + part]);
}

// Adds `share` of the weighted sum of four samples of a shell.
fn add_samples(shell: Shell, points: Corners, share: f32, sum: ShParts) -> ShParts {
    let first = vec4u(shell.samples) + points.places * sample_rows();
    var total = sum;
    for (var part = 0u; part < SH_PARTS; part++) {
        var found = stored(first.x, part) * points.weights.x + stored(first.y, part) * points.weights.y
            + stored(first.z, part) * points.weights.z + stored(first.w, part) * points.weights.w;
        if (STORAGE == U8) {
            let scales = shell.scales + 2u * part;
            found = found * bitcast<vec4f>(tables[scales + 1u]) + bitcast<vec4f>(tables[scales]);
        }
        total[part] += found * share;
    }
    return total;
}

// Occlusion by an object at a place in the coordinates of its shells, in the object's space.
fn blocked_by(row: u32, place: vec3f) -> Sh {
    let field = field_at(row);
    let pair = between_shells(field, place.x);
    var sum = ShParts();
    for (var inward = 0u; inward < 2u; inward++) {
        let share = select(pair.within, pair.without, inward == 0u);
        if (share > 0.0) {
            let shell = shell_at(field, pair.outer - inward);
            sum = add_samples(shell, corners(shell.resolution, place.y, place.z), share, sum);
        }
    }
    return sh_of_parts(sum);
}
