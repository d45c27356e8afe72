// The octahedral grid over directions, with linear interpolation between three nodes: twin of
// `halfshade_scene::light::OctahedralGrid::lookup_batch`.
#import "common/constants.wgsl"

struct OctahedralWeights {
    nodes: vec3u,
    weights: vec3f,
}

fn octahedral_lookup(direction: vec3f, cells: f32) -> OctahedralWeights {
    let size = abs(direction);
    let scaled = size / max(size.x + size.y + size.z, SMALLEST);
    let inner = vec2f(scaled.x, scaled.z);
    let folded = select(vec2f(1.0) - inner.yx, inner, direction.y >= 0.0);
    let place = clamp(folded * cells, vec2f(0.0), vec2f(cells));
    let cell = min(floor(place), vec2f(cells - 1.0));
    let within = place - cell;
    let sum = within.x + within.y;
    let is_far = sum > 1.0;
    let step = select(0.0, 1.0, is_far);
    let toward = vec2f(select(1.0, -1.0, direction.x < 0.0), select(1.0, -1.0, direction.z < 0.0));
    return OctahedralWeights(
        vec3u(
            octahedral_node(cell + vec2f(step, step), toward, cells),
            octahedral_node(cell + vec2f(1.0, 0.0), toward, cells),
            octahedral_node(cell + vec2f(0.0, 1.0), toward, cells),
        ),
        vec3f(
            abs(1.0 - sum),
            select(within.x, 1.0 - within.y, is_far),
            select(within.y, 1.0 - within.x, is_far),
        ),
    );
}

fn octahedral_node(cell: vec2f, toward: vec2f, cells: f32) -> u32 {
    let at = toward * cell + vec2f(cells);
    return u32(at.y * (2.0 * cells + 1.0) + at.x);
}
