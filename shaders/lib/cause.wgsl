// Why a pixel's reflection is what it is; the numbers are those of `Cause` in cause.rs.

const CAUSE_NOT_REFLECTIVE: u32 = 0u;
const CAUSE_HIT: u32 = 1u;
const CAUSE_HIDDEN: u32 = 2u;
const CAUSE_BACK_FACE: u32 = 3u;
const CAUSE_REFLECTOR: u32 = 4u;
const CAUSE_OFF_SCREEN: u32 = 5u;
const CAUSE_STEPS: u32 = 6u;
const CAUSE_NONE: u32 = 7u;
const CAUSE_ROUGH: u32 = 8u;
const CAUSE_UNMARCHED: u32 = 9u; // method rt: nothing was marched

fn is_traced(cause: u32) -> bool {
    return (cause >= CAUSE_HIDDEN && cause <= CAUSE_STEPS) || cause == CAUSE_UNMARCHED;
}
