// Whether anything lies on a ray: any-hit traversal of two levels of hierarchies. It answers as
// `halfshade-rays` does, in single precision.
#import "common/constants.wgsl"
#import "ray_traced/cutout.wgsl"
#import "ray_traced/frame.wgsl"

const LEAF = 0x80000000u;
const STACK = 56u;
const LANES = 64u;
// Leaves an object: no leaf has this code.
const LEAVE = 0xffffffffu;

var<workgroup> stack: array<u32, 3584>;

struct Ray {
    origin: vec3f,
    direction: vec3f,
    inverse: vec3f,
    // How far the origin may be off along each axis.
    slack: vec3f,
    // The axis along which the direction is longest, and the two others as parts of that one.
    longest: u32,
    shear: vec2f,
}

fn ray_of(origin: vec3f, direction: vec3f, slack: vec3f) -> Ray {
    // Neither 0 nor so small that the quotient overflows.
    let safe = select(direction, vec3f(1e-30f), abs(direction) < vec3f(1e-30f));
    let size = abs(direction);
    let longest = select(select(2u, 1u, size.y > size.z), 0u, size.x > max(size.y, size.z));
    let turned = longest_last(longest, direction);
    return Ray(origin, direction, 1.0 / safe, slack, longest, turned.xy / turned.z);
}

fn longest_last(longest: u32, vector: vec3f) -> vec3f {
    return select(select(vector, vector.zxy, longest == 1u), vector.yzx, longest == 0u);
}

// Parameter at which a ray enters a box, or more than any if it passes by.
fn entry(ray: Ray, low: vec3f, high: vec3f, limit: f32) -> f32 {
    let to_low = (low - ray.origin) * ray.inverse;
    let to_high = (high - ray.origin) * ray.inverse;
    let near = min(to_low, to_high);
    let far = max(to_low, to_high);
    let first = max(max(near.x, near.y), max(near.z, 0.0));
    let last = min(min(far.x, far.y), min(far.z, limit));
    // Quotients may err by two units in the last place.
    return select(3.4e38f, first, first <= last * (1.0 + 4.0 * EPSILON) && low.x <= high.x);
}

// A corner in space that is sheared so that the ray is its third axis [Woop2013].
fn sheared(ray: Ray, corner: vec3f) -> vec2f {
    let turned = longest_last(ray.longest, corner - ray.origin);
    return turned.xy - turned.z * ray.shear;
}

// Twice the area between the ray and an edge, as seen along the ray. Both triangles at the edge find the same bits but for the
// sign, and at a corner the sign is in doubt for no edge but one in line with the ray, so that no ray passes between them.
fn area(a: vec2f, b: vec2f) -> f32 {
    let is_forward = a.x < b.x || (a.x == b.x && a.y < b.y);
    let first = select(b, a, is_forward);
    let second = select(a, b, is_forward);
    return select(-1.0, 1.0, is_forward) * (first.x * second.y - first.y * second.x);
}

fn is_met(ray: Ray, triangle: Triangle, limit: f32, reach: f32) -> bool {
    let a = sheared(ray, triangle.a);
    let b = sheared(ray, triangle.b);
    let c = sheared(ray, triangle.c);
    let areas = vec3f(area(b, c), area(c, a), area(a, b));
    if (!(all(areas >= vec3f(0.0)) || all(areas <= vec3f(0.0)))) {
        return false;
    }
    let normal = cross(triangle.b - triangle.a, triangle.c - triangle.a);
    let ahead = dot(normal, triangle.a - ray.origin);
    let facing = dot(normal, ray.direction);
    let off = dot(abs(normal), ray.slack);
    // A triangle that faces the ray is met though it be behind the origin by what that may be off; one that faces away isn't.
    let farthest = min(off, -facing * reach);
    let is_ahead = select((ahead < farthest), (ahead > off), (facing > 0.0));
    if (!(facing != 0.0 && is_ahead && ahead / facing <= limit)) {
        return false;
    }
    if (HAS_CUTOUTS && triangle.holes > 0u) {
        return !is_cut_out(triangle.holes, areas / (areas.x + areas.y + areas.z));
    }
    return true;
}

fn is_blocked(lane: u32, origin: vec3f, direction: vec3f, slack: vec3f, reach: f32, limit: f32) -> bool {
    if (frame.instance_count == 0u) {
        return false;
    }
    let outer = ray_of(origin, direction, slack);
    var ray = outer;
    var is_inside = false;
    var height = 0u;
    var code = 0u;
    loop {
        if (code == LEAVE) {
            ray = outer;
            is_inside = false;
        } else if ((code & LEAF) == 0u) {
            let node = nodes[code];
            let left = entry(ray, node.left_low, node.left_high, limit);
            let right = entry(ray, node.right_low, node.right_high, limit);
            let nearest = min(left, right);
            if (nearest < 3.4e38f) {
                let is_left = left <= right;
                if (max(left, right) < 3.4e38f) {
                    stack[height * LANES + lane] = select(node.left, node.right, is_left);
                    height++;
                }
                code = select(node.right, node.left, is_left);
                continue;
            }
        } else if (!is_inside) {
            let row = frame.instances + 4u * (code & 0x0fffffffu);
            let x = bitcast<vec4f>(rows[row]);
            let y = bitcast<vec4f>(rows[row + 1u]);
            let z = bitcast<vec4f>(rows[row + 2u]);
            let point = vec4f(origin, 1.0);
            let size = vec4f(abs(origin) + slack, 1.0);
            ray = ray_of(
                vec3f(dot(x, point), dot(y, point), dot(z, point)),
                vec3f(dot(x.xyz, direction), dot(y.xyz, direction), dot(z.xyz, direction)),
                // The slack there, and rounding of the way here.
                vec3f(dot(abs(x.xyz), slack), dot(abs(y.xyz), slack), dot(abs(z.xyz), slack))
                    + 4.0 * EPSILON * vec3f(dot(abs(x), size), dot(abs(y), size), dot(abs(z), size)),
            );
            is_inside = true;
            stack[height * LANES + lane] = LEAVE;
            height++;
            code = rows[row + 3u].x;
            continue;
        } else {
            let first = code & 0x0fffffffu;
            let last = first + ((code >> 28u) & 7u);
            for (var number = first; number <= last; number++) {
                if (is_met(ray, triangles[number], limit, reach)) {
                    return true;
                }
            }
        }
        if (height == 0u) {
            return false;
        }
        height--;
        code = stack[height * LANES + lane];
    }
    return false;
}
