// Variant without details: the G-buffer holds all values of surfaces.

#import scene

@group(2) @binding(2) var colors: texture_2d<u32>;

fn packed_colors(pixel: vec2u) -> vec4u {
    return textureLoad(colors, pixel, 0);
}

fn detailed(s: Surface, pixel: vec2u) -> Surface {
    return s;
}
