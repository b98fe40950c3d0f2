// Hits behind clear panes, for light samples find lamps and the environment there too: the maps' radiance lacks that
// light, and the look-up adds it by the reflection's own ray.

#import indirect
#import pane_share

@group(2) @binding(3) var captured_panes: texture_storage_2d_array<rgba32uint, write>; // distance, instance, triangle, share

// Whether the light behind a surface is kept apart from the radiance of the maps: only for smooth transmission without
// dispersion.
fn is_clear_pane(s: Surface) -> bool {
    if (!is_transmissive(s)) { return false; }
    if (s.transmission <= 0.0) { return true; }
    let is_even = s.roughness * s.roughness <= SMOOTH_ALPHA || !HAS_ROUGH_REFLECTIONS;
    return is_even && !(s.is_solid && (s.dispersion > 0.0 || s.alpha < 1.0));
}

// Keeps the surface behind the panes that a probe sees, and the share of its light that they let pass. `first`:
// instance that the probe sees.
fn keep_behind_panes(probe: vec3f, towards: vec3f, first: u32, pixel: vec2u, layer: u32) {
    if (!HAS_TRANSMISSION) { return; }
    var kept = vec4u(0u, NONE, NONE, 0u);
    if (first != NONE) {
        start_path(probe, false);
        var origin = probe;
        var direction = towards;
        var way_m = 0.0;
        var share = vec3f(1.0);
        for (var pane = 0u; pane <= MAX_CLEAR_PANES; pane++) {
            let h = trace_nearest(origin, direction, 0.0, reach_m());
            share *= medium_transmittance(h.t);
            var s: Surface;
            if (h.instance != NONE) {
                way_m += h.t;
                s = surface_at(h.instance, h.triangle, h.bary, direction, pixel_width(way_m));
            }
            if (h.instance == NONE || !is_clear_pane(s)) {
                if (pane > 0u && is_same_direction(direction, towards)) {
                    kept = vec4u(bitcast<u32>(way_m), h.instance, h.triangle, packed_share(share));
                }
                break;
            }
            let ray = transmitted(direction, s);
            cross_surface(s);
            share *= ray.weight;
            direction = ray.direction;
            origin = onward_origin(s, direction);
        }
    }
    textureStore(captured_panes, pixel, layer, kept);
}
