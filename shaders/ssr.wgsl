// Screen-space reflections: marches the depth buffer along the mirror ray and decides by the
// paper's rules what it met. What it cannot answer is named in `cause`, for compact.wgsl.

#import gbuffer
#import cause

override MARCH: bool = true; // false: method rt, every reflective pixel is left to the tracer
override REFUSE: bool = true; // false: every crossing is taken, to judge what is refused

struct Params {
    threshold_m: f32, // the paper's T
    steps: u32,
    pad0: u32,
    pad1: u32,
}

@group(2) @binding(4) var radiance: texture_2d<f32>;
@group(2) @binding(5) var reflection: texture_storage_2d<rgba16float, write>;
@group(2) @binding(6) var cause: texture_storage_2d<r32uint, write>;
@group(2) @binding(7) var hit: texture_storage_2d<rgba32uint, write>;
@group(2) @binding(8) var ids: texture_2d<u32>;
@group(2) @binding(9) var<uniform> params: Params;
@group(2) @binding(10) var counts: texture_storage_2d<rgba32uint, write>; // of `counted`

// Depth buffer reads since the invocation started, with COUNT.
var<private> march_steps: u32 = 0u;

// A ray on the screen: pixel position and near / depth are linear in s from 0 to 1.
struct ScreenRay {
    start: vec3f,
    delta: vec3f,
    end: f32, // s where it leaves the picture, at most 1
    leaves: bool, // whether something is cut off after `end`
}

struct March {
    cause: u32,
    pixel: vec2u,
    distance_m: f32,
}

fn to_screen(p: vec3f) -> vec3f {
    let clip = frame.clip_from_world * vec4f(p, 1.0);
    let ndc = clip.xyz / clip.w;
    return vec3f((vec2f(ndc.x, -ndc.y) * 0.5 + 0.5) * frame.size, ndc.z);
}

// s at which x + s * dx leaves [0, size].
fn exit_at(x: f32, dx: f32, size: f32) -> f32 {
    if (dx > 1e-9) { return (size - x) / dx; }
    if (dx < -1e-9) { return -x / dx; }
    return 2.0;
}

fn screen_ray(origin: vec3f, direction: vec3f) -> ScreenRay {
    var r: ScreenRay;
    let approach = dot(direction, frame.forward);
    let depth = dot(origin - frame.eye, frame.forward);
    var length_m = frame.ray_length_m;
    // Behind the near plane there is no screen.
    let to_near = (depth - frame.near_m * 1.01) / max(-approach, 1e-9);
    if (approach < 0.0 && to_near < length_m) {
        length_m = max(to_near, 0.0);
        r.leaves = true;
    }
    r.start = to_screen(origin);
    r.delta = to_screen(origin + direction * length_m) - r.start;
    let exit = min(exit_at(r.start.x, r.delta.x, frame.size.x), exit_at(r.start.y, r.delta.y, frame.size.y));
    r.end = clamp(exit, 0.0, 1.0);
    r.leaves = r.leaves || exit < 1.0;
    return r;
}

struct Probe {
    behind: bool,
    ray_m: f32, // view depth of the ray
    scene_m: f32, // stored view depth
    pixel: vec2u,
}

// Whether the ray at s is behind what the depth buffer holds there. A stored point on or below the
// reflector's tangent plane never is in front of the ray: camera and ray are both above that plane,
// and so is every point between them. This keeps grazing floors from reflecting themselves.
fn probe(r: ScreenRay, s: f32, origin: Surface) -> Probe {
    if (COUNT) { march_steps++; }
    var p: Probe;
    let at = r.start + r.delta * s;
    p.pixel = vec2u(clamp(at.xy, vec2f(0.0), frame.size - 1.0));
    p.ray_m = frame.near_m / max(at.z, 1e-30);
    p.scene_m = textureLoad(view_depth, p.pixel, 0).x;
    if (p.ray_m > p.scene_m) {
        let height = dot(position_at(p.pixel, p.scene_m) - origin.position, origin.geometric_normal);
        p.behind = height > p.scene_m * 2e-4;
    }
    return p;
}

