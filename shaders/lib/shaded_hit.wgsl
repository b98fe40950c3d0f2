// Light of the first hit of a reflection ray, where nothing is followed further.

#import cone
#import gbuffer
#import indirect
#import light_reuse

const MIRRORED: bool = false;

// The pixel's cone where its reflection ray has gone a distance.
fn reflected_cone(first: Surface, at_m: f32) -> Cone {
    let cone = mirrored_cone(pixel_cone(distance(first.position, frame.eye)), first.curvature);
    return continued(cone, at_m);
}

// Light that a pixel's reflection ray brings from the surface that it hits.
fn light_of_hit(pixel: vec2u, first: Surface, ray: Reflected, hit_surface: Surface, at_m: f32, id: vec2u, cone: Cone) -> vec3f {
    var s = hit_surface;
    s.emission *= met_emission(ray, id.x, id.y, at_m, s);
    start_samples(pixel, 1u);
    let end = seen_at_end(first.position, ray, id.x, at_m);
    if (end.is_seen) { return end.radiance; }
    var reused = vec2u(0u);
    if (REUSES_LIGHT) { reused = reused_visibility(s); }
    return met_light(ray, s, reused) + followed(pixel, 2u, 1u, scattered_by_surface(ray, s), cone);
}
