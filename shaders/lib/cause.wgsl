// Cause of a pixel's reflection: CAUSE_* are the values of `Cause` in src/render/pipeline/cause.rs. The `cause` target
// holds it in its low byte; for traced pixels the bits above hold the length of the ray that the march has proven free.

#import constants

// Whether rays may end in maps, so that their causes are kept.
override MAPPED: bool = false;

fn is_traced(cause: u32) -> bool {
    return ((TRACED_CAUSES >> cause) & 1u) != 0u;
}

// Whether the march found what the ray hits.
fn is_screen_hit(cause: u32) -> bool {
    return ((SCREEN_CAUSES >> cause) & 1u) != 0u;
}

// Whether the pixel shows a reflection along its mirror direction, from whichever source.
fn reflects(bits: u32) -> bool {
    return ((REFLECTING_CAUSES >> (bits & CAUSE_MASK)) & 1u) != 0u;
}

// Length in the upper 24 bits, which is truncated to them, so that it is never longer.
fn free_m(bits: u32) -> f32 {
    return bitcast<f32>(bits & ~CAUSE_MASK);
}
