// The data of a frame of ray-traced.

struct Frame {
    // Rows of the rotation from world to environment.
    environment: array<vec4f, 3>,
    // Constant radiance; by a map, the texels count.
    constant: vec4f,
    // Direction to the sun's centre in the environment, and 1 - cos of its angular radius; negative without a sun.
    sun: vec4f,
    sun_radiance: vec4f,
    eye: vec4f,
    // Steps of the points in two and in three dimensions.
    plane_steps: vec4u,
    space_steps: vec4u,
    space_last_step: vec2u,
    samples: u32,
    // Share of directions that are drawn by cosine.
    cosine_share: f32,
    // Powers of what shines from afar and of the sun.
    base_power: f32,
    sun_power: f32,
    // Columns and rows of the map; 0 without one.
    map_width: u32,
    map_height: u32,
    // Rows of `rows` at which there begin: objects, lights, what stays, texels, alias numbers, irradiance over normals.
    instances: u32,
    instance_count: u32,
    lights: u32,
    light_count: u32,
    tables: u32,
    texels: u32,
    aliases: u32,
    irradiances: u32,
    // Cells of that from its centre to a side.
    grid_cells: f32,
    // Rows at which there begin: columns, rows, first cell and chord of each level of cells; solid angles of texels by row;
    // running sums of the largest cells by normal, and below the numbers of those cells.
    levels: u32,
    level_count: u32,
    solid_angles: u32,
    sums: u32,
    largest_columns: u32,
    largest_rows: u32,
    // Cells of the table of sums over normals from its centre to a side.
    normal_cells: f32,
    order: u32,
    padding: u32,
    more_padding: u32,
    last_padding: u32,
}

// The boxes of two children; see `halfshade_gpu::hierarchy`.
struct Node {
    left_low: vec3f,
    left: u32,
    left_high: vec3f,
    right: u32,
    right_low: vec3f,
    padding: u32,
    right_high: vec3f,
    more_padding: u32,
}

struct Triangle {
    a: vec3f,
    // Row, of those that stay, at which its holes begin; 0 if it is whole.
    holes: u32,
    b: vec3f,
    padding: u32,
    c: vec3f,
    more_padding: u32,
}

// In storage: numbers of a uniform that decide branches Mesa's driver in software compiles into the kernel, with every dispatch.
@group(1) @binding(0) var<storage, read> frame: Frame;
// First the hierarchy over objects, then those of meshes.
@group(1) @binding(1) var<storage, read> nodes: array<Node>;
@group(1) @binding(2) var<storage, read> triangles: array<Triangle>;
// First what changes with every frame. What stays begins with a row per object, and one for what lies on none: the row, of
// those that stay, at which the terms of its reflectance begin, and how many they are.
@group(1) @binding(3) var<storage, read> rows: array<vec4u>;
