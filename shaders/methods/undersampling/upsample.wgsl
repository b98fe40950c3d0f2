// Upsample: gives pixels the hits of the rays around them where these agree (Kim et al. 2016), and lists the others for
// tracing. The geometry of the hit is taken over, not its color: each ray is intersected with the surface that its
// neighbors hit, and the point is shaded.

#import cause_stored
#import gbuffer
#import leaders
#import id_intersection
#import mirror_hit
#import mirrored
#import radiance
#import upsample_params
#import work

@group(2) @binding(6) var reflection: RadianceTexture;
@group(2) @binding(11) var lead_hit: texture_2d<u32>;
@group(2) @binding(12) var<uniform> params: Params;

const PATHS: u32 = HIT_PATHS;

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
        let found = textureLoad(lead_hit, leader, 0);
        if (found.y == NOT_LED || (count > 0u && found.y != around.instance)) { return around; }
        if (!mirrors_alike(s, leader)) { return around; }
        around.instance = found.y;
        around.triangles[k] = found.z;
        around.cause = max(around.cause, found.w); // causes of maps are the largest
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

// Whether the reflection of a pixel follows from the reflections around it; it is written then.
fn follow_neighbors(pixel: vec2u) -> bool {
    if (is_leader(pixel)) { return false; }
    let first = load_surface(pixel);
    let roughness = reflected_roughness(first);
    if (roughness * roughness > SMOOTH_ALPHA || is_transmissive(first) || has_traced_coat(first)) { return false; }
    let ray = reflected_ray(pixel, first);
    if (!carries_light(ray)) { return false; }
    let around = hits_around(pixel, first);
    if (!around.is_agreed) { return false; }
    let origin = ray_origin(first.position, first.geometric_normal);
    if (around.instance == NONE) {
        keep_cause(pixel, around.cause);
        store_hit(pixel, vec4u(0u, NONE, NONE, 0u));
        textureStore(reflection, pixel, stored(vec4f(seen_at_end(origin, ray, NONE, FAR_M).radiance, 1.0)));
        return true;
    }
    let met = meet_around(around, origin, ray.direction);
    if (met.distance_m < 0.0 || met.distance_m > frame.ray_length_m) { return false; }
    let id = vec2u(around.instance, met.triangle);
    let cone = continued(mirrored_cone(pixel_cone(distance(first.position, frame.eye)), first.curvature), met.distance_m);
    if (goes_on(surface_at(id.x, id.y, met.bary, ray.direction, cone.width_m))) { return false; } // shading looks it up again
    keep_cause(pixel, around.cause);
    is_known = true;
    known_hit = Hit(met.distance_m, id.x, id.y, met.bary, 0u);
    textureStore(reflection, pixel, stored(mirrored_light(pixel, first, ray, origin)));
    store_hit(pixel, vec4u(bitcast<u32>(met.distance_m), id, 0u));
    return true;
}

var<workgroup> rest_count: atomic<u32>;
var<workgroup> first_rest: u32;

@compute @workgroup_size(RAYS_PER_GROUP)
fn main(@builtin(workgroup_id) group: vec3u, @builtin(num_workgroups) groups: vec3u, @builtin(local_invocation_index) lane: u32) {
    let index = (group.y * groups.x + group.x) * RAYS_PER_GROUP + lane;
    var pixel = vec2u(NONE);
    var place = NONE;
    if (index < atomicLoad(&counters[FOLLOWER_COUNTER])) {
        pixel = unpack_pixel(lists[follower_slot(index)]);
        if (!follow_neighbors(pixel)) { place = atomicAdd(&rest_count, 1u); }
    } else if (MAPPED && index < atomicLoad(&counters[RAY_COUNTER])) {
        let leader = unpack_pixel(lists[follower_slot(index)]);
        keep_cause(leader, textureLoad(lead_hit, leader, 0).w);
    }
    workgroupBarrier();
    if (lane == 0u) { first_rest = atomicAdd(&counters[REST_COUNTER], atomicLoad(&rest_count)); }
    workgroupBarrier();
    // The list of rays is free: all of it was sorted.
    if (place != NONE) { lists[ray_slot(first_rest + place)] = pack_pixel(pixel); }
    if (pixel.x != NONE) { store_work(pixel, 0u); }
}
