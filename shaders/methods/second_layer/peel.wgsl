// Peel: rasterizes depth and ids of the second depth layer, for each pixel the nearest surface at least `separation_m`
// behind the first, from whichever side it is seen.

#import capsules_seen
#import layer_test
#import peeled
#import pulled
#import surface

override CUTOUT: bool = false; // whether this pipeline draws cut-out materials

@fragment
fn fragment(in: Varying) -> @location(0) vec2u {
    if (!is_behind(in.clip, in.ids)) { discard; }
    if (CUTOUT && !alpha_passes(in.ids.x, in.ids.y, in.bary)) { discard; }
    return in.ids;
}

// Capsules have two sides that may be the nearest one behind the first layer.
@fragment
fn fragment_capsule_peeled(in: CapsuleVarying) -> CapsuleFragment {
    let least_m = least_depth_m(vec2u(in.clip.xy));
    let origin = pixel_origin(in.clip.xy);
    let direction = pixel_ray(in.clip.xy);
    let c = corners(in.ids.x, in.ids.y);
    let axis = c.p[1] - c.p[0];
    let radius = c.values.capsule_radius_m;
    let o = to_object(c.values.object_from_world, origin) - c.p[0];
    let d = direction_to_object(c.values.object_from_world, direction);
    let span = capsule_span(o, d, axis, radius);
    if (!span.is_met) { discard; }
    for (var side = 0u; side < 2u; side++) {
        let t = select(span.enter, span.leave, side == 1u);
        if (t < max(least_m, frame.near_m)) { continue; }
        if (!is_cutout(in.ids.x) || alpha_passes(in.ids.x, in.ids.y, capsule_place(o + d * t, axis, radius))) {
            return CapsuleFragment(in.ids, screen_z(t));
        }
    }
    discard;
}
