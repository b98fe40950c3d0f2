// Nodes and triangles of the BVHs, in one texture each: software drivers read buffers word by word and lane by lane,
// but texels as vectors.

#import texels

@group(1) @binding(0) var nodes: VectorTexels;
@group(1) @binding(1) var triangles: VectorTexels;

fn node_words(i: u32) -> vec4u {
    return vector_at(nodes, i);
}

fn triangle_words(i: u32) -> vec4u {
    return vector_at(triangles, i);
}
