// A vertex of an instance, from vertex and instance buffers.

struct Placed {
    @location(0) position: vec3f,
    @location(1) row_x: vec4f, // rows of the transform from object to world space
    @location(2) row_y: vec4f,
    @location(3) row_z: vec4f,
}

fn placed_in_world(p: Placed) -> vec3f {
    return vec4f(p.position, 1.0) * mat3x4f(p.row_x, p.row_y, p.row_z);
}
