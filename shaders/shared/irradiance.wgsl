// Irradiance of distant light over normals: twin of `shared/irradiance.rs`. The `frame` of the kernel has `constant` and `grid_cells`;
// its `tables` begin with the nodes.
#import "common/octahedral.wgsl"

fn rest_irradiance(normal: vec3f) -> vec3f {
    if (frame.grid_cells == 0.0) {
        return frame.constant.xyz;
    }
    let found = octahedral_lookup(normal, frame.grid_cells);
    return tables[found.nodes.x].xyz * found.weights.x + tables[found.nodes.y].xyz * found.weights.y
        + tables[found.nodes.z].xyz * found.weights.z;
}
