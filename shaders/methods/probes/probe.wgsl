// Probe: looks the reflections of the listed pixels up in the cube maps of probes, in place of the trace pass.

#import gbuffer
#import lists
#import mirror_hit
#import probe_lookup
#import probe_panes
#import probe_params
#import radiance

@group(2) @binding(5) var reflection: RadianceTexture;
@group(2) @binding(7) var<uniform> params: Params;
@group(2) @binding(0) var ids: texture_2d<u32>;

// Whether probes are chosen by the origin of the model that a pixel shows, for all of it, rather than by the pixel's
// point.
override PROBES_BY_INSTANCE: bool = false;

// Part of a reflection that the lobe of a surface averages: the mirror direction of its only lobe, and the level of the
// maps for its roughness. Sharp reflections, and rays of one lobe of two, keep their own direction.
struct Aim {
    direction: vec3f,
    level: f32,
}

fn aim(s: Surface, ray: Reflected) -> Aim {
    if (!HAS_ROUGH_REFLECTIONS || !is_spread(s)) { return Aim(ray.direction, 0.0); }
    let view = view_direction(s.position);
    let only = only_lobe(s, -view);
    if (only.share <= 0.0) { return Aim(ray.direction, 0.0); }
    return Aim(mirror_direction(view, only.layer), only.layer.roughness * f32(params.levels - 1u));
}

// Hit that a probe shows in a direction from a point.
fn shown_hit(probe: u32, origin: vec3f, direction: vec3f) -> vec4u {
    let towards = direction_from(probe, origin, direction);
    var found = cube_hit(probe, towards);
    if (found.y == NONE) { return vec4u(0u, NONE, NONE, 0u); }
    let point = probes[probe].position.xyz + towards * bitcast<f32>(found.x);
    found.x = bitcast<u32>(max(dot(point - origin, direction), 0.0));
    return found;
}

// Light that a probe shows of a ray, the hit that it stands for, and the distance of the ray's own hit.
struct Shown {
    light: vec3f,
    hit: vec4u,
    own_m: f32,
}

fn shown_by(probe: u32, origin: vec3f, ray: Reflected, to: Aim, width_m: f32) -> Shown {
    let towards = direction_from(probe, origin, to.direction);
    let stored = textureSampleLevel(probe_radiance, probe_sampler, towards, probe, to.level);
    let found = shown_hit(probe, origin, to.direction);
    var sky = environment(ray.direction) * (ray.sky_weight * (1.0 - stored.w));
    if (has_sky_behind_panes(probe, origin, ray.direction)) { sky = vec3f(0.0); }
    // Lamps are met by the ray of one facet, as light samples expect; the rest is averaged over the lobe.
    var own = found;
    if (any(to.direction != ray.direction)) { own = shown_hit(probe, origin, ray.direction); }
    let light = stored.xyz * (EMISSION_SCALE * ray.kept) + sky + lamp_light(own.yz, unpack2x16unorm(own.w), bitcast<f32>(own.x), ray, width_m)
        + light_through_panes(probe, origin, ray, width_m, 1.0 - stored.w);
    return Shown(light, found, select(bitcast<f32>(own.x), 2.0 * FAR_M, own.y == NONE));
}

fn look_up(pixel: vec2u) {
    let s = load_surface(pixel);
    let ray = reflected_ray(pixel, s);
    if (!carries_light(ray)) {
        store_hit(pixel, vec4u(0u, NONE, NONE, 0u));
        textureStore(reflection, pixel, vec4f(0.0));
        return;
    }
    let width_m = pixel_width(distance(s.position, frame.eye));
    let to = aim(s, ray);
    var choosing = s.position;
    if (PROBES_BY_INSTANCE) { choosing = to_world(instance_values(textureLoad(ids, pixel, 0).x), vec3f(0.0)); }
    let chosen = chosen_probes(choosing, params.count, params.nearest);
    var light = vec3f(0.0);
    var found = vec4u(0u, NONE, NONE, 0u);
    var reach_m = 2.0 * FAR_M;
    for (var k = 0u; k < params.nearest; k++) {
        if (chosen.weights[k] <= 0.0) { continue; }
        let shown = shown_by(chosen.probes[k], s.position, ray, to, width_m);
        light += shown.light * chosen.weights[k];
        if (k == 0u) {
            found = shown.hit;
            reach_m = shown.own_m;
        }
    }
    let lamp = seen_light(s.position, ray, reach_m);
    if (lamp.is_seen) { light = lamp.radiance; }
    textureStore(reflection, pixel, stored(smoothable(s, ray, light)));
    store_hit(pixel, found);
}

@compute @workgroup_size(RAYS_PER_GROUP)
fn main(@builtin(workgroup_id) group: vec3u, @builtin(num_workgroups) groups: vec3u, @builtin(local_invocation_index) lane: u32) {
    let index = (group.y * groups.x + group.x) * RAYS_PER_GROUP + lane;
    if (index < atomicLoad(&counters[RAY_COUNTER])) { look_up(unpack_pixel(lists[ray_slot(index)])); }
}
