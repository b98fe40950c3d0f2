// Why a pixel's reflection is what it is: `Cause` in src/render/cause.rs as CAUSE_*. The `cause` target
// holds it in its low byte; above, for what is traced, how far the march has proven the ray free.

#import constants

const CAUSE_MASK = 0xffu;

fn is_traced(cause: u32) -> bool {
    return ((TRACED_CAUSES >> cause) & 1u) != 0u;
}

// Whether the pixel shows its mirror direction, from wherever it is known.
fn reflects(bits: u32) -> bool {
    return ((REFLECTING_CAUSES >> (bits & CAUSE_MASK)) & 1u) != 0u;
}

// `free_m` is cut off to its upper 24 bits, so that it never grows.
fn pack_cause(cause: u32, free_m: f32) -> u32 {
    return cause | (bitcast<u32>(free_m) & ~CAUSE_MASK);
}

fn free_m(bits: u32) -> f32 {
    return bitcast<f32>(bits & ~CAUSE_MASK);
}
