// Places of the depth pyramid's cells in the buffer of lists, which passes declare as they use it.

#import frame

// Whether one of several rays is traced, so that there is a list of the others before the pyramid.
override UNDERSAMPLED: bool = false;

fn picture_px() -> u32 {
    return u32(frame.size.x) * u32(frame.size.y);
}

// The depth pyramid: for the picture, padded to whole cells of the last level, and for cells of 2, 4, … pixels, the
// clip-space z of the nearest surface that reflection rays may meet; 0: none. Level 0 is the picture itself, with a
// negative z where it shows a cut-out.
struct Pyramid {
    start: u32, // slot of its first value
    width: u32, // number of pixels of a padded row
    area: u32, // number of cells of the last level
}

fn pyramid() -> Pyramid {
    let cells = (vec2u(frame.size) + (1u << PYRAMID_LEVELS) - 1u) >> vec2u(PYRAMID_LEVELS);
    return Pyramid(select(2u, 3u, UNDERSAMPLED) * picture_px(), cells.x << PYRAMID_LEVELS, cells.x * cells.y);
}

// Sum of the powers of 4 up to level 0's, which is the number of its pixels per cell of the last level.
const POWERS_OF_4: u32 = ((4u << (2u * PYRAMID_LEVELS)) - 1u) / 3u;

// Slot of a cell of the pyramid.
fn pyramid_slot(p: Pyramid, cell: vec2u, level: u32) -> u32 {
    // Number of cells of the levels before, per cell of the last one: the higher powers of 4.
    let before = POWERS_OF_4 & (0xffffffffu << (2u * (PYRAMID_LEVELS + 1u - level)));
    return p.start + before * p.area + cell.y * (p.width >> level) + cell.x;
}
