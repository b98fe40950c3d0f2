// Light of the environment: by samples, of which each sub-frame takes a few, so that the mean over sub-frames
// converges; or of an unoccluded gradient in closed form.

#import environment
#import area_sampling
#import fog
#import frame
#import lobe
#import lobe_albedo
#import sampling

override SAMPLES_ENVIRONMENT: bool = true;

// Mean of a clamped cosine lobe around +Y under a clamped cosine lobe at `c` = cos of the angle
// between them: 2/(3π) ((π − θ) cos θ + sin θ).
fn lobe_overlap(c: f32) -> f32 {
    let cosine = clamp(c, -1.0, 1.0);
    let sine = sqrt(max(1.0 - cosine * cosine, 0.0));
    return (2.0 / (3.0 * PI)) * ((PI - acos(cosine)) * cosine + sine);
}

// Irradiance / π of `environment` on a surface with this normal, in closed form.
fn ambient(normal: vec3f) -> vec3f {
    return gradient(lobe_overlap(normal.y), lobe_overlap(-normal.y));
}

// Mean absolute height (y) of directions whose mean is `m`: of a single direction where all are equal, up to a cosine
// lobe, whose mean has a length of 2/3.
fn mean_height(m: vec3f) -> f32 {
    let length_m = max(length(m), 1e-6);
    let c = clamp(m.y / length_m, -1.0, 1.0);
    let spread = saturate(3.0 * (1.0 - length_m));
    return mix(abs(c), lobe_overlap(c) + lobe_overlap(-c), spread);
}

// Mean radiance that a lobe gathers: a gradient weighs directions by their height, so that only the means of the
// height and of its absolute value are needed.
fn environment_through(lobe: vec4f, s: Surface, view: vec3f) -> vec3f {
    let nv = dot(s.normal, view);
    let away = s.normal * nv - view;
    let m = (s.normal * lobe.z + away * (lobe.w / max(length(away), 1e-6))) / lobe.x;
    let height = mean_height(m);
    return gradient(0.5 * (height + m.y), 0.5 * (height - m.y));
}

// Share of a surface's rays that follow the bright parts of the environment.
fn environment_ray_share(s: Surface) -> f32 {
    if (is_outer_side(s)) { return select(0.0, 1.0, HAS_PANORAMA && HAS_ENVIRONMENT_RAYS); }
    return 0.75 * environment_share(s.normal);
}

// Density per solid angle of a ray towards the environment: a share follows its bright parts, and of the rest a share
// the specular lobe of the surface.
fn environment_ray_pdf(s: Surface, view: vec3f, direction: vec3f, by_specular: f32) -> f32 {
    var pdf = (1.0 - by_specular) * max(dot(s.normal, direction), 0.0) / PI;
    if (by_specular > 0.0) { pdf += by_specular * facet_pdf(s, view, direction); }
    let by_environment = environment_ray_share(s);
    if (by_environment <= 0.0) { return pdf; }
    return mix(pdf, environment_pdf(direction, s.normal), by_environment);
}

// Share of a surface's rays towards the environment that follow its specular lobe.
fn specular_ray_share(stand_in: f32, has_diffuse: bool) -> f32 {
    return select(0.0, select(1.0, 0.5, has_diffuse || stand_in < 1.0), stand_in > 0.0);
}

// Density per solid angle of all rays that a rough reflector sends towards the environment, where they share its
// specular light with reflection rays.
fn environment_rays_pdf(s: Surface, view: vec3f, direction: vec3f) -> f32 {
    if (!SAMPLES_ENVIRONMENT || environment_ray_share(s) <= 0.0) { return 0.0; }
    let by_specular = specular_ray_share(stand_in_share(s), true);
    return f32(sampling.rays) * environment_ray_pdf(s, view, direction, by_specular);
}

// Light of the environment on a surface in closed form, none where all of it is sampled; what reflection rays find of
// its specular part is left out.
fn environment_light(s: Surface, view: vec3f, albedo: vec3f) -> Shade {
    var out: Shade;
    if (SAMPLES_ENVIRONMENT) { return out; }
    out.diffuse = albedo * ambient(s.normal) * s.occlusion;
    if (has_sheen(s)) {
        let lobe = sheen_lobe(s, dot(s.normal, view));
        out.diffuse += s.sheen_color * environment_through(lobe, s, view) * (lobe.x * s.occlusion);
    }
    let stand_in = stand_in_share(s);
    if (stand_in > 0.0) {
        let lobe = lobe_at(mean_roughness(s), dot(s.normal, view));
        out.specular = specular_albedo(s, view) * environment_through(lobe, s, view) * s.occlusion * stand_in;
    }
    return out;
}

// Light of one ray towards the environment, which follows its bright parts or the lobes of the surface, weighted by
// the power heuristic (see area_sampling.wgsl). Reflectors get the environment's specular light by their reflection
// rays, and by these rays alone where they are sharp or the environment has no bright part; near the cut-off only a
// share of it.
fn returned_of_environment(s: Surface, view: vec3f, to: Receiver, index: u32) -> Returned {
    if (!SAMPLES_ENVIRONMENT) { return Returned(); }
    let by_environment = environment_ray_share(s);
    let is_shared = to.is_rough && by_environment > 0.0;
    let has_specular = to.stand_in > 0.0 || is_shared;
    let has_diffuse = has_sheen(s) || max(to.albedo.x, max(to.albedo.y, to.albedo.z)) > 0.0;
    if (!has_specular && !has_diffuse) { return Returned(); }
    let by_specular = specular_ray_share(to.stand_in, has_diffuse);
    var u = sample_square(index, next_pair());
    var direction: vec3f;
    var chosen_pdf = 0.0;
    if (u.x < by_environment) {
        let sampled = environment_direction(vec2f(u.x / by_environment, u.y), s.normal);
        direction = sampled.xyz;
        chosen_pdf = sampled.w;
    } else {
        u.x = (u.x - by_environment) / (1.0 - by_environment);
        if (u.x < by_specular) {
            let axes = lobe_axes(s);
            let bound = reflection_bound(s, max(dot(s.normal, view), 1e-3));
            let facet = visible_normal(view * axes, ggx_alphas(s), bound, vec2f(u.x / by_specular, u.y));
            direction = reflect(-view, axes * facet);
        } else {
            direction = cosine_direction(s.normal, vec2f((u.x - by_specular) / (1.0 - by_specular), u.y));
        }
    }
    if (!faces(s, direction)) { return Returned(); }
    var pdf = chosen_pdf;
    if (by_environment < 1.0) { pdf = environment_ray_pdf(s, view, direction, by_specular); }
    let light = LightSample(direction, BEYOND, environment(direction) * (s.occlusion / max(pdf, 1e-12)), pdf);
    var share = to.stand_in;
    if (is_shared) { share += (1.0 - share) * balance(pdf * f32(sampling.rays), lobe_density(s, view, direction)); }
    let clear = sky_share(s.position, direction);
    return returned(s, view, Receiver(to.albedo, to.is_rough, has_specular, to.stand_in), light, clear, share * clear);
}
