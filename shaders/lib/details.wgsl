// Surface values that the G-buffer has no bits for, written by the details pass with a copy of the colors in one
// array texture: thus passes need no more sampled textures than every adapter has.

#import details_layout

override HAS_DETAILS: bool = true; // else the G-buffer holds all values of surfaces

@group(2) @binding(3) var colors: texture_2d<u32>;
@group(2) @binding(4) var details: texture_2d_array<u32>;

fn packed_colors(pixel: vec2u) -> vec4u {
    if (!HAS_DETAILS) { return textureLoad(colors, pixel, 0); }
    return textureLoad(details, pixel, 0, 0);
}

fn diffuse_transmission_at(pixel: vec2u) -> f32 {
    if (!HAS_DIFFUSE_TRANSMISSION) { return 0.0; }
    return with_diffuse_transmission(Surface(), textureLoad(details, pixel, 3, 0)).diffuse_transmission;
}

fn detailed(s: Surface, pixel: vec2u) -> Surface {
    if (!HAS_DETAILS) { return s; }
    var whole = with_details(s, textureLoad(details, pixel, 1, 0));
    if (!HAS_FURTHER_DETAILS) { return whole; }
    whole = with_further_details(whole, textureLoad(details, pixel, 2, 0));
    if (HAS_DIFFUSE_TRANSMISSION) { whole = with_diffuse_transmission(whole, textureLoad(details, pixel, 3, 0)); }
    return whole;
}
