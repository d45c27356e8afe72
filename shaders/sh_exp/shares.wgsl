// Visibility as one less the share that each sphere alone covers: twin of `sh_exp/kernel/shares.rs` and of
// `halfshade_sh::kernel::ExposedShares`.
#import "sh_exp/blocker.wgsl"
#import "sh_exp/exponential.wgsl"

// Points per sphere. Each has a row of `tables`: its share of the versine, cosine and sine of its turn, and 1; zeros fill up
// the last eight.
override POINTS: u32 = 8u;

// A cap of directions in the space in which points are fixed.
struct Cap {
    direction: vec3f,
    // 1 - cos of its angular radius; 0 if there is none.
    versine: f32,
}

// Four points of a cap.
struct Points {
    x: vec4f,
    y: vec4f,
    z: vec4f,
}

fn cap_of(seen: Seen) -> Cap {
    let rows = frame.share_space;
    let v = seen.direction;
    return Cap(
        vec3f(dot(rows[0].xyz, v), dot(rows[1].xyz, v), dot(rows[2].xyz, v)),
        versine_of(seen.sin_squared),
    );
}

// The points of four rows from `first` on.
fn points_of(cap: Cap, first: u32) -> Points {
    let d = cap.direction;
    // Two unit vectors at right angles to the direction and each other, continuous but for -Y.
    let a = -1.0 / max(1.0 + d.y, 1e-4);
    let b = d.x * d.z * a;
    let u = vec3f(d.x * d.x * a + 1.0, -d.x, b);
    let v = vec3f(b, -d.z, d.z * d.z * a + 1.0);
    let fan = transpose(mat4x4f(tables[first], tables[first + 1u], tables[first + 2u], tables[first + 3u]));
    // 1 - z rather than z, so that small caps keep their points apart.
    let versine = cap.versine * fan[0];
    let radius = sqrt(versine * (2.0 - versine));
    let across = radius * fan[1];
    let along = radius * fan[2];
    return Points(
        u.x * across + v.x * along + (d.x - versine * d.x),
        u.y * across + v.y * along + (d.y - versine * d.y),
        u.z * across + v.z * along + (d.z - versine * d.z),
    );
}

// By how much a cap counts at points of another: it fades over what a point stands for.
fn memberships(points: Points, cap: Cap, inverse: f32) -> vec4f {
    let x = cap.direction.x - points.x;
    let y = cap.direction.y - points.y;
    let z = cap.direction.z - points.z;
    // Twice the versine is the squared distance.
    let slope = inverse * 0.5 * f32(POINTS);
    let inside = f32(POINTS) + 0.5 - (x * x + y * y + z * z) * slope;
    return clamp(inside, vec4f(0.0), vec4f(1.0)) * (cap.versine * inverse);
}

// The share of a cap that is its own among all of a cut: the mean of 1 over the number of caps there.
fn exposed_share(place: u32, cap: Cap, position: vec3f, normal: vec3f, cut: Cut) -> f32 {
    let of_point = f32(POINTS) / max(cap.versine, 1e-30);
    var sum = 0.0;
    for (var point = 0u; point < POINTS; point += 8u) {
        let first = frame.fan + point;
        let low = points_of(cap, first);
        let high = points_of(cap, first + 4u);
        var low_count = vec4f(1.0);
        var high_count = vec4f(1.0);
        for (var i = cut.first; i < cut.end; i++) {
            let seen = seen_from(blockers[i], position, normal);
            if (i != place && seen.sin_squared > 0.0 && hides(blockers[i], cut)) {
                let other = cap_of(seen);
                // The cap that a point stands for, or the other cap if that is larger.
                let inverse = min(1.0 / max(other.versine, 1e-30), of_point);
                low_count += memberships(low, other, inverse);
                high_count += memberships(high, other, inverse);
            }
        }
        let used = vec4f(tables[first].w, tables[first + 1u].w, tables[first + 2u].w, tables[first + 3u].w);
        let more = vec4f(tables[first + 4u].w, tables[first + 5u].w, tables[first + 6u].w, tables[first + 7u].w);
        sum += dot(used, 1.0 / low_count) + dot(more, 1.0 / high_count);
    }
    return sum / f32(POINTS);
}

fn shares_of_blockers(position: vec3f, normal: vec3f, cut: Cut) -> Sh {
    // V - 1.
    var h = Sh();
    for (var i = cut.first; i < cut.end; i++) {
        let seen = seen_from(blockers[i], position, normal);
        if (seen.sin_squared > 0.0 && hides(blockers[i], cut)) {
            let share = vec4f(exposed_share(i, cap_of(seen), position, normal, cut));
            h = sh_add_lobe(seen.direction, zonal(seen.sin_squared, 0u, share, share), h);
        }
    }
    h = limit_difference(h);
    h.h0 += SQRT_4PI;
    return h;
}
