// Surfaces scatter only what shines on them.

// What the surface of a pixel scatters of what others do.
fn light_scattered(pixel: vec2u) -> vec3f {
    return vec3f(0.0);
}
