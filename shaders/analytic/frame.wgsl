// The data of a frame of analytic.
#import "shared/irradiance.wgsl"

struct Frame {
    // Irradiance by constant light; by a map, the table counts.
    constant: vec4f,
    // Cells of the table of irradiance over normals; 0 of constant light.
    grid_cells: f32,
    sphere_count: u32,
    lamp_count: u32,
    padding: u32,
}

// In storage, as bounds of loops are.
@group(1) @binding(0) var<storage, read> frame: Frame;
// Spheres, two rows each: centre and radius, object; lamps, two: centre and radius of a sphere or direction and sine of a sun,
// radiance and 1 for a sphere.
@group(1) @binding(1) var<storage, read> rows: array<vec4f>;
// Irradiance at the nodes.
@group(1) @binding(2) var<storage, read> tables: array<vec4f>;
