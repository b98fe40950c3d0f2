// Pyramid: the nearest depth in cells of 2, 4, … pixels, as clip-space z, which is linear along a ray
// on the screen. One workgroup computes all levels of a tile, whose edge is a cell of the last; level 0 is written by
// the surface pass, and gets the depth of cut-outs beside it here.

#import lists
#import shown

override VERIFY: bool = true; // whether the march verifies its hits

const CELLS: u32 = 1u << (PYRAMID_LEVELS - 1u); // number of cells of level 1 along the tile's edge
const LANES: u32 = CELLS / 2u;

var<workgroup> tile: array<f32, CELLS * CELLS>;

// Nearest depth in a cell of level 1. Pixels of level 0 that show no cut-out first get the depth of the nearest in or around
// the cell: leaves and the edges of their holes are often so thin that rays meet them where no pixel's center shows them.
fn nearest_in(p: Pyramid, first: vec2u) -> f32 {
    let last = vec2u(frame.size) - 1u;
    var cutout = 0.0;
    for (var k = 0u; VERIFY && HAS_CUTOUT && k < 16u; k++) {
        let pixel = min(max(first + vec2u(k & 3u, k >> 2u), vec2u(1u)) - 1u, last);
        cutout = max(cutout, -bitcast<f32>(lists[pyramid_slot(p, pixel, 0u)]));
    }
    var nearest = 0.0;
    for (var k = 0u; k < 4u; k++) {
        let pixel = first + vec2u(k & 1u, k >> 1u);
        if (any(pixel > last)) { continue; } // infinitely far
        let slot = pyramid_slot(p, pixel, 0u);
        let own = bitcast<f32>(lists[slot]);
        if (own >= 0.0 && cutout > own) { lists[slot] = bitcast<u32>(cutout); }
        nearest = max(nearest, max(abs(own), cutout));
    }
    return nearest;
}

@compute @workgroup_size(LANES, LANES)
fn main(@builtin(workgroup_id) group: vec3u, @builtin(local_invocation_id) local: vec3u) {
    let p = pyramid();
    for (var k = 0u; k < 4u; k++) {
        let cell = local.xy * 2u + vec2u(k & 1u, k >> 1u);
        let nearest = nearest_in(p, (group.xy * CELLS + cell) * 2u);
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
