// Boxes that hide light: twin of `mask/kernel/boxes.rs`.
#import "mask/four.wgsl"
#import "mask/frame.wgsl"

// Part of a box's size by which receivers may lie in it by rounding.
const ROUNDING = 1e-5f;
const FARTHEST = 3e38f;

// The part of four directions that is left beside the box whose rows begin there, for a receiver at `position`; what is farther than `limit`
// hides nothing.
fn open_beside_box(first: u32, position: vec3f, four: Four, limit: f32) -> vec4f {
    let offset = position - rows[first].xyz;
    let halves = rows[first + 1u].xyz;
    let nearest = ROUNDING * max(halves.x, max(halves.y, halves.z));
    var enter = vec4f(-FARTHEST);
    var leave = vec4f(FARTHEST);
    for (var axis = 0u; axis < 3u; axis++) {
        let row = rows[first + 2u + axis].xyz;
        let step = along(four, row);
        let per_step = 1.0 / (max(abs(step), vec4f(1e-20f)) * select(vec4f(1.0), vec4f(-1.0), step < vec4f(0.0)));
        let place = dot(row, offset);
        let low = (-halves[axis] - place) * per_step;
        let high = (halves[axis] - place) * per_step;
        enter = max(enter, min(low, high));
        leave = min(leave, max(low, high));
    }
    let is_met = (leave >= enter) & (leave > vec4f(nearest)) & (enter < vec4f(limit));
    return select(vec4f(1.0), vec4f(0.0), is_met);
}
