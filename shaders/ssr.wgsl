// Screen-space reflections: marches the mirror rays of the listed pixels through the depth pyramid, cell
// by cell, so that no pixel under a ray is skipped, and decides what they hit. Hits are listed for
// shading; rays that the screen cannot answer are listed for tracing.

#import cause
#import crossing
#import gbuffer
#import lists
#import id_intersection
#import mirror_hit
#import pixel_walk
#import radiance
#import screen_ray
#import second_layer
#import shown
#import ssr_params
#import tangent_plane

override VERIFY: bool = true; // false: accept crossings by the paper's threshold T
override TRACE: bool = true; // false: method ssr, rays without a screen hit stay black
override REFUSE: bool = true; // false: accept every crossing, to measure what refusing gains

@group(2) @binding(0) var ids: texture_2d<u32>;
@group(2) @binding(6) var reflection: RadianceTexture;
@group(2) @binding(7) var cause: texture_storage_2d<r32uint, write>;
@group(2) @binding(9) var<uniform> params: Params;
@group(2) @binding(10) var counts: texture_storage_2d<rgba32uint, write>; // with COUNT

// Minimum relative difference of the depths of two surfaces over a pixel, beyond rounding.
const CULLED_SLACK: f32 = 1e-6;
const START_PX: f32 = 0.7; // start of the march, past the reflector's own pixel
// Minimum bilinear weight of the pixels around a hit that must show its surface.
const SUPPORT: f32 = 0.75;

// Number of cells visited since the invocation started, with COUNT.
var<private> march_steps: u32 = 0u;

// Whether a surface that the camera culls, or a cut-out beside a pixel, is in front of the visible surface of the pixel.
fn has_culled(pixel: vec2u) -> bool {
    if (!HAS_CULLED && !HAS_CUTOUT) { return false; }
    let nearest = abs(bitcast<f32>(lists[pyramid_slot(pyramid(), pixel, 0u)]));
    return nearest > screen_z(textureLoad(view_depth, pixel, 0).x) * (1.0 + CULLED_SLACK);
}

// Whether reflection rays ignore the instance that a pixel shows.
fn is_unreflected(instance: u32) -> bool {
    return HAS_UNSHOWN && is_passed(instance_trace_flags(instance), UNREFLECTED);
}

// Whether a crossing is accepted as a screen-space hit, by the paper's rule: at most T behind the stored
// depth (a thickness, elsewhere).
fn accept_by_threshold(r: ScreenRay, c: Candidate, origin: vec3f, direction: vec3f) -> March {
    let met = load_surface(c.pixel);
    let id = textureLoad(ids, c.pixel, 0).xy;
    let center = vec2f(c.pixel) + 0.5;
    let at = meet_named(id, pixel_origin(center), pixel_ray(center));
    var m = March(CAUSE_HIT, dot(met.position - origin, direction), id, at.yz);
    if (!is_capsule(id.x)) { m.bary = clamped(at.yz); }
    let ray_m = depth_of(r.start.z + r.delta.z * c.low);
    if (ray_m - dot(met.position - frame.eye, frame.forward) > params.threshold_m) {
        m.cause = CAUSE_HIDDEN;
    } else if (dot(met.geometric_normal, direction) >= 0.0) {
        m.cause = CAUSE_BACK_FACE;
    } else if (goes_on(met)) {
        m.cause = CAUSE_REFLECTOR;
    }
    return m;
}

// Cause of a ray that meets the surface of a pixel, or its plane, at a distance; `over_m`: distances between which the
// ray is over the pixel, past which it is still in front of the surface.
fn cause_at(distance_m: f32, over_m: vec2f, met: Surface) -> u32 {
    if (distance_m > over_m.y) { return CAUSE_NOT_REFLECTIVE; }
    if (distance_m < over_m.x) { return CAUSE_HIDDEN; }
    return select(CAUSE_HIT, CAUSE_REFLECTOR, goes_on(met));
}

