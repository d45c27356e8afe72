// Vectors four by four: twin of `shared/vector.rs`.

// Four directions.
struct Four {
    x: vec4f,
    y: vec4f,
    z: vec4f,
}

fn along(four: Four, direction: vec3f) -> vec4f {
    return fma(four.x, vec4f(direction.x), fma(four.y, vec4f(direction.y), four.z * direction.z));
}
