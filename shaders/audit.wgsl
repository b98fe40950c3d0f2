// Audit: traces rays for some of the screen hits, to count how many of these hits lie on a wrong surface.

#import audit_params
#import gbuffer
#import hash
#import lists

@group(2) @binding(5) var hit: texture_2d_array<u32>;
// The maximum number of rays is not a parameter: llvmpipe 22.3 crashes on conditions that depend only on values of a
// fourth uniform block (Mesa's lvp_inline_uniforms.c writes past its table).
@group(2) @binding(6) var<uniform> params: Params;

// Start of part number `part` of `parts` almost equal parts of a list.
fn start_of(part: u32, parts: u32, length: u32) -> u32 {
    return part * (length / parts) + part * (length % parts) / parts;
}

// Index of the hit that audit ray number `ray` checks: a random one of its part of the list. No hit is checked twice,
// and all are where there are few.
fn drawn(ray: u32, rays: u32, hits: u32) -> u32 {
    let first = start_of(ray, rays, hits);
    return first + hash(ray + params.seed * AUDIT_RAYS) % (start_of(ray + 1u, rays, hits) - first);
}

@compute @workgroup_size(RAYS_PER_GROUP)
fn main(@builtin(global_invocation_id) id: vec3u) {
    let hits = atomicLoad(&counters[HIT_COUNTER]);
    let rays = min(AUDIT_RAYS, hits);
    if (id.x >= rays) { return; }
    let pixel = unpack_pixel(lists[hit_slot(drawn(id.x, rays, hits))]);
    let found = vec2u(textureLoad(hit, pixel, 0, 0).x, textureLoad(hit, pixel, 1, 0).x);
    if (HAS_FOG && found.y == NONE) { return; } // a ray past all surfaces, listed for its fog
    let first = load_surface(pixel);
    let ray = reflected_ray(pixel, first);
    let origin = ray_origin(first.position, first.geometric_normal);
    let truth = trace_nearest(origin, ray.direction, 0.0, frame.ray_length_m);
    let apart_m = abs(bitcast<f32>(found.x) - truth.t);
    let is_same = found.y == truth.instance && apart_m <= max(params.tolerance_m, params.tolerance * truth.t);
    atomicAdd(&counters[AUDITED_COUNTER], 1u);
    if (!is_same) { atomicAdd(&counters[WRONG_COUNTER], 1u); }
}
