// Light of the environment in closed form: a gradient that nothing is in the way of.

#import frame

// Mean of a clamped cosine lobe around +Y under a clamped cosine lobe at `c` = cos of the angle
// between them: 2/(3π) ((π − θ) cos θ + sin θ).
fn lobe_overlap(c: f32) -> f32 {
    let cosine = clamp(c, -1.0, 1.0);
    let sine = sqrt(max(1.0 - cosine * cosine, 0.0));
    return (2.0 / (3.0 * PI)) * ((PI - acos(cosine)) * cosine + sine);
}

// Irradiance / π of `environment` on a surface with this normal, in closed form.
fn ambient(normal: vec3f) -> vec3f {
    return frame.horizon
        + (frame.zenith - frame.horizon) * lobe_overlap(normal.y)
        + (frame.ground - frame.horizon) * lobe_overlap(-normal.y);
}

// Environment through a rough lobe.
fn environment_specular(s: Surface, view: vec3f) -> vec3f {
    let direction = reflect(-view, s.normal);
    let radiance = mix(environment(direction), ambient(s.normal), s.roughness);
    return lobe_albedo(s, view) * radiance * s.occlusion;
}

// No ray is sent towards the environment.
fn environment_rays_pdf(s: Surface, direction: vec3f) -> f32 {
    return 0.0;
}

// What the environment adds; the specular of reflectors is found by reflection rays.
fn environment_light(s: Surface, view: vec3f, albedo: vec3f) -> Shade {
    var out: Shade;
    out.diffuse = albedo * ambient(s.normal) * s.occlusion;
    if (!is_reflector(s)) { out.specular = environment_specular(s, view); }
    return out;
}
