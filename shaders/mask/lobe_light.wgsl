// Distant light as lobes see it: twin of `mask/bake/lobe_light.rs`.
#import "common/constants.wgsl"
#import "common/octahedral.wgsl"
#import "mask/four.wgsl"
#import "mask/frame.wgsl"
#import "mask/own.wgsl"

// Mean radiance over a lobe about unit `axis`.
fn mean_over_lobe(axis: vec3f, exponent: f32) -> vec3f {
    if (frame.level_count == 0u) {
        return frame.constant.xyz / PI;
    }
    let last = f32(frame.level_count - 1u);
    let place = min(log2(exponent + 1.0), last);
    let first = min(floor(place), last - 1.0);
    let row = frame.levels + u32(first);
    return mix(mean_of_level(tables[row], axis), mean_of_level(tables[row + 1u], axis), place - first);
}

// `level` is the row of the first node and the cells of the grid from its centre to its side.
fn mean_of_level(level: vec4f, axis: vec3f) -> vec3f {
    let found = octahedral_lookup(axis, level.y);
    let first = frame.levels + u32(level.x);
    return tables[first + found.nodes.x].xyz * found.weights.x + tables[first + found.nodes.y].xyz * found.weights.y
        + tables[first + found.nodes.z].xyz * found.weights.z;
}

// The level for so many directions in a lobe; a map has it.
fn level_of(exponent: f32, count: f32) -> vec4f {
    let level = min(round(log2((exponent + 1.0) * count)), f32(frame.level_count - 1u));
    return tables[frame.levels + u32(level)];
}

// The nodes next to four directions.
fn next_to(level: vec4f, four: Four) -> vec4u {
    let place = unfolded(four.x, four.y, four.z);
    let column = round(fma(place.u, vec4f(level.y), vec4f(level.y)));
    let line = round(fma(place.v, vec4f(level.y), vec4f(level.y)));
    return vec4u(fma(line, vec4f(2.0 * level.y + 1.0), column)) + vec4u(frame.levels + u32(level.x));
}
