// Variant without transmission: no light passes through surfaces.

// Share of the light from behind the surface of a pixel that other surfaces cover, rather than the background.
fn covered_behind(pixel: vec2u) -> f32 {
    return 1.0;
}

// Light from behind the surface of a pixel.
fn light_behind(pixel: vec2u) -> vec3f {
    return vec3f(0.0);
}
