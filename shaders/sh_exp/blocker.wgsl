// The view of a receiver on a sphere, and the zonal vector of what it blocks: twin of `sh_exp/kernel/blocker.rs` and of
// `halfshade_sh::blocker_table::BlockerTable::lookup`.
#import "shared/tangent_plane.wgsl"
#import "sh_exp/frame.wgsl"

// Intervals of the table by angular radius.
override INTERVALS: f32 = 2048.0;

struct Seen {
    direction: vec3f,
    // Squared sine of its angular radius; 0 where the sphere has no influence.
    sin_squared: f32,
}

fn seen_from(blocker: Blocker, position: vec3f, normal: vec3f) -> Seen {
    let moved = adjusted(blocker.center - position, blocker.radius, normal);
    let per_distance_squared = 1.0 / max(dot(moved.offset, moved.offset), SMALLEST);
    let sin_squared = min(moved.reach * moved.reach * per_distance_squared, 1.0);
    return Seen(moved.offset * sqrt(per_distance_squared), sin_squared);
}

// 1 less the cosine of an angular radius, from its squared sine: without cancellation.
fn versine_of(sin_squared: f32) -> f32 {
    return sin_squared / (1.0 + sqrt(1.0 - sin_squared));
}

// Zonal vector of a blocker's logarithm by the table that begins at a row, times its factors and `sqrt(4π/(2l+1))` of the
// rotation.
fn zonal_log(blocker: Blocker, sin_squared: f32, table: u32) -> ShBands {
    return zonal(sin_squared, table, blocker.low_factors, blocker.high_factors);
}

// Zonal vector by the table that begins at a row, times factors by band and `sqrt(4π/(2l+1))` of the rotation.
fn zonal(sin_squared: f32, table: u32, low_factors: vec4f, high_factors: vec4f) -> ShBands {
    let at = INTERVALS - sqrt(1.0 - sin_squared) * INTERVALS;
    let interval = min(floor(at), INTERVALS - 1.0);
    let t = at - interval;
    let row = table + 2u * u32(interval);
    let low = (tables[row] + tables[row + 1u] * t) * sin_squared * low_factors;
    var high = vec4f(0.0);
    if (SH_BANDS > 4u) {
        let second = row + 2u * u32(INTERVALS);
        high = (tables[second] + tables[second + 1u] * t) * sin_squared * high_factors;
    }
    return sh_bands(low, high);
}
