// Triangles whose vertices the shader pulls from the mesh's buffers.

#import frame
#import surface

struct Varying {
    @builtin(position) @invariant clip: vec4f,
    @location(0) @interpolate(flat) ids: vec2u,
    @location(1) bary: vec2f,
}

@vertex
fn vertex(@builtin(vertex_index) vertex: u32, @builtin(instance_index) instance: u32) -> Varying {
    var out: Varying;
    let triangle = vertex / 3u;
    let corner = vertex % 3u;
    let index = mesh_word(instance_index_base(instance) + vertex);
    let p = to_world(instance, vertex_position(instance_vertex_base(instance) + index));
    out.clip = frame.clip_from_world * vec4f(p, 1.0);
    out.ids = vec2u(instance, triangle);
    out.bary = vec2f(f32(corner == 1u), f32(corner == 2u));
    return out;
}
