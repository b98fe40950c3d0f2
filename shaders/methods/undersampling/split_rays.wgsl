// Split rays: splits the listed rays into leaders, one of RATE, which are traced first, and followers (Kim et al. 2016).

#import leaders
#import lists

var<workgroup> leader_count: atomic<u32>;
var<workgroup> follower_count: atomic<u32>;
var<workgroup> first_leader: u32;
var<workgroup> first_follower: u32;

@compute @workgroup_size(RAYS_PER_GROUP)
fn main(@builtin(workgroup_id) group: vec3u, @builtin(num_workgroups) groups: vec3u, @builtin(local_invocation_index) lane: u32) {
    let index = (group.y * groups.x + group.x) * RAYS_PER_GROUP + lane;
    let is_listed = index < atomicLoad(&counters[RAY_COUNTER]);
    var bits = NONE;
    var place = 0u;
    if (is_listed) {
        bits = lists[ray_slot(index)];
        if (is_leader(unpack_pixel(bits))) { place = atomicAdd(&leader_count, 1u); } else { place = atomicAdd(&follower_count, 1u); }
    }
    workgroupBarrier();
    if (lane == 0u) {
        first_leader = atomicAdd(&counters[LEADER_COUNTER], atomicLoad(&leader_count));
        first_follower = atomicAdd(&counters[FOLLOWER_COUNTER], atomicLoad(&follower_count));
    }
    workgroupBarrier();
    if (!is_listed) { return; }
    lists[select(follower_slot(first_follower + place), leader_slot(first_leader + place), is_leader(unpack_pixel(bits)))] = bits;
}
