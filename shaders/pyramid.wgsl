// Pyramid: the nearest depth in cells of 2, 4, … pixels, as clip-space z, which is linear along a ray
// on the screen. One workgroup computes all levels of a tile, whose edge is a cell of the last.

#import lists

@group(2) @binding(0) var view_depth: texture_2d<f32>;

const CELLS: u32 = 1u << (PYRAMID_LEVELS - 1u); // number of cells of level 1 along the tile's edge
const LANES: u32 = CELLS / 2u;

var<workgroup> tile: array<f32, CELLS * CELLS>;

fn depth_at(pixel: vec2u) -> f32 {
    // Pixels past the border count as infinitely far.
    let inside = all(pixel < vec2u(frame.size));
    let at = min(pixel, vec2u(frame.size) - 1u);
    var nearest = screen_z(textureLoad(view_depth, at, 0).x);
    if (HAS_CULLED) { nearest = max(nearest, bitcast<f32>(lists[culled_slot(at)])); }
    return select(0.0, nearest, inside);
}

@compute @workgroup_size(LANES, LANES)
fn main(@builtin(workgroup_id) group: vec3u, @builtin(local_invocation_id) local: vec3u) {
    for (var k = 0u; k < 4u; k++) {
        let cell = local.xy * 2u + vec2u(k & 1u, k >> 1u);
        let pixel = (group.xy * CELLS + cell) * 2u;
        let nearest = max(
            max(depth_at(pixel), depth_at(pixel + vec2u(1u, 0u))),
            max(depth_at(pixel + vec2u(0u, 1u)), depth_at(pixel + 1u)),
        );
        tile[cell.y * CELLS + cell.x] = nearest;
        lists[pyramid_slot(group.xy * CELLS + cell, 1u)] = bitcast<u32>(nearest);
    }
    var side = LANES; // number of cells of the level along the tile's edge
    for (var level = 2u; level <= PYRAMID_LEVELS; level++) {
        workgroupBarrier();
        let is_active = all(local.xy < vec2u(side));
        var nearest = 0.0;
        if (is_active) {
            let at = local.y * 2u * (2u * side) + local.x * 2u;
            nearest = max(max(tile[at], tile[at + 1u]), max(tile[at + 2u * side], tile[at + 2u * side + 1u]));
        }
        workgroupBarrier();
        if (is_active) {
            tile[local.y * side + local.x] = nearest;
            lists[pyramid_slot(group.xy * side + local.xy, level)] = bitcast<u32>(nearest);
        }
        side /= 2u;
    }
}
