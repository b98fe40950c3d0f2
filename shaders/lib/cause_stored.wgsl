// How the first ray of a pixel ended, where that is in a map; else its cause was written before the ray is traced.

#import cause
#import lists

@group(2) @binding(10) var written_cause: texture_storage_2d<r32uint, read_write>;

fn keep_cause(pixel: vec2u, ended: u32) {
    if (!MAPPED || ended == CAUSE_UNMARCHED) { return; }
    // Pixels stay counted as not marched: their number is where others are listed.
    let before = textureLoad(written_cause, pixel).x & CAUSE_MASK;
    if (before != CAUSE_UNMARCHED) { atomicSub(&counters[before], 1u); }
    atomicAdd(&counters[ended], 1u);
    textureStore(written_cause, pixel, vec4u(ended, 0u, 0u, 0u));
}
