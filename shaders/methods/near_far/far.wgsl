// Far: hits of rays from the camera, through the pixels of a cube map, with surfaces behind the box of method near-far,
// in one or two layers.

#import bvh
#import cube_faces
#import far_box
#import surface

@group(2) @binding(0) var far_hits: texture_storage_2d_array<rgba32uint, write>; // distance, instance, triangle, place

@compute @workgroup_size(GROUP_PX, GROUP_PX)
fn main(@builtin(global_invocation_id) id: vec3u) {
    let size = textureDimensions(far_hits).x;
    if (any(id.xy >= vec2u(size))) { return; }
    let place = (vec2f(id.xy) + 0.5) * (2.0 / f32(size)) - 1.0;
    let towards = face_direction(id.z, place);
    let direction = normalize(towards);
    var start_m = far_box.half_size_m * length(towards);
    for (var map = 0u; map < far_box.layers; map++) {
        let h = trace_nearest(far_box.eye, direction, start_m, FAR_M);
        textureStore(far_hits, id.xy, 6u * map + id.z, vec4u(bitcast<u32>(h.t), h.instance, h.triangle, pack2x16unorm(h.bary)));
        start_m = h.t + far_box.separation_m;
    }
}
