// Pyramid: the nearest depth in cells of 2, 4, … pixels, as clip-space z, which is linear along a ray
// on the screen. One workgroup computes all levels of a tile, whose edge is a cell of the last; level 0 is written by
// the surface pass.

#import lists

const CELLS: u32 = 1u << (PYRAMID_LEVELS - 1u); // number of cells of level 1 along the tile's edge
const LANES: u32 = CELLS / 2u;

var<workgroup> tile: array<f32, CELLS * CELLS>;

fn nearest_at(p: Pyramid, pixel: vec2u) -> f32 {
    // Pixels past the border count as infinitely far.
    return select(0.0, bitcast<f32>(lists[pyramid_slot(p, pixel, 0u)]), all(pixel < vec2u(frame.size)));
}

@compute @workgroup_size(LANES, LANES)
fn main(@builtin(workgroup_id) group: vec3u, @builtin(local_invocation_id) local: vec3u) {
    let p = pyramid();
    for (var k = 0u; k < 4u; k++) {
        let cell = local.xy * 2u + vec2u(k & 1u, k >> 1u);
        let pixel = (group.xy * CELLS + cell) * 2u;
        let nearest = max(
            max(nearest_at(p, pixel), nearest_at(p, pixel + vec2u(1u, 0u))),
            max(nearest_at(p, pixel + vec2u(0u, 1u)), nearest_at(p, pixel + 1u)),
        );
        tile[cell.y * CELLS + cell.x] = nearest;
        lists[pyramid_slot(p, group.xy * CELLS + cell, 1u)] = bitcast<u32>(nearest);
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
            lists[pyramid_slot(p, group.xy * side + local.xy, level)] = bitcast<u32>(nearest);
        }
        side /= 2u;
    }
}