// Whether a crossing is accepted as a screen-space hit: only where the ray is shown to meet the triangle that the
// pixel names, one that the pixels around the point name, or the plane that they have in common.
// CAUSE_NOT_REFLECTIVE: the ray is still in front of the surface when it leaves the pixel, and the march goes on.
fn accept_verified(r: ScreenRay, c: Candidate, origin: vec3f, direction: vec3f) -> March {
    let slack = params.edge_px / max(max(abs(r.delta.x), abs(r.delta.y)), 1e-3);
    let over_m = vec2f(distance_at(r, max(c.low - slack, 0.0)), distance_at(r, c.high + slack));
    let met = load_surface(c.pixel);
    let id = textureLoad(ids, c.pixel, 0).xy;
    if (is_capsule(id.x)) {
        // Only over this pixel: the surface bends away behind it, so that no neighbor can confirm a miss.
        let at = meet_named(id, origin, direction);
        return March(cause_at(at.x, over_m, met), at.x, id, at.yz);
    }
    let t = triangle_of(id, origin);
    let at = meet(t, direction);
    var m = March(cause_at(at.x, over_m, met), at.x, id, clamped(at.yz));
    // A ray that leaves along the plane's normal can only meet its back face.
    if (dot(met.geometric_normal, direction) >= 0.0) {
        m.cause = select(CAUSE_HIDDEN, CAUSE_BACK_FACE, at.x >= over_m.x && at.x <= over_m.y);
    }
    if (m.cause != CAUSE_HIT || is_inside(at.yz)) { return m; }
    let place = r.start + r.delta * place_of(r, at.x);
    let corner = clamp(floor(place.xy - 0.5), vec2f(0.0), frame.size - 1.0);
    let part = clamp(place.xy - 0.5 - corner, vec2f(0.0), vec2f(1.0));
    let normal = normalize(t.normal);
    var support = 0.0;
    for (var k = 0u; k < 4u; k++) {
        let step = vec2u(k & 1u, k >> 1u);
        let pixel = min(vec2u(corner) + step, vec2u(frame.size) - 1u);
        let sides = select(vec2f(1.0) - part, part, step == vec2u(1u));
        let other = textureLoad(ids, pixel, 0).xy;
        if (other.x == NONE || is_unreflected(other.x)) { continue; }
        if (all(other == id)) {
            support += sides.x * sides.y;
            continue;
        }
        let beside = meet(triangle_of(other, origin), direction);
        let neighbor = load_surface(pixel);
        if (is_inside(beside.yz) && beside.x >= over_m.x && beside.x <= over_m.y
            && dot(neighbor.geometric_normal, direction) < 0.0 && !goes_on(neighbor)) {
            return March(CAUSE_HIT, beside.x, other, beside.yz);
        }
        let footprint = pixel_width(dot(neighbor.position - frame.eye, frame.forward));
        if (abs(dot(neighbor.position - origin - t.corner, normal)) < SAME_PLANE_PX * footprint) {
            support += sides.x * sides.y;
        }
    }
    // Gap between small triangles: the point may lie at most `edge_px` footprints from the triangle that the pixel
    // names.
    let gap = t.edge1 * (at.y - m.bary.x) + t.edge2 * (at.z - m.bary.y);
    let footprint = pixel_width(dot(met.position - frame.eye, frame.forward));
    let is_near = length(gap) < params.edge_px * footprint;
    if (support < SUPPORT || !is_near) { m.cause = CAUSE_UNCONFIRMED; }
    return m;
}

