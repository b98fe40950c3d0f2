// Lists of a frame, in one buffer because a stage may bind few: pixels to march with pixels to trace at once from the
// other end, then rays that the march refused with screen hits from the other end, then the depth pyramid. Transmissive
// pixels use a list that is free before the march. Pixels are x | y << 16.

#import frame

// Whether there are reflective pixels, and whether those of surfaces without FLAG_TRACED are marched.
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

// Slot of a pixel that is traced without being marched.
fn unmarched_slot(index: u32) -> u32 {
    return picture_px() - 1u - index;
}

fn refused_slot(index: u32) -> u32 {
    return picture_px() + index;
}

// Slot of a traced ray: unmarched pixels come first, then refused ones.
fn ray_slot(index: u32) -> u32 {
    let unmarched = atomicLoad(&counters[CAUSE_UNMARCHED]);
    if (index < unmarched) { return unmarched_slot(index); }
    return refused_slot(index - unmarched);
}

// Rays and hits together are at most as many as pixels, so that the two lists never overlap.
fn hit_slot(index: u32) -> u32 {
    return 2u * picture_px() - 1u - index;
}

// Slot of a transmissive pixel, in a list that is free until the march lists its rays.
fn transmissive_slot(index: u32) -> u32 {
    return select(reflector_slot(index), refused_slot(index), HAS_REFLECTIONS);
}

// The depth pyramid: for the picture, padded to whole cells of the last level, and for cells of 2, 4, … pixels, the
// clip-space z of the nearest surface that reflection rays may meet; 0: none. Level 0 is the picture itself.
struct Pyramid {
    start: u32, // slot of its first value
    width: u32, // number of pixels of a padded row
    area: u32, // number of cells of the last level
}

fn pyramid() -> Pyramid {
    let cells = (vec2u(frame.size) + (1u << PYRAMID_LEVELS) - 1u) >> vec2u(PYRAMID_LEVELS);
    return Pyramid(2u * picture_px(), cells.x << PYRAMID_LEVELS, cells.x * cells.y);
}

// Sum of the powers of 4 up to that of level 0, which is the number of its pixels per cell of the last level.
const POWERS_OF_4: u32 = ((4u << (2u * PYRAMID_LEVELS)) - 1u) / 3u;

// Slot of a cell of the pyramid.
fn pyramid_slot(p: Pyramid, cell: vec2u, level: u32) -> u32 {
    // Number of cells of the levels before, per cell of the last one: the higher powers of 4.
    let before = POWERS_OF_4 & (0xffffffffu << (2u * (PYRAMID_LEVELS + 1u - level)));
    return p.start + before * p.area + cell.y * (p.width >> level) + cell.x;
}

// Whether surfaces that the camera culls but reflection rays meet stop the march. Where they are nearer than the
// surface that a pixel shows, level 0 of the pyramid has their depth.
override HAS_CULLED: bool = true;

fn pack_pixel(pixel: vec2u) -> u32 {
    return pixel.x | (pixel.y << 16u);
}

fn unpack_pixel(bits: u32) -> vec2u {
    return vec2u(bits & 0xffffu, bits >> 16u);
}
