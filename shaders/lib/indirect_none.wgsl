// Variant without diffuse interreflection: paths continue only by mirroring and transmission.

#import cone
#import layers

fn scatterings() -> u32 {
    return 0u;
}

fn reach_m() -> f32 {
    return frame.ray_length_m;
}

fn continues(s: Surface) -> bool {
    return goes_on(s);
}

fn next_ray(before: Reflected, s: Surface) -> Reflected {
    return onward(before, s);
}

fn scattered_on(pixel: vec2u, vertex: u32, hits: u32, before: Reflected, s: Surface, cone: Cone) -> vec3f {
    return vec3f(0.0);
}
