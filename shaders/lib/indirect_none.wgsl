// Variant without diffuse interreflection: paths continue only by mirroring and transmission.

#import cone
#import layers

fn scatterings() -> u32 {
    return 0u;
}

fn forget_scatterings() {}

fn reach_m() -> f32 {
    return frame.ray_length_m;
}

fn continues(s: Surface) -> bool {
    return goes_on(s);
}

fn next_ray(before: Reflected, s: Surface) -> Reflected {
    return onward(before, s);
}

// Start of a path; see indirect_followed.wgsl.
struct Start {
    ray: Reflected,
    origin: vec3f,
}

fn scattered_by_surface(before: Reflected, s: Surface) -> Start {
    return Start(before, s.position);
}

var<private> first_m: f32 = FAR_M;

fn followed(pixel: vec2u, vertex: u32, hits: u32, start: Start, first: Cone) -> vec3f {
    return vec3f(0.0);
}
