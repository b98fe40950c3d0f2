// Nothing passes through surfaces.

// What a pixel shows through its surface.
fn light_behind(pixel: vec2u) -> vec3f {
    return vec3f(0.0);
}
