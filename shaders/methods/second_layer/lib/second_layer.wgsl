// The second depth layer: for each pixel the nearest surface at least `separation_m` behind the first (Mara et al.
// 2016, "Deep G-Buffers for Stable Global Illumination Approximation"), from whichever side it is seen, so that rays
// behind a thing can be shown to pass it or to meet its far side.
//
// A ray that went behind the first layer is free while it is farther behind it than the separation, within which
// nothing is stored, and in front of the second.

#import crossing
#import gbuffer
#import lists
#import id_intersection
#import pixel_walk
#import tangent_plane

@group(2) @binding(11) var second_depth: texture_depth_2d; // clip-space z; 0: none
@group(2) @binding(12) var second_ids: texture_2d<u32>;

override HAS_SECOND_LAYER: bool = true;
// Number of pixels by which a ray must be behind a surface, as it slopes there, so that it is not the ray's own
// crossing of that surface which the pixels' centers do not show.
const SLOPE_PX: f32 = 1.0;
const LEAST_COSINE: f32 = 0.2; // of a slope that is taken into account, against the view

// Number of rays of the workgroup that went behind the first layer.
var<workgroup> group_behind: atomic<u32>;

// Clip-space z from which on a ray is behind the first layer of a pixel. By the paper's rule a thing has the thickness
// T for a ray that went behind another.
fn behind_z(pixel: vec2u, first_z: f32, is_start: bool) -> f32 {
    let first_m = depth_of(first_z);
    if (!VERIFY && !is_start) { return screen_z(first_m + params.threshold_m); }
    let ray = pixel_ray(vec2f(pixel) + 0.5);
    let normal = unpack_geometric_normal(textureLoad(surface, pixel, 0));
    let cosine = max(abs(dot(normal, ray)) / length(ray), LEAST_COSINE);
    return screen_z(first_m + params.separation_m + SLOPE_PX * pixel_width(first_m) / cosine);
}

// Whether a ray meets a triangle, or a capsule, from a side that it can be met from.
fn is_met_in_front(id: vec2u, normal: vec3f, direction: vec3f) -> bool {
    let outward = select(normal, -normal, (instance_flags(id.x) & FLAG_MIRRORED) != 0u);
    return dot(outward, direction) < 0.0 || (instance_trace_flags(id.x) & DOUBLE_SIDED) != 0u;
}

// The hit in the second layer, refused where its surface mirrors or transmits, for that shows what is not known.
fn shown_there(found: March, direction: vec3f) -> March {
    var m = found;
    if (goes_on(surface_at(m.id.x, m.id.y, m.bary, direction, pixel_width(m.distance_m)))) { m.cause = CAUSE_REFLECTOR; }
    return m;
}

// Whether the ray meets a triangle that a pixel names, in a part of it; CAUSE_UNCONFIRMED where not.
fn meet_beside(id: vec2u, origin: vec3f, direction: vec3f, over_m: vec2f) -> March {
    if (id.x == NONE || is_capsule(id.x) || is_unreflected(id.x)) { return ended(CAUSE_UNCONFIRMED); }
    let t = triangle_of(id, origin);
    let at = meet(t, direction);
    let is_met = is_inside(at.yz) && at.x >= over_m.x && at.x <= over_m.y;
    if (!is_met || !is_met_in_front(id, t.normal, direction)) { return ended(CAUSE_UNCONFIRMED); }
    return March(CAUSE_HIT_BEHIND, at.x, id, clamped(at.yz));
}

// Whether the ray meets a triangle that the pixels around one name in the first layer, up to a distance: it then grazes
// the outline of a thing, where the pixels' centers do not show that it ends there.
fn grazes_first(pixel: vec2u, origin: vec3f, direction: vec3f, most_m: f32) -> bool {
    for (var k = 0u; k < 9u; k++) {
        let beside = vec2i(pixel) + vec2i(i32(k % 3u), i32(k / 3u)) - 1;
        let id = textureLoad(ids, clamp(beside, vec2i(0), vec2i(frame.size) - 1), 0).xy;
        if (meet_beside(id, origin, direction, vec2f(0.0, most_m)).cause == CAUSE_HIT_BEHIND) { return true; }
    }
    return false;
}

// Whether a crossing of the second layer is accepted: only where the ray is shown to meet the triangle that the pixel
// names there, or one that the pixels around the point name in either layer. CAUSE_NOT_REFLECTIVE: the ray is still in
// front of the surface when it leaves the pixel.
fn accept_behind(r: ScreenRay, c: Candidate, origin: vec3f, direction: vec3f) -> March {
    let slack = params.edge_px / max(max(abs(r.delta.x), abs(r.delta.y)), 1e-3);
    let over_m = vec2f(distance_at(r, max(c.low - slack, 0.0)), distance_at(r, c.high + slack));
    let id = textureLoad(second_ids, c.pixel, 0).xy;
    let at = meet_named(id, origin, direction);
    var m = March(CAUSE_HIT_BEHIND, at.x, id, at.yz);
    if (at.x > over_m.y) { return ended(CAUSE_NOT_REFLECTIVE); }
    if (at.x < over_m.x) { return ended(CAUSE_HIDDEN); }
    if (is_capsule(id.x)) { return shown_there(m, direction); }
    m.bary = clamped(at.yz);
    if (!is_met_in_front(id, triangle_of(id, origin).normal, direction)) { return ended(CAUSE_BACK_FACE); }
    if (is_inside(at.yz)) { return shown_there(m, direction); }
    let place = (r.start + r.delta * place_of(r, at.x)).xy;
    let corner = vec2u(clamp(floor(place - 0.5), vec2f(0.0), frame.size - 1.0));
    for (var k = 0u; k < 8u; k++) {
        let pixel = min(corner + vec2u(k & 1u, (k >> 1u) & 1u), vec2u(frame.size) - 1u);
        var other = textureLoad(ids, pixel, 0).xy;
        if (k < 4u) { other = textureLoad(second_ids, pixel, 0).xy; }
        if (all(other == id)) { continue; }
        let beside = meet_beside(other, origin, direction, over_m);
        if (beside.cause == CAUSE_HIT_BEHIND) { return shown_there(beside, direction); }
    }
    return ended(CAUSE_UNCONFIRMED);
}

