// Upsample: lists pixels with the hits of the rays around them where these agree (Kim et al. 2016), as hits of the march
// are, and the others for tracing. The geometry of the hit is taken over, not its color: each ray is intersected with the
// surface that its neighbors hit.

#import cause_stored
#import cone
#import gbuffer
#import leaders
#import id_intersection
#import mirror_hit
#import surface
#import shade
#import upsample_params

@group(2) @binding(12) var<uniform> params: Params;

// Hits around a pixel, which are of one instance.
struct Around {
    is_agreed: bool,
    instance: u32, // NONE: nothing was hit
    distance_m: f32, // mean
    triangles: array<u32, 4>,
    cause: u32, // how these rays ended in a map, if one did
}

// Whether the surfaces of two pixels mirror almost alike: they are in one plane, with similar normals and curvatures.
fn mirrors_alike(s: Surface, other: vec2u) -> bool {
    let beside = load_surface(other);
    let footprint_m = pixel_width(distance(s.position, frame.eye));
    if (abs(dot(beside.position - s.position, s.geometric_normal)) > SAME_PLANE_PX * footprint_m) { return false; }
    let turn = length(s.normal - beside.normal);
    let bend = abs(s.curvature - beside.curvature) * footprint_m;
    return max(turn, bend) <= max(params.similarity, 1e-6);
}

fn hits_around(pixel: vec2u, s: Surface) -> Around {
    var around = Around(false, NONE, 0.0, array<u32, 4>(NONE, NONE, NONE, NONE), 0u);
    var count = 0u;
    for (var k = 0u; k < 4u; k++) {
        let place = vec2i(pixel) + leader_offset(pixel, k);
        if (any(place < vec2i(0)) || any(place >= vec2i(frame.size))) { continue; }
        let leader = vec2u(place);
        let ended = textureLoad(written_cause, leader).x & CAUSE_MASK;
        let found = stored_hit(leader);
        // Traced rays alone lead; hits of the march have barycentrics.
        if (!reflects(ended) || found.w != NONE || (count > 0u && found.y != around.instance)) { return around; }
        if (!mirrors_alike(s, leader)) { return around; }
        around.instance = found.y;
        around.triangles[k] = found.z;
        around.cause = max(around.cause, select(ended, CAUSE_UNMARCHED, is_traced(ended))); // causes of maps are the largest
        around.distance_m += bitcast<f32>(found.x);
        count++;
    }
    around.distance_m /= f32(max(count, 1u));
    around.is_agreed = count > 1u;
    return around;
}

struct Met {
    distance_m: f32, // negative: none
    triangle: u32,
    bary: vec2f,
}

// Where the ray meets what its neighbors hit: a triangle of theirs, or the plane of one beside it. None where the
// planes of their triangles meet the ray at distances that are not similar.
fn meet_around(around: Around, origin: vec3f, direction: vec3f) -> Met {
    let none = Met(-1.0, NONE, vec2f(0.0));
    var best = none;
    var is_within = false;
    var nearest_m = FAR_M;
    var farthest_m = 0.0;
    for (var k = 0u; k < 4u; k++) {
        let id = vec2u(around.instance, around.triangles[k]);
        if (id.y == NONE) { continue; }
        let at = meet_named(id, origin, direction);
        if (at.x <= 0.0) { return none; }
        nearest_m = min(nearest_m, at.x);
        farthest_m = max(farthest_m, at.x);
        let is_round = is_capsule(id.x);
        if (!is_within || (is_inside(at.yz) && at.x < best.distance_m)) {
            best = Met(at.x, id.y, select(clamped(at.yz), at.yz, is_round));
            is_within = is_round || is_inside(at.yz);
        }
    }
    if (farthest_m - nearest_m > max(params.similarity, 1e-5) * farthest_m) { return none; }
    if (!is_within && abs(best.distance_m - around.distance_m) > params.similarity * farthest_m) { return none; }
    return best;
}

// Whether the hit of a pixel's ray follows from the hits around it; it is written then.
fn follows_neighbors(pixel: vec2u) -> bool {
    let first = load_surface(pixel);
    let roughness = reflected_roughness(first);
    if (roughness * roughness > SMOOTH_ALPHA || is_transmissive(first) || has_traced_coat(first)) { return false; }
    let ray = reflected_ray(pixel, first);
    if (!carries_light(ray)) { return false; }
    let around = hits_around(pixel, first);
    if (!around.is_agreed) { return false; }
    var hit = vec4u(0u, NONE, NONE, 0u);
    if (around.instance != NONE) {
        let met = meet_around(around, ray_origin(first.position, first.geometric_normal), ray.direction);
        if (met.distance_m < 0.0 || met.distance_m > frame.ray_length_m) { return false; }
        let cone = continued(mirrored_cone(pixel_cone(distance(first.position, frame.eye)), first.curvature), met.distance_m);
        // Paths end at known hits.
        if (goes_on(surface_at(around.instance, met.triangle, met.bary, ray.direction, cone.width_m))) { return false; }
        hit = vec4u(bitcast<u32>(met.distance_m), around.instance, met.triangle, pack2x16unorm(met.bary));
    }
    keep_cause(pixel, around.cause);
    store_hit(pixel, hit);
    return true;
}

var<workgroup> known_count: atomic<u32>;
var<workgroup> rest_count: atomic<u32>;
var<workgroup> first_known: u32;
var<workgroup> first_rest: u32;

@compute @workgroup_size(RAYS_PER_GROUP)
fn main(@builtin(workgroup_id) group: vec3u, @builtin(num_workgroups) groups: vec3u, @builtin(local_invocation_index) lane: u32) {
    let index = (group.y * groups.x + group.x) * RAYS_PER_GROUP + lane;
    let is_listed = index < atomicLoad(&counters[FOLLOWER_COUNTER]);
    var bits = NONE;
    var place = 0u;
    var is_followed = false;
    if (is_listed) {
        bits = lists[follower_slot(index)];
        is_followed = follows_neighbors(unpack_pixel(bits));
        if (is_followed) { place = atomicAdd(&known_count, 1u); } else { place = atomicAdd(&rest_count, 1u); }
    }
    workgroupBarrier();
    if (lane == 0u) {
        first_known = atomicAdd(&counters[HIT_COUNTER], atomicLoad(&known_count));
        first_rest = atomicAdd(&counters[REST_COUNTER], atomicLoad(&rest_count));
    }
    workgroupBarrier();
    // The list of rays is free: all of it was split.
    if (is_listed) { lists[select(ray_slot(first_rest + place), hit_slot(first_known + place), is_followed)] = bits; }
}
