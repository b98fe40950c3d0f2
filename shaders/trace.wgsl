// Trace: follows the mirror rays of the listed pixels through the BVHs, bounce by bounce.

#import cause_stored
#import lists
#import mirror_path

@compute @workgroup_size(RAYS_PER_GROUP)
fn main(@builtin(workgroup_id) group: vec3u, @builtin(num_workgroups) groups: vec3u, @builtin(local_invocation_index) lane: u32) {
    let ray = (group.y * groups.x + group.x) * RAYS_PER_GROUP + lane;
    // Invocations past the list's end fill the last workgroup.
    if (ray >= atomicLoad(&counters[select(RAY_COUNTER, REST_COUNTER, UNDERSAMPLED)])) { return; }
    let pixel = unpack_pixel(lists[ray_slot(ray)]);
    trace_pixel(pixel);
    keep_cause(pixel, first_cause);
}