// Whether a crossing of the second layer is accepted by the paper's rule, as accept_by_threshold does in the first.
fn accept_behind_by_threshold(r: ScreenRay, c: Candidate, second_z: f32, origin: vec3f, direction: vec3f) -> March {
    let id = textureLoad(second_ids, c.pixel, 0).xy;
    let center = vec2f(c.pixel) + 0.5;
    let depth_m = depth_of(second_z);
    let at = meet_named(id, pixel_origin(center), pixel_ray(center));
    var m = March(CAUSE_HIT_BEHIND, dot(position_at(c.pixel, depth_m) - origin, direction), id, at.yz);
    var is_met = true;
    if (!is_capsule(id.x)) {
        m.bary = clamped(at.yz);
        is_met = is_met_in_front(id, triangle_of(id, origin).normal, direction);
    }
    if (depth_of(r.start.z + r.delta.z * c.low) - depth_m > params.threshold_m) { return ended(CAUSE_HIDDEN); }
    if (!is_met) { return ended(CAUSE_BACK_FACE); }
    return shown_there(m, direction);
}

// Marches a ray that went behind the first layer at a pixel, pixel by pixel. The march that it returns ended, but for
// CAUSE_NOT_REFLECTIVE: the ray comes out in front of the first layer there.
fn march_behind(r: ScreenRay, heading: Heading, plane: TangentPlane, at: Candidate, steps: u32, origin: vec3f, direction: vec3f) -> Behind {
    let nearest = pyramid();
    var b = Behind(ended(CAUSE_HIDDEN), vec2i(at.pixel), at.low, steps);
    if (VERIFY && grazes_first(at.pixel, origin, direction, distance_at(r, at.high))) { return b; }
    let around_s = 1.0 / max(max(abs(r.delta.x), abs(r.delta.y)), 1e-3); // of a pixel
    var passed_z = 0.0; // clip-space z behind which the ray has passed the last pixel
    while (b.steps < params.steps) {
        if (b.s >= r.end || any(vec2u(b.pixel) >= vec2u(frame.size))) {
            b.march.cause = select(CAUSE_NONE, CAUSE_OFF_SCREEN, r.leaves);
            return b;
        }
        b.steps++;
        let pixel = vec2u(b.pixel);
        let exits = exits_of(heading, b.pixel, b.pixel + 1);
        let exit = clamp(min(exits.x, exits.y), b.s, r.end);
        let enters_z = r.start.z + r.delta.z * b.s;
        let leaves_z = r.start.z + r.delta.z * exit;
        let first_z = abs(bitcast<f32>(lists[pyramid_slot(nearest, pixel, 0u)]));
        let is_start = all(pixel == at.pixel);
        if (enters_z > first_z && !is_start) {
            let is_clear = !VERIFY || r.start.z + r.delta.z * (b.s + around_s) < passed_z;
            if (is_clear) { b.march.cause = CAUSE_NOT_REFLECTIVE; }
            return b;
        }
        // Behind the thing too where it may reach into the pixel before, whose center does not show it.
        let before_z = r.start.z + r.delta.z * select(b.s, b.s - around_s, is_start && VERIFY);
        passed_z = behind_z(pixel, first_z, is_start);
        if (max(before_z, leaves_z) >= passed_z) {
            // By the paper's rule, a thing of thickness T is met there.
            if (!VERIFY && !is_start) { b.march.cause = CAUSE_NOT_REFLECTIVE; }
            return b;
        }
        let second_z = textureLoad(second_depth, pixel, 0);
        if (min(enters_z, leaves_z) <= second_z && is_above(plane, b.pixel, second_z)) {
            let c = Candidate(pixel, b.s, exit);
            if (VERIFY) {
                b.march = accept_behind(r, c, origin, direction);
            } else {
                b.march = accept_behind_by_threshold(r, c, second_z, origin, direction);
            }
            if (b.march.cause != CAUSE_NOT_REFLECTIVE) { return b; }
            b.march = ended(CAUSE_HIDDEN);
        }
        b.pixel = pixel_past(heading, b.pixel, b.pixel + 1, exits, b.pixel);
        b.s = exit;
    }
    b.march.cause = CAUSE_STEPS;
    return b;
}
