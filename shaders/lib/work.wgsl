// Work of the rays of a pixel.

#import lists

@group(2) @binding(28) var counts: texture_storage_2d<rgba32uint, write>; // with COUNT

fn store_work(pixel: vec2u, steps: u32) {
    if (exhausted_rays > 0u) { atomicAdd(&counters[EXHAUSTED_COUNTER], exhausted_rays); }
    if (COUNT) { textureStore(counts, pixel, vec4u(steps, traversals, visited_nodes, tested_triangles)); }
}
