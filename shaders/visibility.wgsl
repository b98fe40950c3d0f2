// Visibility: rasterizes depth and ids (instance, triangle), nothing else. Vertices are pulled for cut-outs, and
// where the device has no primitive index, so that triangles are numbered by their vertices.

#import triangles
#import capsules_seen
#import pulled
#import surface

override CUTOUT: bool = false; // whether this pipeline draws cut-out materials

@fragment
fn fragment(in: Varying) -> @location(0) vec2u {
    if (CUTOUT && !alpha_passes(in.ids.x, in.ids.y, in.bary)) { discard; }
    if (is_cut_away(in.clip)) { discard; }
    return in.ids;
}
