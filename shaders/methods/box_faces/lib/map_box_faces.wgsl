// Variant of method ssr+box: rays march through the depths that the six faces of a box see (Johnsson), with the ids of
// the surfaces there, and are tested against the triangles that the ids name.

#import bvh
#import constants
#import face_box
#import mapped
#import id_intersection

@group(2) @binding(24) var face_hits: texture_2d_array<u32>; // depth, instance, triangle, place; a layer for a face

// Depth where a face sees nothing.
const NOTHING: f32 = 1e9;
// Maximum difference of the depths of pixels, over the width of one, between which a surface is taken to go on.
const SAME_SURFACE: f32 = 4.0;

fn face_pixel(place: vec2f) -> vec2u {
    let size = f32(textureDimensions(face_hits).x);
    return vec2u(clamp(place * size, vec2f(0.0), vec2f(size - 1.0)));
}

fn depth_at(face: u32, pixel: vec2u) -> f32 {
    let hit = textureLoad(face_hits, pixel, face, 0).xy;
    return select(bitcast<f32>(hit.x), NOTHING, hit.y == NONE);
}

// Depth that a face sees at a place: between pixels of one surface, which planes are exact on.
fn depth_seen(face: u32, at: FacePoint) -> f32 {
    let size = f32(textureDimensions(face_hits).x);
    let place = clamp(at.place * size - 0.5, vec2f(0.0), vec2f(size - 1.0));
    let low = vec2u(place);
    let high = min(low + 1u, vec2u(u32(size) - 1u));
    let part = place - vec2f(low);
    let d = vec4f(
        depth_at(face, low),
        depth_at(face, vec2u(high.x, low.y)),
        depth_at(face, vec2u(low.x, high.y)),
        depth_at(face, high),
    );
    let least = min(min(d.x, d.y), min(d.z, d.w));
    let most = max(max(d.x, d.y), max(d.z, d.w));
    let sight = abs(inwards(face));
    let across_m = (vec3f(1.0) - sight) * face_box.size;
    let pixel_m = max(across_m.x, max(across_m.y, across_m.z)) / size;
    if ((most - least) * dot(sight, face_box.size) > SAME_SURFACE * pixel_m) { return depth_at(face, face_pixel(at.place)); }
    return mix(mix(d.x, d.y, part.x), mix(d.z, d.w, part.x), part.y);
}

struct BoxRay {
    origin: vec3f,
    direction: vec3f,
    start: vec3f, // the origin in the box
    onward: vec3f, // way in the box for each meter
    from_m: f32,
    to_m: f32,
}
alias MapRay = BoxRay;

fn in_box(r: BoxRay, t: f32) -> vec3f {
    return r.start + r.onward * t;
}

fn is_behind_pixel(face: u32, point: vec3f) -> bool {
    let at = seen_by_face(face, point);
    return at.depth > depth_at(face, face_pixel(at.place));
}

fn is_behind_map(face: u32, r: BoxRay, t: f32) -> bool {
    let at = seen_by_face(face, in_box(r, t));
    return at.depth > depth_seen(face, at);
}

// Hit of a ray that goes behind the surfaces of a face: the triangle or capsule that a pixel there names, where the ray
// meets it or, between small triangles, its plane beside it, at about this place.
fn met_at(face: u32, r: BoxRay, t: f32) -> Hit {
    let none = Hit(r.to_m, NO_INSTANCE, 0u, vec2f(0.0), 0u);
    let at = seen_by_face(face, in_box(r, t));
    let id = textureLoad(face_hits, face_pixel(at.place), face, 0).yz;
    if (id.x == NONE) { return none; }
    if (COUNT) { tested_triangles++; }
    let met = meet_named(id, r.origin, r.direction);
    if (met.x < r.from_m * (1.0 - TIE) || met.x <= 0.0 || met.x > r.to_m) { return none; }
    let size = f32(textureDimensions(face_hits).x);
    let beside = seen_by_face(face, in_box(r, met.x));
    if (distance(beside.place, at.place) * size > SAME_PLACE_PX) { return none; }
    return named_hit(id, met, r.origin, r.direction, inwards(face), none);
}

// Whether a ray that leaves the box without a hit goes out of it as the face across sees: that face sees nothing there.
fn is_seen_out(r: BoxRay, leave: vec3f) -> bool {
    var axis = select(0u, 1u, leave.y < leave.x);
    axis = select(axis, 2u, leave.z < min(leave.x, leave.y));
    let across = 2u * axis + select(0u, 1u, dot(inwards(2u * axis + 1u), r.direction) > 0.0);
    let at = seen_by_face(across, in_box(r, r.to_m));
    return depth_at(across, face_pixel(at.place)) >= NOTHING;
}

fn closest_hit(origin: vec3f, direction: vec3f, start_m: f32, end_m: f32) -> Hit {
    let none = Hit(end_m, NO_INSTANCE, 0u, vec2f(0.0), 0u);
    let start = (origin - face_box.low) / face_box.size;
    let onward = direction / face_box.size;
    let margin = 1e-3 + SAME_PLACE_PX / f32(textureDimensions(face_hits).x); // a pixel more than the box
    let span = span_in_box(-margin - start, 1.0 + margin - start, onward);
    let from_m = max(max(span.enter.x, max(span.enter.y, span.enter.z)), start_m);
    let leave_m = min(span.leave.x, min(span.leave.y, span.leave.z));
    let to_m = min(leave_m, end_m);
    map_cause = CAUSE_NONE;
    if (to_m <= from_m) { return none; }
    let r = BoxRay(origin, direction, start, onward, from_m, to_m);
    let faster = max(abs(onward.x), max(abs(onward.y), abs(onward.z)));
    let pixels = (to_m - from_m) * faster * f32(textureDimensions(face_hits).x);
    let count = u32(clamp(ceil(pixels), 1.0, f32(face_box.steps)));
    var before = 0u; // faces behind whose depths the ray is, as bits
    var free_m = from_m;
    for (var step = 1u; step <= count; step++) {
        let t = mix(from_m, to_m, f32(step) / f32(count));
        let point = in_box(r, t);
        if (COUNT) { map_steps++; }
        var nearest = none;
        for (var face = 0u; face < 6u; face++) {
            var is_behind = is_behind_pixel(face, point);
            let enters = is_behind && (before & (1u << face)) == 0u;
            if (enters) { is_behind = is_behind_map(face, r, t); }
            before = insertBits(before, u32(is_behind), face, 1u);
            if (!enters || !is_behind) { continue; }
            let hit = met_in_step(face, r, free_m, t);
            if (hit.instance != NO_INSTANCE && hit.t < nearest.t) { nearest = hit; }
        }
        if (nearest.instance != NO_INSTANCE) {
            map_cause = CAUSE_BOX;
            return nearest;
        }
        free_m = t;
    }
    if (to_m == leave_m && !is_seen_out(r, span.leave)) { map_cause = CAUSE_BOX_HIDDEN; }
    return none;
}
