// Compressed transfer times light: twin of `prt/kernel/decode.rs`.

struct Frame {
    // Weights of a row.
    components: u32,
}

// A receiver between vertices: where the weights of their rows begin, where the products of their clusters do, and the share of each;
// all 0 where no light arrives.
struct Between {
    rows: vec3u,
    clusters: vec3u,
    weights: vec3f,
}

@group(1) @binding(0) var<storage, read> frame: Frame;
@group(1) @binding(1) var<storage, read> row_weights: array<f32>;
@group(1) @binding(2) var<storage, read> points: array<Between>;
// Light times the mean of a cluster, then times each of its axes.
@group(1) @binding(3) var<storage, read> products: array<vec4f>;

// Radiance of a white receiver at a row.
fn decoded_row(row: u32, cluster: u32) -> vec3f {
    var radiance = products[cluster].xyz;
    for (var k = 0u; k < frame.components; k++) {
        radiance = fma(vec3f(row_weights[row + k]), products[cluster + 1u + k].xyz, radiance);
    }
    return radiance;
}

// Radiance of a white receiver between rows.
fn decoded_between(between: Between) -> vec3f {
    return between.weights.x * decoded_row(between.rows.x, between.clusters.x)
        + between.weights.y * decoded_row(between.rows.y, between.clusters.y)
        + between.weights.z * decoded_row(between.rows.z, between.clusters.z);
}
