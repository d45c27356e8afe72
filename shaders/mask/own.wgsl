// Directions that an object's own mesh hides: twin of `mask/kernel/own.rs`.
#import "common/constants.wgsl"
#import "common/receivers.wgsl"
#import "mask/four.wgsl"
#import "mask/frame.wgsl"

// Where a receiver lies between vertices of its mesh.
struct OwnPoint {
    words: vec3u,
    weights: vec3f,
    is_known: bool,
    // Nothing is in the way of any of its vertices, as far as is known.
    is_all_open: bool,
}

fn own_point(number: u32) -> OwnPoint {
    let first = 8u * number;
    let words = vec3u(cells[first], cells[first + 1u], cells[first + 2u]);
    let weights = vec3u(cells[first + 3u], cells[first + 4u], cells[first + 5u]);
    return OwnPoint(words, bitcast<vec3f>(weights), cells[first + 6u] != 0u, cells[first + 7u] != 0u);
}

// How much of each of four directions is open; 1 where nothing is known.
fn own_open(point: OwnPoint, object: u32, four: Four) -> vec4f {
    if (point.is_all_open) {
        return vec4f(1.0);
    }
    let turned = placements[object].direction;
    let cell = cells_of(
        fma(four.x, vec4f(turned[0].x), fma(four.y, vec4f(turned[1].x), four.z * turned[2].x)),
        fma(four.x, vec4f(turned[0].y), fma(four.y, vec4f(turned[1].y), four.z * turned[2].y)),
        fma(four.x, vec4f(turned[0].z), fma(four.y, vec4f(turned[1].z), four.z * turned[2].z)),
        f32(frame.own_side),
    );
    return point.weights.x * bits(point.words.x, cell) + point.weights.y * bits(point.words.y, cell)
        + point.weights.z * bits(point.words.z, cell);
}

fn bits(first: u32, cell: vec4u) -> vec4f {
    return vec4f(vec4u(bit(first, cell.x), bit(first, cell.y), bit(first, cell.z), bit(first, cell.w)));
}

fn bit(first: u32, cell: u32) -> u32 {
    return (cells[first + cell / 32u] >> (cell % 32u)) & 1u;
}

// The cells in which four directions lie.
fn cells_of(x: vec4f, y: vec4f, z: vec4f, side: f32) -> vec4u {
    let place = unfolded(x, y, z);
    let half = vec4f(0.5 * side);
    let column = clamp(floor(fma(place.u, half, half)), vec4f(0.0), vec4f(side - 1.0));
    let line = clamp(floor(fma(place.v, half, half)), vec4f(0.0), vec4f(side - 1.0));
    return vec4u(fma(line, vec4f(side), column));
}

struct Unfolded {
    u: vec4f,
    v: vec4f,
}

// Places on the square that the octahedron unfolds to, from -1 to 1.
fn unfolded(x: vec4f, y: vec4f, z: vec4f) -> Unfolded {
    let size = max(abs(x) + abs(y) + abs(z), vec4f(SMALLEST));
    let inner_x = abs(x / size);
    let inner_z = abs(z / size);
    return Unfolded(
        select(1.0 - inner_z, inner_x, y >= vec4f(0.0)) * select(vec4f(1.0), vec4f(-1.0), x < vec4f(0.0)),
        select(1.0 - inner_x, inner_z, y >= vec4f(0.0)) * select(vec4f(1.0), vec4f(-1.0), z < vec4f(0.0)),
    );
}
