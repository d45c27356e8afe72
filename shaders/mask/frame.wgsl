// The data of a frame of mask.
#import "shared/irradiance.wgsl"

struct Frame {
    // Irradiance by constant light; by a map, the table counts.
    constant: vec4f,
    // In light space.
    eye: vec4f,
    // Cells of the table of irradiance over normals; 0 of constant light.
    grid_cells: f32,
    // Cells of the grid of normals that have directions of their own; 0: there is one set.
    normal_cells: f32,
    // Width of an edge in radii of a direction's cell.
    edge: f32,
    // Directions into each lamp.
    lamp_directions: f32,
    sphere_count: u32,
    box_count: u32,
    lamp_count: u32,
    // Sixteens of directions of a set, and of those into a lamp.
    set_sixteens: u32,
    lamp_sixteens: u32,
    // Rows of `rows` at which boxes and lamps begin.
    boxes: u32,
    lamps: u32,
    // Rows of `tables` at which sets of directions and places on lamps begin.
    sets: u32,
    spiral: u32,
    // Cells along the side of the grid of directions that meshes hide from themselves.
    own_side: u32,
    // Row of `tables` at which levels of the light over lobes begin, and how many there are; 0 of constant light.
    levels: u32,
    level_count: u32,
    // The same of directions along lobes, in sixteens.
    lobe_spiral: u32,
    lobe_sixteens: u32,
    // Place in `cells` of what objects reflect.
    objects: u32,
    padding: u32,
}

@group(1) @binding(0) var<storage, read> frame: Frame;
// Spheres, two rows each: centre and radius, object; boxes, five: middle and object, halves, rows of the rotation; lamps, two:
// centre and radius of a sphere or direction and sine of a sun, radiance and 1 for a sphere.
@group(1) @binding(1) var<storage, read> rows: array<vec4f>;
// Irradiance at the nodes; sets of directions, each a row of the mean sharpness and seven rows for every four directions: x, y, z,
// sharpness, weights by channel; places on lamps, three rows for every four: part within, cosine and sine of the turn; directions along
// lobes likewise: -log of the part without; levels of the light over lobes: a row each of the first node, from the first of these rows
// on, and the cells of its grid; then their nodes.
@group(1) @binding(2) var<storage, read> tables: array<vec4f>;
// Eight numbers for each receiver: the words at which cells of three vertices begin, their weights, whether they are known, whether all is open;
// then words of cells; then two numbers for each object and one more: the place of its first term, from the first of these on, and how
// many it has; then terms, eight numbers each.
@group(1) @binding(3) var<storage, read> cells: array<u32>;
