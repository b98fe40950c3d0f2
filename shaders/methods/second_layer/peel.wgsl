// Peel: rasterizes depth and ids of the second depth layer, for each pixel the nearest surface at least `separation_m`
// behind the first, from whichever side it is seen.

#import peeled
#import capsules_peeled
#import pulled
#import surface

override CUTOUT: bool = false; // whether this pipeline draws cut-out materials

@fragment
fn fragment(in: Varying) -> @location(0) vec2u {
    if (!is_behind(in.clip, in.ids)) { discard; }
    if (CUTOUT && !alpha_passes(in.ids.x, in.ids.y, in.bary)) { discard; }
    return in.ids;
}
