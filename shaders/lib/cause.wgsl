// Why a pixel's reflection is what it is: `Cause` in src/render/cause.rs as CAUSE_*.

#import constants

fn is_traced(cause: u32) -> bool {
    return ((TRACED_CAUSES >> cause) & 1u) != 0u;
}

// Whether the pixel shows its mirror direction, from wherever it is known.
fn reflects(cause: u32) -> bool {
    return ((REFLECTING_CAUSES >> cause) & 1u) != 0u;
}
