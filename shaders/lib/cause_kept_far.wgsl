// Variant that writes how the first ray of a pixel ended, where that is in the map of far things.

#import lists
#import nearest_met

@group(2) @binding(3) var cause: texture_storage_2d<r32uint, write>;

fn keep_cause(pixel: vec2u) {
    if (far_cause == CAUSE_UNMARCHED) { return; }
    atomicAdd(&counters[far_cause], 1u);
    textureStore(cause, pixel, vec4u(far_cause, 0u, 0u, 0u));
}
