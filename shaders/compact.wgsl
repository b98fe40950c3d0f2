// Compact: counts the pixels of each cause and lists those that must be traced, tile by tile so
// that neighbors stay together.

#import cause

@group(2) @binding(0) var cause: texture_2d<u32>;
@group(2) @binding(1) var<storage, read_write> counters: array<atomic<u32>, COUNTERS>; // of causes, then of rays
@group(2) @binding(2) var<storage, read_write> rays: array<u32>; // without TRACE: one, never written

override TRACE: bool = true; // the method traces; else only causes are counted

var<workgroup> tile_causes: array<atomic<u32>, CAUSES>;
var<workgroup> tile_rays: atomic<u32>;
var<workgroup> tile_start: u32;

@compute @workgroup_size(8, 8)
fn main(@builtin(global_invocation_id) id: vec3u, @builtin(local_invocation_index) lane: u32) {
    let inside = all(id.xy < textureDimensions(cause));
    var why = CAUSE_NOT_REFLECTIVE;
    var place = 0u;
    if (inside) {
        why = textureLoad(cause, id.xy, 0).x;
        atomicAdd(&tile_causes[min(why, CAUSES - 1u)], 1u);
        if (TRACE && is_traced(why)) { place = atomicAdd(&tile_rays, 1u); }
    }
    workgroupBarrier();
    if (lane == 0u) { tile_start = atomicAdd(&counters[RAY_COUNTER], atomicLoad(&tile_rays)); }
    if (lane < CAUSES) {
        let n = atomicLoad(&tile_causes[lane]);
        if (n > 0u) { atomicAdd(&counters[lane], n); }
    }
    workgroupBarrier();
    if (TRACE && inside && is_traced(why)) { rays[tile_start + place] = id.x | (id.y << 16u); }
}
