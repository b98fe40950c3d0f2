// Capsules of the second depth layer: the nearer or the farther side.

#import layer_test
#import capsules_seen

@fragment
fn fragment_capsule_peeled(in: CapsuleVarying) -> CapsuleFragment {
    let least_m = least_depth_m(vec2u(in.clip.xy));
    let origin = pixel_origin(in.clip.xy);
    let direction = pixel_ray(in.clip.xy);
    let c = corners(in.ids.x, in.ids.y);
    let axis = c.p[1] - c.p[0];
    let radius = instance_capsule_radius_m(in.ids.x);
    let rows = instance_object_from_world(in.ids.x);
    let offset = origin - vec3f(rows[0].w, rows[1].w, rows[2].w);
    let o = vec3f(dot(rows[0].xyz, offset), dot(rows[1].xyz, offset), dot(rows[2].xyz, offset)) - c.p[0];
    let d = vec3f(dot(rows[0].xyz, direction), dot(rows[1].xyz, direction), dot(rows[2].xyz, direction));
    let span = capsule_span(o, d, axis, radius);
    if (!span.is_met) { discard; }
    let is_cut_out = material_alpha_cutoff(instance_material(in.ids.x)) >= 0.0;
    for (var side = 0u; side < 2u; side++) {
        let t = select(span.enter, span.leave, side == 1u);
        if (t < max(least_m, frame.near_m)) { continue; }
        if (!is_cut_out || alpha_passes(in.ids.x, in.ids.y, capsule_place(o + d * t, axis, radius))) {
            return CapsuleFragment(in.ids, screen_z(t));
        }
    }
    discard;
}
