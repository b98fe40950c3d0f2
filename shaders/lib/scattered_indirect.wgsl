// Indirect diffuse light, from the indirect pass.

@group(2) @binding(12) var indirect_light: texture_2d<f32>;

// Indirect diffuse light that the surface of a pixel scatters towards the view.
fn light_scattered(pixel: vec2u) -> vec3f {
    return textureLoad(indirect_light, pixel, 0).xyz;
}
