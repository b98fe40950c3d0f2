// Light of the environment by samples: each sub-frame takes a few, and many sub-frames converge.

#import frame
#import lobe
#import sampling

// Whether something can be in the way of the environment's light.
override HAS_ENVIRONMENT_RAYS: bool = true;

// Of the rays of a surface, those that follow the bright parts of the environment.
fn environment_ray_share() -> f32 {
    return 0.75 * environment_share();
}

// Density per solid angle of all rays that a rough reflector sends towards the environment.
fn environment_rays_pdf(s: Surface, direction: vec3f) -> f32 {
    let share = environment_ray_share();
    if (share == 0.0) { return 0.0; }
    let lobe = max(dot(s.normal, direction), 0.0) / PI;
    return f32(sampling.rays) * mix(lobe, environment_pdf(direction), share);
}

// The environment by rays that follow its bright parts and the lobes of the surface, weighted by the
// power heuristic (see extent_sampled.wgsl). Reflectors see it by their reflection rays, alone where they
// are sharp or no part of it is bright.
fn environment_light(s: Surface, view: vec3f, albedo: vec3f) -> Shade {
    var out: Shade;
    let by_environment = environment_ray_share();
    let is_rough = by_environment > 0.0 && is_rough_reflector(s);
    let has_specular = (is_rough || !is_reflector(s)) && (s.metallic > 0.0 || s.reflectivity > 0.0);
    let has_diffuse = has_sheen(s) || max(albedo.x, max(albedo.y, albedo.z)) > 0.0;
    if (!has_specular && !has_diffuse) { return out; }
    let by_specular = select(0.0, select(1.0, 0.5, has_diffuse), has_specular && !is_rough);
    let pair = next_pair();
    for (var k = 0u; k < sampling.rays; k++) {
        var u = sample_square(sampling.first + k, pair);
        var direction: vec3f;
        if (u.x < by_environment) {
            direction = environment_direction(vec2f(u.x / by_environment, u.y));
        } else {
            u.x = (u.x - by_environment) / (1.0 - by_environment);
            if (u.x < by_specular) {
                let axes = basis(s.normal);
                let facet = visible_normal(view * axes, ggx_alpha(s), vec2f(u.x / by_specular, u.y));
                direction = reflect(-view, axes * facet);
            } else {
                direction = cosine_direction(s.normal, vec2f((u.x - by_specular) / (1.0 - by_specular), u.y));
            }
        }
        let nl = dot(s.normal, direction);
        if (!faces(s, direction)) { continue; }
        var pdf = (1.0 - by_specular) * nl / PI;
        var facets = 0.0;
        if (has_specular) { facets = facet_pdf(s, view, direction); }
        pdf = mix(pdf + by_specular * facets, environment_pdf(direction), by_environment);
        var arriving = vec3f(1.0);
        if (HAS_ENVIRONMENT_RAYS) {
            arriving = arriving_share(s, direction, FAR_M);
            if (all(arriving == vec3f(0.0))) { continue; }
        }
        let light = environment(direction) * arriving * (s.occlusion / max(pdf, 1e-12));
        out.diffuse += (albedo + sheen(s, view, direction)) * light * (nl / PI);
        if (!has_specular) { continue; }
        let share = select(1.0, balance(pdf * f32(sampling.rays), lobe_density(s, view, direction)), is_rough);
        out.specular += ggx(s, view, direction) * light * share;
    }
    let rays = f32(sampling.rays);
    return Shade(out.diffuse / rays, out.specular / rays, vec2u(0u));
}
