// Light of the environment by samples: each sub-frame takes a few, and the mean over sub-frames converges.

#import extent
#import frame
#import lobe
#import sampling

// Share of a surface's rays that follow the bright parts of the environment.
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

// Light of the environment in closed form: none, as all of it is sampled.
fn environment_light(s: Surface, view: vec3f, albedo: vec3f) -> Shade {
    return Shade();
}

// Light of one ray towards the environment, which follows its bright parts or the lobes of the surface, weighted by
// the power heuristic (see extent_sampled.wgsl). Reflectors get the environment's specular light by their reflection
// rays, and by these rays alone where they are sharp or the environment has no bright part.
fn returned_of_environment(s: Surface, view: vec3f, to: Receiver, index: u32) -> Returned {
    let by_environment = environment_ray_share();
    let is_rough = to.is_rough && by_environment > 0.0;
    let has_specular = to.has_specular && is_rough == to.is_rough;
    let has_diffuse = has_sheen(s) || max(to.albedo.x, max(to.albedo.y, to.albedo.z)) > 0.0;
    if (!has_specular && !has_diffuse) { return Returned(); }
    let by_specular = select(0.0, select(1.0, 0.5, has_diffuse), has_specular && !is_rough);
    var u = sample_square(index, next_pair());
    var direction: vec3f;
    if (u.x < by_environment) {
        direction = environment_direction(vec2f(u.x / by_environment, u.y));
    } else {
        u.x = (u.x - by_environment) / (1.0 - by_environment);
        if (u.x < by_specular) {
            let axes = lobe_axes(s);
            let facet = visible_normal(view * axes, ggx_alphas(s), vec2f(u.x / by_specular, u.y));
            direction = reflect(-view, axes * facet);
        } else {
            direction = cosine_direction(s.normal, vec2f((u.x - by_specular) / (1.0 - by_specular), u.y));
        }
    }
    if (!faces(s, direction)) { return Returned(); }
    var pdf = (1.0 - by_specular) * dot(s.normal, direction) / PI;
    var facets = 0.0;
    if (has_specular) { facets = facet_pdf(s, view, direction); }
    pdf = mix(pdf + by_specular * facets, environment_pdf(direction), by_environment);
    let light = LightSample(direction, BEYOND, environment(direction) * (s.occlusion / max(pdf, 1e-12)), pdf);
    let share = select(1.0, balance(pdf * f32(sampling.rays), lobe_density(s, view, direction)), is_rough);
    return returned(s, view, Receiver(to.albedo, is_rough, has_specular), light, 1.0, share);
}
