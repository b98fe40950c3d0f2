// The scene's meshes in one texture per array, for software drivers, as the BVHs in trees_texels.wgsl: a vertex in two
// texels of four words each, an index in a texel of one word.

#import texels

@group(1) @binding(3) var vertices: VectorTexels;
@group(1) @binding(4) var mesh_data: WordTexels;

fn mesh_word(i: u32) -> u32 {
    return word_at(mesh_data, i);
}

fn vertex_position(i: u32) -> vec3f {
    return bitcast<vec3f>(vector_at(vertices, 2u * i).xyz);
}

fn vertex_normal(i: u32) -> u32 {
    return vector_at(vertices, 2u * i).w;
}

fn vertex_uv(i: u32) -> vec2f {
    return bitcast<vec2f>(vector_at(vertices, 2u * i + 1u).xy);
}

fn vertex_tangent(i: u32) -> u32 {
    return vector_at(vertices, 2u * i + 1u).z;
}

fn vertex_shade(i: u32) -> u32 {
    return vector_at(vertices, 2u * i + 1u).w;
}
