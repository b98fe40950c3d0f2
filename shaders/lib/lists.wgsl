// The lists of a frame, in one buffer because a stage may bind few: reflective pixels, then rays that
// are traced, with screen hits from the other end, then the depth pyramid, then the depth of what the camera culls.
// Pixels that let light through use the list of the first two that the surface pass leaves free.
// Pixels are x | y << 16.

#import frame

// Whether there are reflective pixels, and whether they are marched; else the surface pass lists them as rays.
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

// Rays and hits together are at most as many as pixels, so that they never meet.
fn hit_slot(index: u32) -> u32 {
    return 2u * picture_px() - 1u - index;
}

// Of pixels whose surface lets light through; taken until the march lists its rays.
fn transmissive_slot(index: u32) -> u32 {
    return select(reflector_slot(index), ray_slot(index), HAS_REFLECTIONS && MARCH);
}

// Where a cell of a level from 1 up is; the picture counts as padded to cells of the last level.
fn pyramid_slot(cell: vec2u, level: u32) -> u32 {
    let cells = (vec2u(frame.size) + (1u << PYRAMID_LEVELS) - 1u) >> vec2u(PYRAMID_LEVELS);
    let area = (cells.x * cells.y) << (2u * PYRAMID_LEVELS);
    let before = (area - (area >> (2u * level - 2u))) / 3u;
    return 2u * picture_px() + before + cell.y * (cells.x << (PYRAMID_LEVELS - level)) + cell.x;
}

// Whether the march is to be stopped by surfaces that the camera culls and rays meet.
override HAS_CULLED: bool = true;

// Where a pixel's clip-space z is of the nearest surface that the camera culls in front of what it shows;
// 0: none.
fn culled_slot(pixel: vec2u) -> u32 {
    return pyramid_slot(vec2u(0u), PYRAMID_LEVELS + 1u) + pixel.y * u32(frame.size.x) + pixel.x;
}

fn pack_pixel(pixel: vec2u) -> u32 {
    return pixel.x | (pixel.y << 16u);
}

fn unpack_pixel(bits: u32) -> vec2u {
    return vec2u(bits & 0xffffu, bits >> 16u);
}
