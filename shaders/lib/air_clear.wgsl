// Variant without fog on the way of rays.

// Light on the way of a ray; see air_foggy.wgsl.
struct Air {
    light: vec3f,
    share: vec3f,
    scatters: bool,
    ray: Reflected,
    position: vec3f,
}

fn through_air(origin: vec3f, ray: Reflected, distance_m: f32) -> Air {
    return Air(vec3f(0.0), vec3f(1.0), false, ray, origin);
}

fn air_before(pixel: vec2u, vertex: u32, origin: vec3f, direction: vec3f, distance_m: f32) -> vec4f {
    return vec4f(0.0, 0.0, 0.0, 1.0);
}
