// Lists of a frame, in one buffer because a stage may bind few: reflective pixels, then traced rays with screen hits
// from the other end, then the depth pyramid, then the depth of surfaces that the camera culls.
// Transmissive pixels use the one of the first two lists that the surface pass leaves free. Pixels are x
// y << 16.

#import frame

// Whether there are reflective pixels, and whether they are marched; otherwise the surface pass lists them as rays.
override HAS_REFLECTIONS: bool = true;
override MARCH: bool = true;

@group(2) @binding(20) var<storage, read_write> lists: array<u32>;
@group(2) @binding(21) var<storage, read_write> counters: array<atomic<u32>, COUNTERS>;

fn picture_px() -> u32 {
    return u32(frame.size.x) * u32(frame.size.y);
}

fn reflector_slot(index: u32) -> u32 {
    return index;
}

fn ray_slot(index: u32) -> u32 {
    return picture_px() + index;
}

// Rays and hits together are at most as many as pixels, so that the two lists never overlap.
fn hit_slot(index: u32) -> u32 {
    return 2u * picture_px() - 1u - index;
}

// Slot of a transmissive pixel, in a list that is free until the march lists its rays.
fn transmissive_slot(index: u32) -> u32 {
    return select(reflector_slot(index), ray_slot(index), HAS_REFLECTIONS && MARCH);
}

// Slot of a pyramid cell at a level from 1 up; the picture is padded to whole cells of the last level.
fn pyramid_slot(cell: vec2u, level: u32) -> u32 {
    let cells = (vec2u(frame.size) + (1u << PYRAMID_LEVELS) - 1u) >> vec2u(PYRAMID_LEVELS);
    let area = (cells.x * cells.y) << (2u * PYRAMID_LEVELS);
    let before = (area - (area >> (2u * level - 2u))) / 3u;
    return 2u * picture_px() + before + cell.y * (cells.x << (PYRAMID_LEVELS - level)) + cell.x;
}

// Whether surfaces that the camera culls but reflection rays meet stop the march.
override HAS_CULLED: bool = true;

// Slot of a pixel's clip-space z of the nearest culled surface in front of the one it shows; 0: none.
fn culled_slot(pixel: vec2u) -> u32 {
    return pyramid_slot(vec2u(0u), PYRAMID_LEVELS + 1u) + pixel.y * u32(frame.size.x) + pixel.x;
}

fn pack_pixel(pixel: vec2u) -> u32 {
    return pixel.x | (pixel.y << 16u);
}

fn unpack_pixel(bits: u32) -> vec2u {
    return vec2u(bits & 0xffffu, bits >> 16u);
}
