// Look-up of a ray in the cube maps of probes.

#import constants
#import cube_depth
#import cube_faces
#import frame
#import probes

// Way of looking up: LOOKUP_INFINITY, LOOKUP_BOX or LOOKUP_DISTANCE.
override LOOKUP: u32 = LOOKUP_BOX;

@group(2) @binding(23) var probe_radiance: texture_cube_array<f32>; // levels by roughness; w: share that surfaces cover
@group(2) @binding(25) var probe_sampler: sampler;

// Number of steps of a march through distances, and of halvings where it has crossed them.
const MARCH_STEPS: u32 = 30u;
const HALVINGS: u32 = 16u;

// Whether a point is behind the surface that a probe sees in its direction.
fn is_behind(probe: u32, offset: vec3f) -> bool {
    let at = face_place(offset);
    return at.axis > depth_seen(probe, at);
}

// Distance along a ray to where it first goes behind the probe's surfaces; FAR_M: nowhere. The steps are even in the
// angle by which the probe sees the ray. `offset`: the ray's origin, from the probe.
fn marched(probe: u32, offset: vec3f, direction: vec3f) -> f32 {
    let scale = max(length(offset), 1e-6);
    let cosine = dot(offset, direction) / scale;
    let along = offset - direction * dot(offset, direction);
    let nearest_m = max(length(along), 1e-3 * scale);
    let start = atan2(cosine * scale, nearest_m);
    let span = 0.5 * PI - start;
    var free_m = 0.0;
    for (var step = 1u; step <= MARCH_STEPS; step++) {
        // The last step is infinitely far away: short of it, far beyond everything.
        let angle = start + span * min(f32(step) / f32(MARCH_STEPS), 0.9999);
        let t = nearest_m * tan(angle) - cosine * scale;
        if (is_behind(probe, offset + direction * t)) {
            var low = free_m;
            var high = t;
            for (var k = 0u; k < HALVINGS; k++) {
                let middle = 0.5 * (low + high);
                let behind = is_behind(probe, offset + direction * middle);
                low = select(middle, low, behind);
                high = select(high, middle, behind);
            }
            return 0.5 * (low + high);
        }
        free_m = t;
    }
    return FAR_M;
}

// Distance along a ray to where it leaves a box; 0 or less where it does not.
fn box_exit(low: vec3f, high: vec3f, origin: vec3f, direction: vec3f) -> f32 {
    let far = select(low, high, direction > vec3f(0.0));
    let steep = abs(direction) > vec3f(1e-9);
    let t = select(vec3f(FAR_M), (far - origin) / select(vec3f(1.0), direction, steep), steep);
    return min(t.x, min(t.y, t.z));
}

// Direction in which a probe sees what a ray meets.
fn direction_from(probe: u32, origin: vec3f, direction: vec3f) -> vec3f {
    let offset = origin - probes[probe].position.xyz;
    var t = 0.0;
    if (LOOKUP == LOOKUP_BOX) { t = box_exit(probes[probe].proxy_min.xyz, probes[probe].proxy_max.xyz, origin, direction); }
    if (LOOKUP == LOOKUP_DISTANCE) { t = marched(probe, offset, direction); }
    if (t <= 0.0 || t >= FAR_M) { return direction; }
    return normalize(offset + direction * t);
}

// Shares of the way from the border of a probe's box to its middle along each axis, multiplied: 1 in the middle; below
// 0 outside. Floors and walls may lie on the border, so that points on it still count a little.
fn depth_in_box(probe: u32, point: vec3f) -> f32 {
    let inside = 1.0 - abs(point - probes[probe].middle.xyz) / probes[probe].half_size.xyz;
    let least = min(inside.x, min(inside.y, inside.z));
    if (least < -ON_BORDER) { return least; }
    let shares = max(inside, vec3f(ON_BORDER));
    return shares.x * shares.y * shares.z;
}

// The probes of a point, those deepest in whose boxes it lies, with weights that sum to 1; `ProbeChoice` makes the
// same.
struct Chosen {
    probes: vec4u,
    weights: vec4f,
}

fn chosen_probes(point: vec3f, count: u32, nearest: u32) -> Chosen {
    var c = Chosen(vec4u(0u), vec4f(-FAR_M));
    for (var i = 0u; i < count; i++) {
        var probe = i;
        var depth = depth_in_box(i, point);
        for (var k = 0u; k < nearest; k++) {
            if (depth > c.weights[k]) {
                let lesser = c.probes[k];
                let lesser_depth = c.weights[k];
                c.probes[k] = probe;
                c.weights[k] = depth;
                probe = lesser;
                depth = lesser_depth;
            }
        }
    }
    let weights = max(c.weights, vec4f(0.0));
    let sum = weights.x + weights.y + weights.z + weights.w;
    c.weights = select(vec4f(1.0, 0.0, 0.0, 0.0), weights / max(sum, 1e-12), sum > 1e-12);
    return c;
}