fn march(s0: Surface, direction: vec3f) -> March {
    if (frame.has_edge_on != 0u) { return ended(CAUSE_EDGE_ON); }
    let origin = ray_origin(s0.position, s0.geometric_normal);
    let r = screen_ray(origin, direction);
    let length_px = max(max(abs(r.delta.x), abs(r.delta.y)), 1e-3);
    let heading = heading_of(r);
    let plane = tangent_plane(s0);
    let recedes = r.delta.z < 0.0;
    let inverse_z = select(0.0, 1.0 / select(1.0, r.delta.z, recedes), recedes);
    let nearest = pyramid();
    let size = vec2u(frame.size);

    var s = min(START_PX / length_px, r.end); // the ray is free of hits up to s
    // Exception: a ray that leads back to an orthographic camera meets culled triangles on its way.
    if (s >= r.end && has_culled(vec2u(clamp(r.start.xy, vec2f(0.0), frame.size - 1.0)))) { s = 0.0; }
    var pixel = clamp(vec2i(floor(r.start.xy + r.delta.xy * s)), vec2i(0), vec2i(frame.size) - 1);
    var level = 0u;
    var climbs = true; // at each step until the first cell that is not free, then only out of the parent cell
    var steps = 0u;
    var m = ended(CAUSE_STEPS);
    var last: Candidate;
    var behind_s = r.end; // s at which the ray first goes behind the first layer
    // Maximum number of pixels at which a ray is tested against the surface shown, and goes on in front of it or behind
    // it.
    let most_candidates = select(8u, 32u, HAS_SECOND_LAYER);
    for (var candidate = 0u; candidate < most_candidates; candidate++) {
        var exit = s;
        var is_met = false;
        // This loop does nothing but walk: rays that stop at different steps are then tested together.
        while (steps < params.steps && s < r.end && all(vec2u(pixel) < size)) {
            steps++;
            let cell = pixel >> vec2u(level);
            let first = cell << vec2u(level);
            let next = (cell + 1) << vec2u(level);
            let exits = exits_of(heading, first, next);
            exit = clamp(min(exits.x, exits.y), s, r.end);
            let stored = abs(bitcast<f32>(lists[pyramid_slot(nearest, vec2u(cell), level)]));
            let deepest = r.start.z + r.delta.z * select(s, exit, recedes);
            let is_free = deepest > stored || (level == 0u && !is_above(plane, pixel, stored));
            is_met = !is_free && level == 0u;
            if (is_met) { break; }
            // A ray that recedes is free up to where it is as deep as the cell's nearest surface.
            let free_s = select(clamp((stored - r.start.z) * inverse_z, s, exit), exit, is_free);
            // Clamping keeps rounding from skipping a pixel.
            let last_free = clamp(vec2i(floor(r.start.xy + r.delta.xy * free_s)), first, next - 1);
            let along = select(pixel, last_free, free_s > s);
            let onward = select(along, pixel_past(heading, first, next, exits, along), is_free);
            climbs = climbs && is_free;
            let leaves_parent = any((onward >> vec2u(level + 1u)) != (pixel >> vec2u(level + 1u)));
            let above = select(level, min(level + 1u, PYRAMID_LEVELS), climbs || leaves_parent);
            level = select(level - 1u, above, is_free);
            pixel = onward;
            s = free_s;
        }
        m.cause = CAUSE_STEPS;
        if (!is_met) {
            if (s >= r.end || any(vec2u(pixel) >= size)) { m.cause = select(CAUSE_NONE, CAUSE_OFF_SCREEN, r.leaves); }
            break;
        }
        let c = Candidate(vec2u(pixel), s, exit);
        last = c;
        if (has_culled(c.pixel) || is_unreflected(textureLoad(ids, c.pixel, 0).x)) {
            m.cause = select(CAUSE_HIDDEN, CAUSE_UNCONFIRMED, HAS_SECOND_LAYER && HAS_CUTOUT); // the second layer lacks what is beside
        } else if (VERIFY) {
            m = accept_verified(r, c, origin, direction);
        } else {
            m = accept_by_threshold(r, c, origin, direction);
        }
        if (HAS_SECOND_LAYER && REFUSE && m.cause == CAUSE_HIDDEN) {
            if (behind_s == r.end) { atomicAdd(&group_behind, 1u); }
            behind_s = min(behind_s, c.low);
            let behind = march_behind(r, heading, plane, c, steps, origin, direction);
            steps = behind.steps;
            pixel = behind.pixel;
            s = behind.s;
            m = behind.march;
            if (m.cause == CAUSE_NOT_REFLECTIVE) { continue; }
        }
        if (m.cause != CAUSE_NOT_REFLECTIVE) { break; }
        // The ray was in front of the surface over all of this pixel: go on after it.
        pixel = pixel_past(heading, pixel, pixel + 1, exits_of(heading, pixel, pixel + 1), pixel);
        s = c.high;
        m.cause = CAUSE_STEPS;
    }
    if (COUNT) { march_steps = steps; }
    if (m.cause == CAUSE_NOT_REFLECTIVE) { m.cause = CAUSE_STEPS; }
    // Cut-outs are opaque at the pixel's center, but perhaps not where the ray meets them.
    if (VERIFY && is_screen_hit(m.cause) && is_cutout(m.id.x) && !alpha_passes(m.id.x, m.id.y, m.bary)) { m.cause = CAUSE_UNCONFIRMED; }
    // Whether the ray crossed a surface that was not accepted as its hit.
    let is_refused = m.cause == CAUSE_HIDDEN || m.cause == CAUSE_UNCONFIRMED || m.cause == CAUSE_BACK_FACE || m.cause == CAUSE_REFLECTOR;
    if (!REFUSE && is_refused) {
        m.cause = CAUSE_HIT;
        m.distance_m = dot(load_surface(last.pixel).position - origin, direction);
    }
    if (is_screen_hit(m.cause)) { return m; }
    m.distance_m = 0.0;
    // A ray that is traced starts before all that it went behind: its answer does not depend on surfaces in no layer.
    let free_s = select(s, min(s, behind_s), HAS_SECOND_LAYER);
    if (m.cause == CAUSE_OFF_SCREEN || m.cause == CAUSE_STEPS) { m.distance_m = distance_at(r, free_s) * 0.999; }
    return m;
}

