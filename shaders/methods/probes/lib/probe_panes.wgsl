// Light of lamps and of the environment that a reflection sees through the panes on a probe's map.

#import id_intersection
#import pane_share
#import probe_lookup

@group(2) @binding(26) var pane_hits: texture_2d_array<u32>; // distance, instance, triangle, share that panes let pass

// Light of a surface that is sampled as a light, which the maps lack, as far as the surface before keeps it. `id`: instance
// and triangle.
fn lamp_light(id: vec2u, place: vec2f, distance_m: f32, ray: Reflected, width_m: f32) -> vec3f {
    if (!HAS_EMITTERS || id.x == NONE || (instance_flags(id.x) & FLAG_EMITTER) == 0u) { return vec3f(0.0); }
    let s = surface_at(id.x, id.y, place, ray.direction, width_m);
    return s.emission * met_emission(ray, id.x, id.y, distance_m, s) * ray.kept;
}

// Light that a reflection's own ray finds behind panes and light samples find too, as far as the surface before keeps
// it. `uncovered`: share of the environment that no surface but panes covers.
fn light_through_panes(probe: u32, origin: vec3f, ray: Reflected, width_m: f32, uncovered: f32) -> vec3f {
    if (!HAS_TRANSMISSION) { return vec3f(0.0); }
    let towards = direction_from(probe, origin, ray.direction);
    let at = face_place(towards);
    let behind = textureLoad(pane_hits, cube_pixel(at.place), 6u * probe + at.face, 0);
    if (behind.w == 0u) { return vec3f(0.0); }
    let share = vec3f((vec3u(behind.w) >> vec3u(0u, 10u, 20u)) & vec3u(1023u)) / 1023.0;
    let eye = probes[probe].position.xyz;
    var reach_m = 2.0 * FAR_M;
    if (behind.y != NONE) { reach_m = max(dot(eye + towards * bitcast<f32>(behind.x) - origin, ray.direction), 0.0); }
    let lamp = seen_light(origin, ray, reach_m);
    if (lamp.is_seen) { return share * lamp.radiance; }
    if (behind.y == NONE) { return share * environment(ray.direction) * (ray.sky_weight * uncovered); }
    var place = meet_named(behind.yz, eye, towards).yz;
    if (!is_capsule(behind.y)) { place = clamped(place); }
    return share * lamp_light(behind.yz, place, reach_m, ray, width_m);
}

// Whether a probe shows panes in a direction from a point, and the environment behind them.
fn has_sky_behind_panes(probe: u32, origin: vec3f, direction: vec3f) -> bool {
    if (!HAS_TRANSMISSION) { return false; }
    let at = face_place(direction_from(probe, origin, direction));
    let behind = textureLoad(pane_hits, cube_pixel(at.place), 6u * probe + at.face, 0);
    return behind.w != 0u && behind.y == NONE;
}
