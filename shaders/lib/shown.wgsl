// Instances that only some kinds of rays see, and cut-outs.

#import constants

// Whether some instance is hidden from a kind of ray; without one the code is dropped.
override HAS_UNSHOWN: bool = false;
override HAS_CUTOUT: bool = true; // whether some material is cut out

// Whether rays ignore a hit with these instance flags; `passes` is UNSEEN, SHADOWLESS or UNREFLECTED.
fn is_passed(flags: u32, passes: u32) -> bool {
    return HAS_UNSHOWN && (flags & passes) != 0u;
}
