// Diffuse interreflection: paths also continue in directions that diffuse surfaces scatter.

#import cone
#import extent
#import layers
#import lobe
#import sampling

const FIRST_ENDING: u32 = 4u; // number of vertices before Russian roulette starts
const MOST_LIKELY: f32 = 0.95; // maximum survival probability

var<private> path_weight: vec3f = vec3f(1.0);
var<private> path_vertices: u32 = 0u;

// Number of diffuse scatterings of the path, which do not count as bounces.
fn scatterings() -> u32 {
    return path_scatterings;
}

// Maximum length of the path's next ray: only reflections are limited to the scene's ray length.
fn reach_m() -> f32 {
    return select(frame.ray_length_m, FAR_M, path_scatterings > 0u);
}

// Diffuse albedo of a surface towards the view, while the path may still scatter.
fn scattered_albedo(s: Surface, view: vec3f) -> vec3f {
    if (path_scatterings >= frame.diffuse_bounces) { return vec3f(0.0); }
    return diffuse_albedo(s, view) * scattered_share(s, view);
}

fn continues(s: Surface) -> bool {
    return goes_on(s) || (path_scatterings < frame.diffuse_bounces && (has_sheen(s) || (s.metallic < 1.0 && any(s.base_color > vec3f(0.0)))));
}

// A cosine-distributed scattered ray. The environment's light is left to light samples.
fn scattered_ray(s: Surface, view: vec3f, albedo: vec3f) -> Reflected {
    path_scatterings++;
    path_is_chance = true;
    leave_vertex(s);
    let out = cosine_direction(s.normal, sample_square(sampling.sample, SCATTER_PAIR));
    if (dot(out, s.geometric_normal) <= 0.0) { return Reflected(s.normal, vec3f(0.0), TAKEN, 0.0, 1.0); }
    let weight = albedo + sheen(s, view, out) * scattered_share(s, view);
    return Reflected(out, weight, scattered_density(dot(s.normal, out)), 0.0, 1.0);
}

// Next ray of a path: scattered, or mirrored or transmitted, chosen by the light that each returns.
fn next_ray(before: Reflected, s: Surface) -> Reflected {
    let view = -before.direction;
    let albedo = scattered_albedo(s, view);
    var diffuse = luminance(albedo);
    if (has_sheen(s) && path_scatterings < frame.diffuse_bounces) {
        diffuse += luminance(sheen_albedo(s, view)) * scattered_share(s, view);
    }
    let rest = select(0.0, max(onward_albedo(s, view), 0.01), goes_on(s));
    if (diffuse + rest <= 0.0) { return Reflected(s.normal, vec3f(0.0), TAKEN, 0.0, 1.0); }
    let share = diffuse / (diffuse + rest);
    let u = sample_square(sampling.sample, CHOICE_PAIR);
    var ray: Reflected;
    if (u.x < share) {
        ray = scattered_ray(s, view, albedo);
        ray.weight *= before.kept / share;
    } else {
        ray = onward(before, s);
        ray.weight /= 1.0 - share;
    }
    if (UNBIASED) { ray.weight *= survival(ray.weight, u.y); }
    return ray;
}

// Russian roulette: factor on a surviving path; 0 ends it.
fn survival(weight: vec3f, u: f32) -> f32 {
    path_weight *= weight;
    path_vertices++;
    if (path_vertices < FIRST_ENDING) { return 1.0; }
    let chance = clamp(max(path_weight.x, max(path_weight.y, path_weight.z)), 0.05, MOST_LIKELY);
    if (u >= chance) { return 0.0; }
    path_weight /= chance;
    return 1.0 / chance;
}

// Light that a path gathers from a surface on, along the ray `start`. `vertex` is the number of its first samples,
// `hits` the number of earlier hits of the path.
fn followed(pixel: vec2u, vertex: u32, hits: u32, start: Reflected, from_s: Surface, first: Cone) -> vec3f {
    var color = vec3f(0.0);
    var ray = start;
    var throughput = ray.weight;
    var s = from_s;
    var cone = first;
    for (var k = 0u; k < frame.bounces + crossings() + scatterings(); k++) {
        if (max(throughput.x, max(throughput.y, throughput.z)) < frame.dimmest) { break; }
        start_samples(pixel, vertex + k);
        let origin = onward_origin(s, ray.direction);
        let h = trace_nearest(origin, ray.direction, 0.0, FAR_M);
        throughput *= medium_transmittance(h.t);
        if (h.instance == NONE) {
            color += found_light(throughput * beyond(origin, ray), hits + k);
            break;
        }
        let light = seen_light(origin, ray, h.t);
        if (light.is_seen) {
            color += found_light(throughput * light.radiance, hits + k);
            break;
        }
        cone = continued(cone, h.t);
        s = surface_at(h.instance, h.triangle, h.bary, ray.direction, cone.width_m);
        s.emission *= met_emission(ray, h.instance, h.triangle, h.t, s);
        let lit = shade(s, -ray.direction, vec2u(0u));
        color += found_light(throughput * met_light(ray, lit), hits + k);
        if (!continues(s)) { break; }
        ray = next_ray(ray, s);
        throughput *= ray.weight;
    }
    return color;
}

// Indirect diffuse light that a surface scatters towards the view, after `hits` hits of the path.
fn scattered_on(pixel: vec2u, vertex: u32, hits: u32, before: Reflected, s: Surface, cone: Cone) -> vec3f {
    let view = -before.direction;
    let albedo = scattered_albedo(s, view);
    let is_matte = any(albedo > vec3f(0.0)) || has_sheen(s);
    if (!is_matte || path_scatterings >= frame.diffuse_bounces) { return vec3f(0.0); }
    return followed(pixel, vertex + 1u, hits, scattered_ray(s, view, albedo), s, cone);
}
