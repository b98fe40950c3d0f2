// Audit: traces rays for some of the screen hits, to count how many of these hits lie on a wrong surface.

#import gbuffer
#import lists

// The maximum number of rays is not a parameter: llvmpipe 22.3 crashes on conditions that depend only on values of a
// fourth uniform block (Mesa's lvp_inline_uniforms.c writes past its table).
struct Params {
    tolerance_m: f32, // maximum distance between screen hit and ray hit, m
    tolerance: f32, // the same as a share of the ray's length; the larger of the two counts
    seed: u32,
}

@group(2) @binding(3) var hit: texture_2d<u32>;
@group(2) @binding(4) var<uniform> params: Params;

// Index of the hit that audit ray number `ray` checks: every hit where there are few, else a random one.
fn drawn(ray: u32, hits: u32) -> u32 {
    if (hits <= AUDIT_RAYS) { return ray; }
    // PCG hash (Jarzynski and Olano 2020).
    let state = (ray + params.seed * AUDIT_RAYS) * 747796405u + 2891336453u;
    let word = ((state >> ((state >> 28u) + 4u)) ^ state) * 277803737u;
    return ((word >> 22u) ^ word) % hits;
}

@compute @workgroup_size(RAYS_PER_GROUP)
fn main(@builtin(global_invocation_id) id: vec3u) {
    let hits = atomicLoad(&counters[HIT_COUNTER]);
    if (id.x >= min(AUDIT_RAYS, hits)) { return; }
    let pixel = unpack_pixel(lists[hit_slot(drawn(id.x, hits))]);
    let found = textureLoad(hit, pixel, 0);
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
