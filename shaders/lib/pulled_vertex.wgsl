// A vertex of a triangle that the shader pulls from the mesh's buffers.

#import surface

struct Varying {
    @builtin(position) @invariant clip: vec4f,
    @location(0) @interpolate(flat) ids: vec2u,
    @location(1) bary: vec2f,
}

fn pulled_vertex(vertex: u32, instance: u32, clip_from_world: mat4x4f) -> Varying {
    let corner = vertex % 3u;
    let values = instance_values(instance);
    let index = mesh_word(values.index_base + vertex);
    let p = to_world(values, vertex_at(values.vertex_base + index).position);
    let bary = vec2f(f32(corner == 1u), f32(corner == 2u));
    return Varying(clip_from_world * vec4f(p, 1.0), vec2u(instance, vertex / 3u), bary);
}
