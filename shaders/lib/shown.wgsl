// What only some rays see.

#import constants

// Whether some instance is not shown to all rays; without one the code is dropped.
override HAS_UNSHOWN: bool = false;

// Whether rays pass what has these flags of an instance; `passes` is UNSEEN, SHADOWLESS or UNREFLECTED.
fn is_passed(flags: u32, passes: u32) -> bool {
    return HAS_UNSHOWN && (flags & passes) != 0u;
}