var<workgroup> group_causes: array<atomic<u32>, CAUSES>;
var<workgroup> group_hits: atomic<u32>;
var<workgroup> group_rays: atomic<u32>;
var<workgroup> first_hit: u32;
var<workgroup> first_refused: u32;

// Marches the ray of a pixel and writes what is known of its reflection.
fn reflect_pixel(pixel: vec2u) -> u32 {
    let s = load_surface(pixel);
    let ray = reflected_ray(pixel, s);
    var m = ended(CAUSE_NONE);
    let is_lit = carries_light(ray);
    if (is_lit) { m = march(s, ray.direction); }
    let is_hit = is_screen_hit(m.cause);
    var found = vec4u(0u, NONE, NONE, 0u);
    if (is_hit) { found = vec4u(bitcast<u32>(m.distance_m), m.id, pack2x16unorm(m.bary)); }
    store_hit(pixel, found);
    textureStore(cause, pixel, vec4u(m.cause | (bitcast<u32>(select(m.distance_m, 0.0, is_hit)) & ~CAUSE_MASK), 0u, 0u, 0u));
    if (!HAS_FOG && m.cause == CAUSE_NONE) {
        let seen = smoothable(s, ray, seen_at_end(s.position, ray, NONE, FAR_M).radiance);
        textureStore(reflection, pixel, stored(select(vec4f(0.0), seen, is_lit)));
    } else if (!TRACE && !is_hit) {
        textureStore(reflection, pixel, vec4f(0.0, 0.0, 0.0, 1.0));
    }
    return m.cause;
}

@compute @workgroup_size(RAYS_PER_GROUP)
fn main(@builtin(workgroup_id) group: vec3u, @builtin(num_workgroups) groups: vec3u, @builtin(local_invocation_index) lane: u32) {
    let index = (group.y * groups.x + group.x) * RAYS_PER_GROUP + lane;
    var pixel = vec2u(NONE);
    var place = 0u;
    var is_hit = false;
    var is_ray = false;
    if (index < atomicLoad(&counters[REFLECTOR_COUNTER])) {
        pixel = unpack_pixel(lists[reflector_slot(index)]);
        let why = reflect_pixel(pixel);
        is_hit = is_screen_hit(why) || (HAS_FOG && why == CAUSE_NONE);
        is_ray = TRACE && is_traced(why);
        atomicAdd(&group_causes[why], 1u);
        if (is_hit) { place = atomicAdd(&group_hits, 1u); }
        if (is_ray) { place = atomicAdd(&group_rays, 1u); }
    }
    workgroupBarrier();
    if (lane == 0u) {
        first_hit = atomicAdd(&counters[HIT_COUNTER], atomicLoad(&group_hits));
        first_refused = atomicAdd(&counters[RAY_COUNTER], atomicLoad(&group_rays));
        if (HAS_SECOND_LAYER) { atomicAdd(&counters[BEHIND_COUNTER], atomicLoad(&group_behind)); }
    }
    if (lane < CAUSES) {
        let n = atomicLoad(&group_causes[lane]);
        if (n > 0u) { atomicAdd(&counters[lane], n); }
    }
    workgroupBarrier();
    if (is_hit) { lists[hit_slot(first_hit + place)] = pack_pixel(pixel); }
    if (is_ray) { lists[refused_slot(first_refused + place)] = pack_pixel(pixel); }
    if (COUNT && pixel.x != NONE) { textureStore(counts, pixel, vec4u(march_steps, 0u, 0u, march_triangles)); }
}
