// Variant without sheen.

#import frame

fn has_sheen(s: Surface) -> bool {
    return false;
}

fn sheen_lobe(s: Surface, cosine: f32) -> vec4f {
    return vec4f(1.0);
}

// Share of light that a sheen leaves to the layers below: all.
fn base_share(s: Surface, view: vec3f) -> f32 {
    return 1.0;
}

// Contribution of a sheen to the albedo: none.
fn sheen(s: Surface, view: vec3f, to_light: vec3f) -> vec3f {
    return vec3f(0.0);
}

fn sheen_albedo(s: Surface, view: vec3f) -> vec3f {
    return vec3f(0.0);
}
