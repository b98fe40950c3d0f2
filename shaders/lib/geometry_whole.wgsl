// The scene's meshes with one binding per array. Where an array exceeds the device's binding size,
// src/render/buffers/chunks.rs generates the same functions over several bindings.

@group(1) @binding(3) var<storage, read> vertices: array<Vertex>;
@group(1) @binding(4) var<storage, read> mesh_data: array<u32>;

fn mesh_word(i: u32) -> u32 {
    return mesh_data[i];
}

fn vertex_at(i: u32) -> Vertex {
    return vertices[i];
}
