// Capture: radiance and hits of the static scene, seen from a probe through the pixels of a cube map. The environment
// that a probe sees, directly or straight through panes, is left out, as are lamps and surfaces that are sampled as
// lights: the look-up adds them by the reflection's own ray.

#import capture_panes
#import capture_params
#import cone
#import cube_faces
#import half
#import indirect
#import pane_share
#import probes
#import shade

@group(2) @binding(0) var captured: texture_storage_2d_array<rgba16float, write>; // w: share that surfaces but clear panes cover
@group(2) @binding(1) var captured_hits: texture_storage_2d_array<rgba32uint, write>; // distance, instance, triangle, place
@group(2) @binding(2) var<uniform> params: Params;

const LEAVES_PIXELS: bool = false;

struct Seen {
    light: vec4f, // w: 1 where the ray meets a surface, clear panes left out
    hit: vec4u,
}

// Follows a ray as the trace pass does, with the reflections along it.
fn seen_from(probe: vec3f, towards: vec3f, seed: vec2u) -> Seen {
    var seen = Seen(vec4f(0.0), vec4u(0u, NONE, NONE, 0u));
    var origin = probe;
    var cone = Cone(0.0, 2.0 / f32(params.face_px));
    var ray = Reflected(towards, vec3f(1.0), 0.0, 1.0, 1.0, vec3f(0.0));
    forget_path();
    start_path(origin, false);
    var color = vec3f(0.0);
    var throughput = vec3f(1.0);
    var is_clear = true; // whether the path has only passed clear panes
    for (var bounce = 0u; bounce < most_hits(); bounce++) {
        start_samples(seed, bounce + 1u);
        let direction = ray.direction;
        let h = trace_nearest(origin, direction, 0.0, reach_m());
        throughput *= medium_transmittance(h.t);
        // Light that the look-up adds, if what is met is no further pane.
        let is_kept_apart = is_clear && (bounce == 0u || is_same_direction(direction, towards));
        // The first ray passes lamps.
        let end = seen_at_end(origin, ray, h.instance, h.t);
        if (h.instance == NONE || (bounce > 0u && end.is_seen)) {
            if (is_kept_apart) { seen.light.w = 0.0; } else { color += found_light(throughput * end.radiance, bounce); }
            break;
        }
        if (bounce == 0u) {
            seen.light.w = 1.0;
            seen.hit = vec4u(bitcast<u32>(h.t), h.instance, h.triangle, pack2x16unorm(h.bary));
        }
        cone = continued(cone, h.t);
        var s = surface_at(h.instance, h.triangle, h.bary, direction, cone.width_m);
        s.emission *= met_emission(ray, h.instance, h.triangle, h.t, s);
        let is_pane = is_clear_pane(s);
        // Light samples find the light of lamps.
        let is_lamp = HAS_EMITTERS && (instance_flags(h.instance) & FLAG_EMITTER) != 0u;
        if (is_kept_apart && (bounce == 0u || !is_pane) && is_lamp) { s.emission = vec3f(0.0); }
        color += found_light(throughput * met_light(ray, s, vec2u(0u)), bounce);
        if (!continues(s)) { break; }
        ray = next_ray(ray, s, ANY_LIGHT);
        throughput *= ray.weight;
        is_clear = is_clear && is_pane && bounce < MAX_CLEAR_PANES && dot(ray.direction, s.geometric_normal) < 0.0;
        if (max(throughput.x, max(throughput.y, throughput.z)) < frame.dimmest) { break; }
        if (dot(ray.direction, s.geometric_normal) > 0.0) { cone = mirrored_cone(cone, s.curvature); }
        origin = onward_origin(s, ray.direction);
    }
    seen.light = vec4f(color, seen.light.w);
    return seen;
}

@compute @workgroup_size(GROUP_PX, GROUP_PX)
fn main(@builtin(global_invocation_id) id: vec3u) {
    let pixel = id.xy + vec2u(params.first_x, params.first_y);
    if (any(pixel >= vec2u(params.face_px))) { return; }
    let layer = params.first_layer + id.z;
    walks_within = false;
    let probe = probes[layer / 6u].position.xyz;
    var sum = vec4f(0.0);
    let seed = pixel + vec2u(params.face_px * layer, 0u);
    for (var sample = 0u; sample < params.samples; sample++) {
        added_sample = sample;
        // The first sample is in the middle of its pixel, the others are evenly spread around it (Roberts 2018, "The
        // Unreasonable Effectiveness of Quasirandom Sequences").
        let within = fract(vec2f(0.5) + f32(sample) * vec2f(0.7548776662, 0.5698402910));
        let place = (vec2f(pixel) + within) * (2.0 / f32(params.face_px)) - 1.0;
        let seen = seen_from(probe, normalize(face_direction(layer % 6u, place)), seed);
        sum += seen.light;
        if (sample == 0u) {
            textureStore(captured_hits, pixel, layer, seen.hit);
            keep_behind_panes(probe, normalize(face_direction(layer % 6u, place)), seen.hit.y, pixel, layer);
        }
    }
    let mean = sum / f32(params.samples);
    textureStore(captured, pixel, layer, halved(vec4f(mean.xyz / EMISSION_SCALE, mean.w)));
}