fn decide(p: Probe, origin: vec3f, direction: vec3f) -> March {
    let met = load_surface(p.pixel);
    var m = March(CAUSE_HIT, p.pixel, dot(met.position - origin, direction));
    if (!REFUSE) { return m; }
    if (p.ray_m - p.scene_m > params.threshold_m) {
        m.cause = CAUSE_HIDDEN;
    } else if (dot(met.geometric_normal, direction) >= 0.0) {
        m.cause = CAUSE_BACK_FACE;
    } else if (is_reflector(met)) {
        m.cause = CAUSE_REFLECTOR;
    }
    return m;
}

fn march(s0: Surface, direction: vec3f) -> March {
    let origin = ray_origin(s0.position, s0.geometric_normal);
    let r = screen_ray(origin, direction);
    let length_px = max(max(abs(r.delta.x), abs(r.delta.y)), 1e-3);
    // Steps grow from one pixel by an eighth of a pixel each: 128 of them reach 1,150 pixels.
    let first_px = max(1.0, max(frame.size.x, frame.size.y) / 1280.0);
    var cause = CAUSE_STEPS;
    var low = 0.0; // not behind here
    var high = 0.0; // behind here, once found
    var p: Probe;
    var before_m = FAR_M; // what was stored at `low`
    var k = 1u;
    var fine_end = 0.0; // up to here every pixel is looked at
    // One loop for coarse and fine steps and nothing else in it: neighbors that stop at different
    // steps still run what follows together.
    for (var i = 0u; k <= params.steps && i < 8u * params.steps; i++) {
        let x = f32(k);
        let coarse = min(first_px * (x + x * x / 16.0) / length_px, r.end);
        let is_fine = low < fine_end;
        high = select(coarse, min(low + 1.0 / length_px, fine_end), is_fine);
        p = probe(r, high, s0);
        if (p.behind) {
            cause = CAUSE_HIT;
            break;
        }
        if (!is_fine && p.ray_m > before_m && fine_end < coarse) {
            // The ray went deeper than what it had in front of it one step ago, and that thing is
            // gone: it may have been met near its edge. Look at every pixel in between.
            fine_end = coarse;
            continue;
        }
        if (high >= r.end) {
            cause = select(CAUSE_NONE, CAUSE_OFF_SCREEN, r.leaves);
            break;
        }
        low = high;
        before_m = p.scene_m;
        if (high >= coarse) { k++; }
    }
    if (cause != CAUSE_HIT) { return March(cause, vec2u(0u), 0.0); }
    // Step back to the crossing: T judges the crossing, not the length of the step.
    for (var i = 0; i < 6; i++) {
        let middle = (low + high) * 0.5;
        let q = probe(r, middle, s0);
        if (q.behind) {
            high = middle;
            p = q;
        } else {
            low = middle;
        }
    }
    return decide(p, origin, direction);
}

fn reflect_pixel(id: vec3u) {
    if (any(id.xy >= vec2u(frame.size))) { return; }
    var why = CAUSE_NOT_REFLECTIVE;
    var color = vec3f(0.0);
    var found = vec4u(0u, NONE, NONE, 0u);
    if (textureLoad(view_depth, id.xy, 0).x < FAR_M) {
        let s = load_surface(id.xy);
        if (is_reflector(s)) {
            why = CAUSE_UNMARCHED;
            if (MARCH) {
                let direction = mirror_direction(normalize(s.position - frame.eye), s);
                let m = march(s, direction);
                why = m.cause;
                if (why == CAUSE_HIT) {
                    let met = load_surface(m.pixel);
                    color = textureLoad(radiance, m.pixel, 0).xyz + shade(met, -direction).specular;
                    found = vec4u(bitcast<u32>(m.distance_m), textureLoad(ids, m.pixel, 0).xy, 0u);
                } else if (why == CAUSE_NONE) {
                    color = environment(direction);
                }
            }
        } else if (s.reflection != REFLECTION_NONE) {
            why = CAUSE_ROUGH;
        }
    }
    textureStore(reflection, id.xy, vec4f(min(color, vec3f(65000.0)), 1.0));
    textureStore(cause, id.xy, vec4u(why, 0u, 0u, 0u));
    textureStore(hit, id.xy, found);
}

@compute @workgroup_size(8, 8)
fn main(@builtin(global_invocation_id) id: vec3u) {
    reflect_pixel(id);
}

@compute @workgroup_size(8, 8)
fn counted(@builtin(global_invocation_id) id: vec3u) {
    reflect_pixel(id);
    textureStore(counts, id.xy, vec4u(march_steps, traversals, visited_nodes, tested_triangles));
}
