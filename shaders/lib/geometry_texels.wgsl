// The scene's meshes in one texture per array, for software drivers, as the BVHs in trees_texels.wgsl: a vertex in two
// texels of four words each, an index in a texel of one word.

#import texel

@group(1) @binding(3) var vertices: texture_2d<u32>;
@group(1) @binding(4) var mesh_data: texture_2d<u32>;

fn mesh_word(i: u32) -> u32 {
    return textureLoad(mesh_data, texel_place(i), 0).x;
}

fn vertex_position(i: u32) -> vec3f {
    return bitcast<vec3f>(textureLoad(vertices, texel_place(2u * i), 0).xyz);
}

fn vertex_normal(i: u32) -> u32 {
    return textureLoad(vertices, texel_place(2u * i), 0).w;
}

fn vertex_uv(i: u32) -> vec2f {
    return bitcast<vec2f>(textureLoad(vertices, texel_place(2u * i + 1u), 0).xy);
}

fn vertex_tangent(i: u32) -> u32 {
    return textureLoad(vertices, texel_place(2u * i + 1u), 0).z;
}

fn vertex_shade(i: u32) -> u32 {
    return textureLoad(vertices, texel_place(2u * i + 1u), 0).w;
}
