// A point of light space in the coordinates of an object's shells: twin of `shadow_field/kernel/shell_coordinates.rs`.
#import "common/constants.wgsl"
#import "shadow_field/frame.wgsl"

// From here on what an object blocks is nothing, and its square is still a number.
const FARTHEST = 1e18f;

// Relative to the centre along the axes of the object, without its scale.
fn object_axes(object: FieldObject, position: vec3f) -> vec3f {
    let offset = position - object.center;
    return vec3f(dot(object.rotation[0], offset), dot(object.rotation[1], offset), dot(object.rotation[2], offset));
}

// Distance from the centre in radii of the object, longitude and latitude as shares of the whole.
fn shell_coordinates(point: vec3f, inverse_radius: f32) -> vec3f {
    // Squares of small numbers may be taken for 0.
    let size = max(max(abs(point.x), abs(point.y)), max(abs(point.z), SMALLEST));
    let scaled = point / size;
    return vec3f(
        min(length(scaled) * (size * inverse_radius), FARTHEST),
        angle(scaled.z, scaled.x) / TAU,
        angle(length(scaled.xz), scaled.y) / PI,
    );
}

// atan2 within 3e-7 radians, 0 at the origin: that of the language may err by 4096 units in the last place. The polynomial
// is the Cephes library's.
fn angle(y: f32, x: f32) -> f32 {
    let size = abs(vec2f(x, y));
    let ratio = min(size.x, size.y) / max(max(size.x, size.y), SMALLEST);
    // Above tan(π/8).
    let is_steep = ratio > 0.41421356f;
    let t = select(ratio, (ratio - 1.0) / (ratio + 1.0), is_steep);
    let squared = t * t;
    var series = 8.05374449538e-2f * squared - 1.38776856032e-1f;
    series = series * squared + 1.99777106478e-1f;
    series = series * squared - 3.33329491539e-1f;
    var found = series * squared * t + t + select(0.0, 0.25 * PI, is_steep);
    found = select(found, 0.5 * PI - found, size.y > size.x);
    found = select(found, PI - found, x < 0.0);
    return select(found, -found, y < 0.0);
}
