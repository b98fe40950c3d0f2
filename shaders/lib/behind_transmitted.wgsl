// What passes through surfaces, as the transmit pass found it.

@group(2) @binding(11) var transmitted_light: texture_2d<f32>;

// Share of what is behind the surface of a pixel that is not the background.
fn covered_behind(pixel: vec2u) -> f32 {
    return textureLoad(transmitted_light, pixel, 0).w;
}

// What a pixel shows through its surface.
fn light_behind(pixel: vec2u) -> vec3f {
    return textureLoad(transmitted_light, pixel, 0).xyz;
}
