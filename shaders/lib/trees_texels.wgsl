// Nodes and triangles of the BVHs, in one texture each: software drivers read buffers word by word and lane by lane,
// but texels as vectors.

#import texel

@group(1) @binding(0) var nodes: texture_2d<u32>;
@group(1) @binding(1) var triangles: texture_2d<u32>;

fn node_words(i: u32) -> vec4u {
    return textureLoad(nodes, texel_place(i), 0);
}

fn triangle_words(i: u32) -> vec4u {
    return textureLoad(triangles, texel_place(i), 0);
}
