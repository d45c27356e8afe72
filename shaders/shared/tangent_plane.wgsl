// The rules for spheres that cut a receiver's tangent plane: twin of `shared/tangent_plane.rs`.
#import "common/constants.wgsl"

const CONTINUOUS = 0u;
const COVERING = 1u;
const PUBLISHED = 2u;

override RULE: u32 = CONTINUOUS;
// Height of a sphere's centre, in radii, from which on it counts in full.
override FULL_HEIGHT: f32 = 1.0;

struct Adjusted {
    offset: vec3f,
    reach: f32,
}

// The offset of a sphere's centre and its radius after the rules; a reach of 0 has no influence.
fn adjusted(offset: vec3f, radius: f32, normal: vec3f) -> Adjusted {
    let height = dot(offset, normal);
    if (height >= radius) {
        return Adjusted(offset, radius);
    }
    let front = clamp((radius + height) * 0.5, 0.0, radius);
    if (front <= 0.0) {
        return Adjusted(normal, 0.0);
    }
    let foot = offset - height * normal;
    let smallest = max(radius * radius * 1e-12f, SMALLEST);
    let cut_squared = max((radius - height) * (radius + height), smallest);
    let relative = sqrt(dot(foot, foot) / cut_squared);
    var in_front = 0.0;
    if (RULE == PUBLISHED) {
        in_front = select(0.0, 1.0, height >= 0.0);
    } else {
        in_front = clamp(height / (radius * FULL_HEIGHT), 0.0, 1.0);
    }
    let scale = min(max(relative - 1.0, in_front), 1.0);
    var moved = offset + (max(height, front) - height) * normal;
    if (RULE == COVERING) {
        moved -= in_front * (1.0 - min(relative, 1.0)) * foot;
    }
    return Adjusted(moved, scale * front);
}
