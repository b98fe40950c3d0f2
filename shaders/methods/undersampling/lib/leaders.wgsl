// Pixels whose rays are traced first, one of RATE in a regular pattern.

#import constants

// Number of rays of which one is traced first: 2 in a checkerboard, 4 in blocks of 2 × 2 pixels.
override RATE: u32 = 2u;

fn is_leader(pixel: vec2u) -> bool {
    let odd = pixel & vec2u(1u);
    return select((odd.x | odd.y) == 0u, odd.x == odd.y, RATE == 2u);
}

// Offset of one of the four leaders around a pixel that is none; two of them may be the same.
fn leader_offset(pixel: vec2u, k: u32) -> vec2i {
    let sign = i32(k & 1u) * 2 - 1;
    let other = i32(k >> 1u) * 2 - 1;
    if (RATE == 2u) { return select(vec2i(0, sign), vec2i(sign, 0), k < 2u); }
    return vec2i(pixel & vec2u(1u)) * vec2i(sign, other);
}
