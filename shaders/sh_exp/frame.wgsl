// The data of a frame of sh-exp.

struct Blocker {
    center: vec3f,
    radius: f32,
    // How much of each band of its logarithm counts.
    low_factors: vec4f,
    high_factors: vec4f,
}

struct Frame {
    // Clamped cosine over π by band: constant light.
    low_cosine: vec4f,
    high_cosine: vec4f,
    // Constant light; unused by a map.
    light: vec4f,
    sun_direction: vec4f,
    // Reflected radiance of a white surface that faces the sun; its sine of the angular radius.
    sun_perpendicular: vec4f,
    // Rows of `tables` at which there begin: the exponential's, the light by normal, the sun's basis.
    exponential_table: u32,
    light_table: u32,
    sun_table: u32,
    light_channels: u32,
    // The exponential's table: last entry, largest magnitude, entries per magnitude. Cells of the grid over normals.
    exponential_last: f32,
    exponential_limit: f32,
    exponential_per_magnitude: f32,
    grid_cells: f32,
}

@group(1) @binding(0) var<uniform> frame: Frame;
@group(1) @binding(1) var<storage, read> blockers: array<Blocker>;
// First blocker and number of blockers, by group of receivers.
@group(1) @binding(2) var<storage, read> cuts: array<vec2u>;
// Blockers by angular radius from row 0 on, and the tables that `frame` tells of.
@group(1) @binding(3) var<storage, read> tables: array<vec4f>;
