// Trace: follows the mirror rays of the listed pixels through the BVHs, bounce by bounce, and shades the screen hits of
// the march. Both in one dispatch: drivers compile the shading once.

#import cause_stored
#import lists
#import mirror_path

override TRACE: bool = true; // false: methods that answer refused rays otherwise, or not at all

@compute @workgroup_size(RAYS_PER_GROUP)
fn main(@builtin(workgroup_id) group: vec3u, @builtin(num_workgroups) groups: vec3u, @builtin(local_invocation_index) lane: u32) {
    let at = group.y * groups.x + group.x;
    // A workgroup has rays alone or screen hits alone, since hits would wait for the rays beside them.
    let rays = select(atomicLoad(&counters[select(RAY_COUNTER, REST_COUNTER, UNDERSAMPLED)]), 0u, !TRACE);
    let ray_groups = (rays + RAYS_PER_GROUP - 1u) / RAYS_PER_GROUP;
    is_known = MARCH && at >= ray_groups;
    let index = (at - select(0u, ray_groups, is_known)) * RAYS_PER_GROUP + lane;
    // Invocations past the end of a list fill its last workgroup.
    if (index >= select(rays, atomicLoad(&counters[HIT_COUNTER]), is_known) || (is_known && !SHADE)) { return; }
    let pixel = unpack_pixel(lists[select(ray_slot(index), hit_slot(index), is_known)]);
    trace_pixel(pixel);
    if (!is_known) { keep_cause(pixel, first_cause); }
}
