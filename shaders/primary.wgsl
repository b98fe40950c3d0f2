// Primary rays: finds the surface that each pixel shows by tracing through the BVHs, with the same culling, near
// plane and cut-outs as the rasterizing visibility pass.

#import bvh
#import frame
#import surface
#import work

@group(2) @binding(0) var ids: texture_storage_2d<rg32uint, write>;

@compute @workgroup_size(GROUP_PX, GROUP_PX)
fn main(@builtin(workgroup_id) group: vec3u, @builtin(num_workgroups) groups: vec3u, @builtin(local_invocation_id) local: vec3u) {
    let pixel = surface_pixel(invoked_place(group, groups, local));
    if (any(pixel >= vec2u(frame.size))) { return; }
    // The direction has a component of 1 along the view axis, so that t is linear view depth.
    let center = vec2f(pixel) + 0.5;
    let seen = seen_part(center);
    let h = trace_nearest(pixel_origin(center), pixel_ray(center), seen.x, seen.y);
    if (HAS_CULLED) {
        let is_culled = culled_t < h.t;
        lists[pyramid_slot(pyramid(), pixel, 0u)] = bitcast<u32>(select(0.0, screen_z(culled_t), is_culled));
    }
    textureStore(ids, pixel, vec4u(h.instance, select(h.triangle, NONE, h.instance == NONE), 0u, 0u));
    store_work(pixel, 0u);
}
