// Rays in screen space, for the march.

#import frame

// A ray in screen space: pixel position and clip-space z are linear in the parameter s from 0 to 1.
struct ScreenRay {
    start: vec3f,
    delta: vec3f,
    length_m: f32,
    end: f32, // s where the ray leaves the picture, at most 1
    leaves: bool, // whether the ray goes on after `end`
}

// Pixel and clip-space z of a point, the inverse of `pixel_offset`. The clip matrix is not used: lavapipe 22.3
// treats it as constants of the march and recompiles for each sub-frame, which takes longer than the march.
fn to_screen(p: vec3f) -> vec3f {
    let offset = p - frame.eye;
    let depth_m = dot(offset, frame.forward);
    let across = vec2f(dot(offset, frame.right), -dot(offset, frame.up));
    let extent = vec2f(dot(frame.right, frame.right), dot(frame.up, frame.up));
    let ndc = across / (extent * select(depth_m, 1.0, is_orthographic()));
    return vec3f((ndc * 0.5 + 0.5) * frame.size - frame.jitter, screen_z(depth_m));
}

// Parameter s at which x + s * dx leaves [0, size].
fn exit_at(x: f32, dx: f32, size: f32) -> f32 {
    if (dx > 1e-9) { return (size - x) / dx; }
    if (dx < -1e-9) { return -x / dx; }
    return 2.0;
}

fn screen_ray(origin: vec3f, direction: vec3f) -> ScreenRay {
    var r: ScreenRay;
    let approach = dot(direction, frame.forward);
    let depth = dot(origin - frame.eye, frame.forward);
    r.length_m = frame.ray_length_m;
    // The screen shows nothing behind the near plane and clip planes.
    let to_near = (depth - frame.near_m * 1.01) / max(-approach, 1e-9);
    let seen = unclipped(origin, direction, vec2f(0.0, select(FAR_M, to_near, approach < 0.0)));
    if (seen.y < r.length_m) {
        r.length_m = max(seen.y, 0.0);
        r.leaves = true;
    }
    // Nothing lies beyond the far plane.
    if (is_orthographic() && approach > 0.0) {
        r.length_m = min(r.length_m, max(0.999 * (frame.far_m - depth), 0.0) / approach);
    }
    r.start = to_screen(origin);
    r.delta = to_screen(origin + direction * r.length_m) - r.start;
    let exit = min(exit_at(r.start.x, r.delta.x, frame.size.x), exit_at(r.start.y, r.delta.y, frame.size.y));
    r.end = clamp(exit, 0.0, 1.0);
    r.leaves = r.leaves || exit < 1.0;
    return r;
}

// Distance along the ray of a parameter s, and the inverse below: perspective-correct interpolation.
fn distance_at(r: ScreenRay, s: f32) -> f32 {
    if (is_orthographic()) { return r.length_m * s; }
    return r.length_m * s * (r.start.z + r.delta.z) / max(r.start.z + r.delta.z * s, 1e-30);
}

fn place_of(r: ScreenRay, distance_m: f32) -> f32 {
    let u = distance_m / max(r.length_m, 1e-30);
    if (is_orthographic()) { return u; }
    return u * r.start.z / max((1.0 - u) * (r.start.z + r.delta.z) + u * r.start.z, 1e-30);
}
