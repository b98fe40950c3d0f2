// Triangles whose vertices the shader pulls from the mesh's buffers.

#import frame
#import pulled_vertex

@vertex
fn vertex(@builtin(vertex_index) vertex: u32, @builtin(instance_index) instance: u32) -> Varying {
    return pulled_vertex(vertex, instance, frame.clip_from_world);
}
