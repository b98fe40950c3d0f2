// Nodes and triangles of the BVHs, in one buffer each.

@group(1) @binding(0) var<storage, read> nodes: array<vec4u>;
@group(1) @binding(1) var<storage, read> triangles: array<vec4u>;

fn node_words(i: u32) -> vec4u {
    return nodes[i];
}

fn triangle_words(i: u32) -> vec4u {
    return triangles[i];
}
