// Places between the sample points of a field: twin of `shadow_field/kernel/shell_grid.rs`.
#import "shadow_field/frame.wgsl"

// A field within `tables`.
struct Field {
    // Rows at which shells begin, from the centre on, and next shells outward by distance.
    shells: u32,
    outer: u32,
    // The last step of distance that has a next shell.
    last_step: u32,
    steps_per_radius: f32,
    // Radius of the last shell, in radii of the object.
    outermost: f32,
}

fn field_at(row: u32) -> Field {
    let places = tables[row];
    let lengths = bitcast<vec2f>(tables[row + 1u].xy);
    return Field(places.x, places.y, places.z, lengths.x, lengths.y);
}

// One shell of a field.
struct Shell {
    // Sample points along longitude, as along latitude.
    resolution: u32,
    // Row of `samples` at which its own begin, and of `tables` at which smallest values and steps do.
    samples: u32,
    scales: u32,
    radius: f32,
}

fn shell_at(field: Field, number: u32) -> Shell {
    let row = tables[field.shells + number];
    return Shell(row.x, row.y, row.z, bitcast<f32>(row.w));
}

// The next shell outward; what counts of it and of that within.
struct ShellPair {
    outer: u32,
    within: f32,
    without: f32,
}

fn between_shells(field: Field, distance: f32) -> ShellPair {
    let step = min(u32(min(distance, field.outermost) * field.steps_per_radius), field.last_step);
    let four = tables[field.outer + step / 16u][step / 4u % 4u];
    let outer = (four >> (8u * (step % 4u))) & 255u;
    if (distance >= field.outermost) {
        let shrunk = field.outermost / distance;
        return ShellPair(outer, 0.0, shrunk * shrunk);
    }
    let low = shell_at(field, outer - 1u).radius;
    let high = shell_at(field, outer).radius;
    let share = clamp((distance - low) / (high - low), 0.0, 1.0);
    return ShellPair(outer, 1.0 - share, share);
}

// Four points of a grid, and their weights, of sum 1.
struct Corners {
    places: vec4u,
    weights: vec4f,
}

fn corners(resolution: u32, u: f32, v: f32) -> Corners {
    let at = vec2f(u, v) * f32(resolution) - 0.5;
    let low = floor(at);
    let next = low + 1.0;
    let t = at - low;
    let s = 1.0 - t;
    return Corners(
        vec4u(
            grid_point(low.x, low.y, resolution),
            grid_point(next.x, low.y, resolution),
            grid_point(low.x, next.y, resolution),
            grid_point(next.x, next.y, resolution),
        ),
        vec4f(s.x * s.y, t.x * s.y, s.x * t.y, t.x * t.y),
    );
}

// Across the seam of longitudes as anywhere, and over a pole to the opposite longitude. One point alone is its own opposite:
// what is half a column too many is cut off.
fn grid_point(column: f32, row: f32, resolution: u32) -> u32 {
    let side = f32(resolution);
    let is_over = row < 0.0 || row >= side;
    let turned = column + select(0.0, 0.5 * side, is_over);
    let line = u32(clamp(row, 0.0, side - 1.0));
    return line * resolution + (u32(i32(turned)) & (resolution - 1u));
}
