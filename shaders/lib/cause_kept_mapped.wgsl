// Variant that writes how the first ray of a pixel ended, where that is in a map.

#import cause
#import lists

@group(2) @binding(3) var cause: texture_storage_2d<r32uint, read_write>;

fn keep_cause(pixel: vec2u, ended: u32) {
    if (ended == CAUSE_UNMARCHED) { return; }
    // Pixels stay counted as not marched: their number is where others are listed.
    let before = textureLoad(cause, pixel).x & CAUSE_MASK;
    if (before != CAUSE_UNMARCHED) { atomicSub(&counters[before], 1u); }
    atomicAdd(&counters[ended], 1u);
    textureStore(cause, pixel, vec4u(ended, 0u, 0u, 0u));
}
