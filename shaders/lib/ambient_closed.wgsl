// Light of the environment in closed form: an unoccluded gradient.

#import extent
#import frame
#import lobe_albedo

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

// Mean absolute height (y) of directions whose mean is `m`: that of a single direction where all are equal, up to
// that of a cosine lobe, whose mean has a length of 2/3.
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
    return frame.horizon + (frame.zenith - frame.horizon) * (0.5 * (height + m.y))
        + (frame.ground - frame.horizon) * (0.5 * (height - m.y));
}

fn environment_specular(s: Surface, view: vec3f) -> vec3f {
    let lobe = lobe_at(mean_roughness(s), dot(s.normal, view));
    return specular_albedo(s, view) * environment_through(lobe, s, view) * s.occlusion;
}

// Density of rays towards the environment: 0, as none are sent.
fn environment_rays_pdf(s: Surface, view: vec3f, direction: vec3f) -> f32 {
    return 0.0;
}

fn returned_of_environment(s: Surface, view: vec3f, to: Receiver, index: u32) -> Returned {
    return Returned();
}

// Light of the environment on a surface; what reflection rays find of its specular part is left out.
fn environment_light(s: Surface, view: vec3f, albedo: vec3f) -> Shade {
    var out: Shade;
    out.diffuse = albedo * ambient(s.normal) * s.occlusion;
    if (has_sheen(s)) {
        let lobe = sheen_lobe(s, dot(s.normal, view));
        out.diffuse += s.sheen_color * environment_through(lobe, s, view) * (lobe.x * s.occlusion);
    }
    let stand_in = stand_in_share(s);
    if (stand_in > 0.0) { out.specular = environment_specular(s, view) * stand_in; }
    return out;
}
