// Variant without extents: reflections are sharp, and lights are points or parallel.

#import frame

const HAS_ROUGH_REFLECTIONS: bool = false;

fn start_samples(pixel: vec2u, vertex: u32) {}

fn take_sample(index: u32) {}

// Nothing is random here: one path behind a surface is all of them.
fn paths_behind() -> u32 {
    return 1u;
}

fn take_path(index: u32, paths: u32) {}

// Direction of a reflection ray, and its weight; see extent_sampled.wgsl. In this variant the ray sees no light.
struct Reflected {
    direction: vec3f,
    weight: vec3f,
    pdf: f32,
    sky_weight: f32,
    kept: f32,
    normal: vec3f,
}

fn lobe_ray(direction: vec3f, s: Surface) -> Reflected {
    let kept = kept_share(s);
    let weight = fresnel(s, dot(s.normal, -direction)) * base_share(s, -direction);
    return Reflected(mirror_direction(direction, s), weight, 0.0, kept, kept, s.normal);
}

// Light that a path adds past its first hit, here without a limit.
fn limited(light: vec3f) -> vec3f {
    return light;
}

fn hard_lights() -> u32 {
    return frame.light_count;
}

// Same types as in extent_sampled.wgsl, unused because no light is sampled here.
struct Returned {
    none: f32,
}

struct Receiver {
    none: f32,
}

fn sampled_light(s: Surface, view: vec3f, albedo: vec3f) -> Shade {
    return Shade();
}

// The nearest light with a size that a ray meets: none.
struct SeenLight {
    is_seen: bool,
    radiance: vec3f,
    distance_m: f32,
}

fn seen_light(origin: vec3f, ray: Reflected, t_max: f32) -> SeenLight {
    return SeenLight();
}
