// Nothing passes through surfaces.

// Share of what is behind the surface of a pixel that is not the background.
fn covered_behind(pixel: vec2u) -> f32 {
    return 1.0;
}

// What a pixel shows through its surface.
fn light_behind(pixel: vec2u) -> vec3f {
    return vec3f(0.0);
}
