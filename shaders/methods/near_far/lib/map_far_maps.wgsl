// Variant of method near-far (Ganestam & Doggett 2015): rays are traced through the BVHs inside of a box around the
// camera only; outside they march through a cube map of the surfaces behind the box.

#import bvh
#import constants
#import cube_depth
#import far_box
#import mapped
#import id_intersection

// Largest angle of a step, radians: just below a right angle, whose tangent is infinite.
const STEEPEST: f32 = 1.570795;

// A ray as the middle of the maps sees it. Its points are given by the angle from the one nearest to the middle: even
// angles are even steps over the maps.
struct FarRay {
    origin: vec3f,
    direction: vec3f,
    offset: vec3f, // of the origin from the middle
    along_m: f32, // distance of the origin past the nearest point
    nearest_m: f32, // distance of that point from the middle
    from_m: f32,
    to_m: f32,
}
alias MapRay = FarRay;

fn angle_of(r: FarRay, t: f32) -> f32 {
    return clamp(atan((t + r.along_m) / r.nearest_m), -STEEPEST, STEEPEST);
}

fn distance_of(r: FarRay, angle: f32) -> f32 {
    return clamp(r.nearest_m * tan(angle) - r.along_m, r.from_m, r.to_m);
}

// Whether a point of the ray is behind the pixel that has its direction: one look-up, where the depth between pixels
// takes four.
fn is_behind_pixel(map: u32, r: FarRay, angle: f32) -> bool {
    let at = face_place(r.offset + r.direction * distance_of(r, angle));
    let size = f32(textureDimensions(cube_hits).x);
    return at.axis > depth_at(6u * map + at.face, vec2i(cube_pixel(at.place)), size);
}

fn is_behind_map(map: u32, r: FarRay, angle: f32) -> bool {
    let at = face_place(r.offset + r.direction * distance_of(r, angle));
    return at.axis > depth_seen(map, at);
}

// Whether the middle of the maps sees a point at about the place of another.
fn is_beside(point: vec3f, other: vec3f) -> bool {
    let pixel = 2.0 / f32(textureDimensions(cube_hits).x);
    let a = face_place(point);
    let b = face_place(other);
    if (a.face == b.face) { return distance(a.place, b.place) <= SAME_PLACE_PX * pixel; }
    return length(cross(normalize(point), normalize(other))) <= SAME_PLACE_PX * pixel;
}

// Hit of a ray that goes behind a map: the triangle or capsule that a pixel there names, where the ray meets it or,
// between small triangles, its plane beside it, at about this place.
fn met_at(map: u32, r: FarRay, angle: f32) -> Hit {
    let none = Hit(r.to_m, NO_INSTANCE, 0u, vec2f(0.0), 0u);
    let here = r.offset + r.direction * distance_of(r, angle);
    let id = cube_hit(map, here).yz;
    if (id.x == NONE) { return none; }
    if (COUNT) { tested_triangles++; }
    let met = meet_named(id, r.origin, r.direction);
    if (met.x < r.from_m * (1.0 - TIE) || met.x <= 0.0 || met.x > r.to_m) { return none; }
    let point = r.offset + r.direction * met.x;
    if (!is_beside(point, here)) { return none; }
    return named_hit(id, met, r.origin, r.direction, point, none);
}

// Marches a part of a ray outside of the box, on which it starts before everything that the maps see.
fn march_far(origin: vec3f, direction: vec3f, from_m: f32, to_m: f32) -> Hit {
    let offset = origin - far_box.eye;
    let along_m = dot(offset, direction);
    let nearest_m = max(length(offset - direction * along_m), 1e-3 * far_box.half_size_m);
    let r = FarRay(origin, direction, offset, along_m, nearest_m, from_m, to_m);
    let first = angle_of(r, from_m);
    let last = angle_of(r, to_m);
    let pixel = 2.0 / f32(textureDimensions(cube_hits).x);
    let count = u32(clamp(ceil((last - first) / pixel), 1.0, f32(far_box.steps)));
    var before = array<bool, 2>(false, false);
    var free = first;
    for (var step = 1u; step <= count; step++) {
        let angle = mix(first, last, f32(step) / f32(count));
        if (COUNT) { map_steps++; }
        for (var map = 0u; map < far_box.layers; map++) {
            var is_behind = is_behind_pixel(map, r, angle);
            let enters = is_behind && !before[map];
            if (enters) { is_behind = is_behind_map(map, r, angle); }
            before[map] = is_behind;
            if (!is_behind) {
                // A point before one map is before all that follow.
                for (var next = map + 1u; next < far_box.layers; next++) { before[next] = false; }
                break;
            }
            if (!enters) { continue; }
            let hit = met_in_step(map, r, free, angle);
            if (hit.instance != NO_INSTANCE) {
                map_cause = CAUSE_FAR;
                return hit;
            }
            // A reflector outside of the box is in front of its own pixels only up to their size.
            if (step > 1u || from_m > 0.0) { map_cause = CAUSE_FAR_HIDDEN; }
        }
        free = angle;
    }
    return Hit(to_m, NO_INSTANCE, 0u, vec2f(0.0), 0u);
}

fn closest_hit(origin: vec3f, direction: vec3f, start_m: f32, end_m: f32) -> Hit {
    map_cause = CAUSE_UNMARCHED;
    let offset = origin - far_box.eye;
    let span = span_in_box(-far_box.half_size_m - offset, far_box.half_size_m - offset, direction);
    let first_m = max(span.enter.x, max(span.enter.y, span.enter.z));
    let last_m = min(span.leave.x, min(span.leave.y, span.leave.z));
    let is_crossed = first_m < last_m && last_m > start_m;
    let enter_m = select(end_m, clamp(first_m, start_m, end_m), is_crossed);
    let leave_m = select(end_m, clamp(last_m, enter_m, end_m), is_crossed);
    var is_marched = false;
    // Before the box, in it, and behind it. One call in a loop keeps the inlined code small.
    for (var part = 0u; part < 2u; part++) {
        let from_m = select(leave_m, start_m, part == 0u);
        let to_m = select(end_m, enter_m, part == 0u);
        if (to_m > from_m) {
            is_marched = true;
            let hit = march_far(origin, direction, from_m, to_m);
            if (hit.instance != NO_INSTANCE) { return hit; }
        }
        if (part == 0u && leave_m > enter_m) {
            let hit = trace_nearest(origin, direction, enter_m, leave_m);
            if (hit.instance != NO_INSTANCE) {
                map_cause = CAUSE_UNMARCHED;
                return hit;
            }
        }
    }
    if (is_marched && map_cause == CAUSE_UNMARCHED) { map_cause = CAUSE_NONE; }
    return Hit(end_m, NO_INSTANCE, 0u, vec2f(0.0), 0u);
}
