// Directions of a map drawn by light times cosine: twin of `ray_traced/prepare/light_tree.rs`.
#import "common/octahedral.wgsl"
#import "ray_traced/light.wgsl"

// A direction of a map, in the space of the environment.
struct MapSample {
    direction: vec3f,
    texel: u32,
    // Steradians per unit of probability; 0 where nothing shines.
    inverse_density: f32,
}

// Place within a half, which half, and with which probability.
struct Half {
    place: f32,
    half: u32,
    share: f32,
}

const BELOW_ONE = 0.99999994f;

fn number_at(first: u32, place: u32) -> f32 {
    return bitcast<f32>(rows[first + place / 4u][place % 4u]);
}

// Light times cosine of a cell, at least.
fn cell_weight(along: f32, slack: f32) -> f32 {
    if (along >= slack) {
        return along;
    }
    let above = max(along + slack, 0.0);
    return select(0.0, 0.25 * above * (above / slack), above > 0.0);
}

fn halved(number: f32, first: f32, second: f32) -> Half {
    let share = first / (first + second);
    if (number < share) {
        return Half(clamp(number / share, 0.0, BELOW_ONE), 0u, share);
    }
    return Half(clamp((number - share) / (1.0 - share), 0.0, BELOW_ONE), 1u, 1.0 - share);
}

// Weight of a cell of a level; of a texel behind the last level.
fn weight_of(normal: vec3f, level: u32, place: vec2u) -> f32 {
    if (level == frame.level_count) {
        if (place.x >= frame.map_width || place.y >= frame.map_height) {
            return 0.0;
        }
        let texel = bitcast<vec4f>(rows[frame.texels + place.y * frame.map_width + place.x]).xyz;
        return sum_of(texel) * number_at(frame.solid_angles, place.y);
    }
    let about_level = rows[frame.levels + level];
    if (place.x >= about_level.x || place.y >= about_level.y) {
        return 0.0;
    }
    let cell = bitcast<vec4f>(rows[about_level.z + place.y * about_level.x + place.x]);
    return cell_weight(dot(normal, cell.xyz), cell.w * bitcast<f32>(about_level.w));
}

// The first of the sums from `first` on that is larger than a number, or the last.
fn first_above(first: u32, count: u32, number: f32) -> u32 {
    var low = 0u;
    var high = count;
    while (low < high) {
        let middle = (low + high) / 2u;
        if (number_at(frame.sums, first + middle) <= number) {
            low = middle + 1u;
        } else {
            high = middle;
        }
    }
    return min(low, count - 1u);
}

// The node of the table that is nearest to a normal.
fn nearest_node(normal: vec3f) -> u32 {
    let found = octahedral_lookup(normal, frame.normal_cells);
    var best = found.nodes.x;
    var most = found.weights.x;
    if (found.weights.y > most) {
        best = found.nodes.y;
        most = found.weights.y;
    }
    return select(best, found.nodes.z, found.weights.z > most);
}

// A direction within a texel.
fn direction_within(place: vec2u, u: f32, v: f32) -> vec3f {
    let height = f32(frame.map_height);
    let first = cos(PI * f32(place.y) / height);
    let second = cos(PI * (f32(place.y) + 1.0) / height);
    let up = first + v * (second - first);
    let angle = ((f32(place.x) + u) / f32(frame.map_width) - 0.5) * TAU;
    let across = sqrt(max((1.0 - up) * (1.0 + up), 0.0));
    return vec3f(across * sin(angle), up, -across * cos(angle));
}

// A direction for a receiver with a unit normal in the space of the environment.
fn map_sample(normal: vec3f, point: vec2f) -> MapSample {
    let nothing = MapSample(normal, 0u, 0.0);
    let count = frame.largest_columns * frame.largest_rows;
    let first = nearest_node(normal) * count;
    let total = number_at(frame.sums, first + count - 1u);
    if (!(total > 0.0 && total < 3.4e38)) {
        return nothing;
    }
    let number = point.x * total;
    let part_of_all = first_above(first, count, number);
    var before = 0.0;
    if (part_of_all > 0u) {
        before = number_at(frame.sums, first + part_of_all - 1u);
    }
    let own = number_at(frame.sums, first + part_of_all) - before;
    let cell = rows[frame.order + part_of_all / 4u][part_of_all % 4u];
    var u = clamp((number - before) / own, 0.0, BELOW_ONE);
    var v = point.y;
    var chance = own / total;
    var place = vec2u(cell % frame.largest_columns, cell / frame.largest_columns);
    for (var level = 1u; level <= frame.level_count; level++) {
        let corner = 2u * place;
        let upper = vec2f(weight_of(normal, level, corner), weight_of(normal, level, corner + vec2u(1u, 0u)));
        let lower =
            vec2f(weight_of(normal, level, corner + vec2u(0u, 1u)), weight_of(normal, level, corner + vec2u(1u, 1u)));
        let above = upper.x + upper.y;
        let below = lower.x + lower.y;
        if (!(above + below > 0.0)) {
            return nothing;
        }
        let row = halved(v, above, below);
        let weights = select(upper, lower, row.half == 1u);
        let column = halved(u, weights.x, weights.y);
        v = row.place;
        u = column.place;
        chance *= row.share * column.share;
        place = corner + vec2u(column.half, row.half);
    }
    if (!(chance > 0.0)) {
        return nothing;
    }
    let texel = place.y * frame.map_width + place.x;
    return MapSample(direction_within(place, u, v), texel, number_at(frame.solid_angles, place.y) / chance);
}
