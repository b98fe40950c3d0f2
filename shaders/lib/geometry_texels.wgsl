// The scene's meshes in one texture per array, for software drivers, as the BVHs in trees_texels.wgsl: a vertex in two
// texels of four words each, an index in a texel of one word.

#import structs
#import texels

@group(1) @binding(3) var vertices: VectorTexels;
@group(1) @binding(4) var mesh_data: WordTexels;

fn mesh_word(i: u32) -> u32 {
    return word_at(mesh_data, i);
}

// Drivers leave out a texel of which nothing is used.
fn vertex_at(i: u32) -> Vertex {
    let first = vector_at(vertices, 2u * i);
    let second = vector_at(vertices, 2u * i + 1u);
    return Vertex(bitcast<vec3f>(first.xyz), first.w, bitcast<vec2f>(second.xy), second.z, second.w);
}
