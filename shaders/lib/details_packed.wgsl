// What the G-buffer does not hold of a surface, as the details pass found it.

#import details_layout

@group(2) @binding(30) var details: texture_2d<u32>;

fn detailed(s: Surface, pixel: vec2u) -> Surface {
    return with_details(s, textureLoad(details, pixel, 0));
}
