// What surfaces scatter of what others do, as the indirect pass found it.

@group(2) @binding(12) var indirect_light: texture_2d<f32>;

// What the surface of a pixel scatters of what others do.
fn light_scattered(pixel: vec2u) -> vec3f {
    return textureLoad(indirect_light, pixel, 0).xyz;
}
