// Trace sparse: traces the rays of one of RATE listed pixels (Kim et al. 2016), and lists the others, which follow them.

#import leaders
#import mirror_hit
#import mirrored
#import radiance
#import work

const PATHS: u32 = MIRROR_PATHS;

@group(2) @binding(5) var cause: texture_2d<u32>;
@group(2) @binding(6) var reflection: RadianceTexture;
@group(2) @binding(10) var lead_hit: texture_storage_2d<rgba32uint, write>; // distance, instance, triangle, cause

// Number of rays of a workgroup for each slot of RATE; below the group size, so that overflow is rare.
const SORTED: u32 = RAYS_PER_GROUP - 8u;

var<workgroup> leaders: array<u32, RAYS_PER_GROUP>;
var<workgroup> leader_count: atomic<u32>;
var<workgroup> follower_count: atomic<u32>;
var<workgroup> first_follower: u32;
var<workgroup> first_leader: u32;

// Sorts rays of a workgroup into leaders and followers. The result is the pixel of an invocation's leader; NONE: none.
fn sorted_leader(group: u32, lane: u32) -> u32 {
    let rays = atomicLoad(&counters[RAY_COUNTER]);
    let first = group * RATE * SORTED + lane;
    var places = array<u32, 4>(NONE, NONE, NONE, NONE);
    for (var k = 0u; k < RATE; k++) {
        let ray = first + k * SORTED;
        if (lane >= SORTED || ray >= rays) { continue; }
        let bits = lists[ray_slot(ray)];
        let pixel = unpack_pixel(bits);
        if (is_leader(pixel)) {
            let place = atomicAdd(&leader_count, 1u);
            if (place < RAYS_PER_GROUP) {
                leaders[place] = bits;
                continue;
            }
            textureStore(lead_hit, pixel, vec4u(0u, NOT_LED, NONE, 0u));
        }
        places[k] = atomicAdd(&follower_count, 1u);
    }
    workgroupBarrier();
    let placed = min(atomicLoad(&leader_count), RAYS_PER_GROUP);
    if (lane == 0u) {
        first_follower = atomicAdd(&counters[FOLLOWER_COUNTER], atomicLoad(&follower_count));
        if (MAPPED) { first_leader = atomicAdd(&counters[LEADER_COUNTER], placed); }
    }
    workgroupBarrier();
    for (var k = 0u; k < RATE; k++) {
        if (places[k] == NONE) { continue; }
        lists[follower_slot(first_follower + places[k])] = lists[ray_slot(first + k * SORTED)];
    }
    if (lane >= placed) { return NONE; }
    // Rays that are traced first fill the list of the others from its end: both together are all rays.
    if (MAPPED) { lists[follower_slot(rays - 1u - (first_leader + lane))] = leaders[lane]; }
    return leaders[lane];
}

@compute @workgroup_size(RAYS_PER_GROUP)
fn main(@builtin(workgroup_id) group: vec3u, @builtin(num_workgroups) groups: vec3u, @builtin(local_invocation_index) lane: u32) {
    let leader = sorted_leader(group.y * groups.x + group.x, lane);
    if (leader == NONE) { return; }
    let pixel = unpack_pixel(leader);
    let first = load_surface(pixel);
    if (!MAPPED) { free_start_m = free_m(textureLoad(cause, pixel, 0).x); }
    let ray = reflected_ray(pixel, first);
    var light = vec4f(0.0);
    if (carries_light(ray)) { light = mirrored_light(pixel, first, ray, ray_origin(first.position, first.geometric_normal)); }
    textureStore(reflection, pixel, stored(light));
    store_hit(pixel, first_hit);
    store_work(pixel, map_steps);
    // Kept for the followers. The number of textures that a stage may write leaves none for the cause of these pixels:
    // the upsample pass writes it.
    textureStore(lead_hit, pixel, vec4u(first_hit.xyz, first_cause));
}
