// Variant without diffuse interreflection: surfaces scatter direct light only.

// Indirect diffuse light that the surface of a pixel scatters towards the view.
fn light_scattered(pixel: vec2u) -> vec3f {
    return vec3f(0.0);
}
