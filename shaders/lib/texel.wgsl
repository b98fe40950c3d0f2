// Places of array elements in textures.

#import constants

// Coordinates of the texel with this index, in rows of TEXEL_COLUMNS.
fn texel_place(i: u32) -> vec2u {
    return vec2u(i % TEXEL_COLUMNS, i / TEXEL_COLUMNS);
}
