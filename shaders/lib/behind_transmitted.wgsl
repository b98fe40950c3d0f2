// Light that passes through surfaces, from the transmit pass.

@group(2) @binding(11) var transmitted_light: texture_2d<f32>;

// Share of the light from behind the surface of a pixel that other surfaces cover, rather than the background.
fn covered_behind(pixel: vec2u) -> f32 {
    return textureLoad(transmitted_light, pixel, 0).w;
}

// Light from behind the surface of a pixel.
fn light_behind(pixel: vec2u) -> vec3f {
    return textureLoad(transmitted_light, pixel, 0).xyz;
}
