// Capsules: all points within a radius of a segment, spheres where the segment has no length. The axis is the vector
// from the base, the segment's first end, to the second. src/world/bvh/capsule.rs has the same functions in f64.
// Its two coordinates of points of the surface stand in hits where triangles have barycentric weights.

#import basis
#import constants

// Whether some mesh is of capsules.
override HAS_CAPSULES: bool = true;

// Least diameters that show a point or a line everywhere, pixels: a circle around a pixel holds the center of one.
const POINT_PX: f32 = 1.43;
const LINE_PX: f32 = 1.01;

// Where a ray's line enters and leaves a capsule, in lengths of its direction.
struct CapsuleSpan {
    is_met: bool,
    enter: f32,
    leave: f32,
}

// `origin` is relative to the base.
fn capsule_span(origin: vec3f, direction: vec3f, axis: vec3f, radius: f32) -> CapsuleSpan {
    let dd = dot(direction, direction);
    // Seen from the point of the ray nearest to the middle, so that distance costs little precision.
    let shift = dot(0.5 * axis - origin, direction) / dd;
    let near = origin + direction * shift;
    let aa = dot(axis, axis);
    let along = dot(axis, direction);
    let across = cross(axis, direction);
    let cc = dot(across, across);
    let is_parallel = cc <= aa * dd * 1e-12;
    // Times at which the line enters and leaves the infinite cylinder, and the heights there times |axis|².
    var times = vec2f(0.0);
    var heights = vec2f(-along, along) * 1e30;
    if (!is_parallel) {
        let offset = dot(near, across);
        let rest = aa * (radius * radius * cc - offset * offset);
        if (rest < 0.0) { return CapsuleSpan(false, 0.0, 0.0); }
        let middle = dot(axis, near) * along - aa * dot(near, direction);
        times = (middle + vec2f(-1.0, 1.0) * sqrt(rest)) / cc;
        heights = dot(axis, near) + times * along;
    }
    if (is_parallel || heights.x < 0.0 || heights.x > aa) {
        let end = ball_chord(near - select(vec3f(0.0), axis, heights.x > aa), direction, dd, radius);
        if (end.y < 0.0) { return CapsuleSpan(false, 0.0, 0.0); }
        times.x = end.x - sqrt(end.y);
    }
    if (is_parallel || heights.y < 0.0 || heights.y > aa) {
        let end = ball_chord(near - select(vec3f(0.0), axis, heights.y > aa), direction, dd, radius);
        times.y = end.x + sqrt(max(end.y, 0.0));
    }
    return CapsuleSpan(true, shift + times.x, shift + times.y);
}

// Time at which a line is nearest to the middle of a ball, from which `origin` is, and the square of half the time
// that it spends inside; negative where it misses.
fn ball_chord(origin: vec3f, direction: vec3f, dd: f32, radius: f32) -> vec2f {
    let nearest = -dot(origin, direction) / dd;
    let apart = origin + direction * nearest;
    return vec2f(nearest, (radius * radius - dot(apart, apart)) / dd);
}

// Basis around the axis, or around z for a sphere.
fn capsule_frame(axis: vec3f) -> mat3x3f {
    let length2 = dot(axis, axis);
    return basis(select(vec3f(0.0, 0.0, 1.0), axis * inverseSqrt(max(length2, 1e-37)), length2 > 0.0));
}

// Share of the segment at which the axis is nearest to a point, which is relative to the base.
fn capsule_share(point: vec3f, axis: vec3f) -> f32 {
    return clamp(dot(point, axis) / max(dot(axis, axis), 1e-37), 0.0, 1.0);
}

// Coordinates of a point of the surface, which is relative to the base.
fn capsule_place(point: vec3f, axis: vec3f, radius: f32) -> vec2f {
    let share = capsule_share(point, axis);
    let normal = normalize(point - axis * share) * capsule_frame(axis);
    let meridian = atan2(normal.z, length(normal.xy)) + 0.5 * PI;
    let length_m = length(axis);
    let angle = atan2(normal.y, normal.x) / (2.0 * PI);
    return vec2f((share * length_m + radius * meridian) / (length_m + radius * PI), fract(angle));
}

struct CapsulePoint {
    share: f32, // place on the axis, as a share of the segment
    normal: vec3f,
}

fn capsule_point(place: vec2f, axis: vec3f, radius: f32) -> CapsulePoint {
    let length_m = length(axis);
    let along = place.x * (length_m + radius * PI) - radius * 0.5 * PI;
    let on_axis = clamp(along, 0.0, length_m);
    let latitude = (along - on_axis) / radius;
    let angle = place.y * 2.0 * PI;
    let normal = capsule_frame(axis) * vec3f(cos(angle) * cos(latitude), sin(angle) * cos(latitude), sin(latitude));
    return CapsulePoint(on_axis / max(length_m, 1e-30), normal);
}
