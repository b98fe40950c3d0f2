// Fog between the camera and a pixel's surface, from the fog pass.

#import fog

@group(2) @binding(9) var fog_light: texture_2d<f32>;

// Light of a pixel's surface, seen through the fog, and the light that the fog scatters.
fn fogged(pixel: vec2u, light: vec3f) -> vec3f {
    if (!HAS_FOG) { return light; }
    let air = textureLoad(fog_light, pixel, 0);
    return light * air.w + air.xyz;
}

// Transmittance of the fog before a pixel's surface.
fn seen_through_fog(pixel: vec2u) -> f32 {
    if (!HAS_FOG) { return 1.0; }
    return textureLoad(fog_light, pixel, 0).w;
}
