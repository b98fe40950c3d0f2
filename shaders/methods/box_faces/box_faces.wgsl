// Box faces: static surfaces in the box of method ssr+box, seen from each of its faces along the face's axis.

#import bvh
#import face_box
#import surface

@group(2) @binding(0) var written_faces: texture_storage_2d_array<rgba32uint, write>; // depth, instance, triangle, place

// Depth up to which faces see: surfaces in the border across are seen in spite of rounding.
const FACE_REACH: f32 = 1.001;

@compute @workgroup_size(GROUP_PX, GROUP_PX)
fn main(@builtin(global_invocation_id) id: vec3u) {
    let size = textureDimensions(written_faces).x;
    if (any(id.xy >= vec2u(size))) { return; }
    let at = FacePoint((vec2f(id.xy) + 0.5) / f32(size), FACE_INSET);
    let start = face_box.low + face_box.size * point_of_face(id.z, at);
    let sight = inwards(id.z);
    let size_m = dot(abs(sight), face_box.size);
    let h = trace_nearest(start, sight, 0.0, size_m * (FACE_REACH - FACE_INSET));
    let depth = FACE_INSET + h.t / size_m;
    textureStore(written_faces, id.xy, id.z, vec4u(bitcast<u32>(depth), h.instance, h.triangle, pack2x16unorm(h.bary)));
}
